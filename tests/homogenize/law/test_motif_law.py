"""The law of a motif: nodes, range, files, refusals, and turns of the axes; laws from real cells."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.campaign.campaign import SolveCell, run_campaign
from asterism.homogenize.campaign.fit_law import fit_law, motif_tensors
from asterism.homogenize.cell.motif_responses import motif_responses
from asterism.homogenize.errors import CampaignError, ForeignLaw, LawError
from asterism.homogenize.law.law_file import law_bytes, law_digest, load_law
from asterism.homogenize.law.motif_law import MotifLaw, MotifTable, MotifValues, tensor_errors
from asterism.homogenize.law.plan import LawPlan, Size
from asterism.homogenize.law.tensor_forms import SheetTensors, stored_tensors
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout as layout_of
from tests.homogenize import same_process
from tests.homogenize.law.test_anisotropy import turned as turned_voigt
from tests.homogenize.motif_laws import learned_law, made_up
from tests.homogenize.motifs import grid, motif_design, parallel

THICKNESS = {"profile": "radial", "from": 0.4, "to": 0.6, "over_mm": 30.0}
WIDTH = {"profile": "linear", "from": 0.8, "to": 1.6, "start_mm": [-30.0, 0.0], "end_mm": [30.0, 0.0]}


def design(thickness: Any = 0.4, width: Any = 1.2, own: dict[str, Any] | None = None, **more: Any) -> Design:
    """A square grid of rods; `own` are keys of its second line."""
    motif, lattice = grid()
    motif[1] |= own or {}
    rods = {"motif": motif, "thickness_mm": thickness, "width_mm": width} | more.pop("rods", {})
    return Design.from_dict({"rods": rods, "lattice": lattice, "border": {"rectangle_mm": (60, 60)}} | more)


def law_of(
    sheet: Design, folder: Path, monkeypatch: pytest.MonkeyPatch, respond: SolveCell | None = made_up
) -> MotifLaw:
    """From real cells if nothing responds in their place."""
    same_process.use(monkeypatch)
    return learned_law(sheet, folder, respond)


@pytest.fixture
def law(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> MotifLaw:
    return law_of(design(THICKNESS, WIDTH), tmp_path / "samples", monkeypatch)


def parts(values: MotifValues) -> list[np.ndarray]:
    return [values.metric, values.stiffness, values.curvature]


def test_nodes_have_the_tensors_of_their_cells(law: MotifLaw) -> None:
    sheet = design(THICKNESS, WIDTH)
    for task in law.plan.tasks():
        cell = motif_tensors(made_up(law.plan.cell_design(task), law.edge_mm).to_dict())
        values = law.evaluate(sheet, *task.sizes)
        assert values.inside.all()
        tolerance = 2e-3 if task.held_out else 1e-10
        for ours, known in zip(parts(values), (cell.metric, cell.stiffness, cell.curvature), strict=True):
            np.testing.assert_allclose(ours, known, rtol=tolerance, atol=tolerance * np.abs(known).max())


def test_errors_are_those_of_the_held_out_cells(law: MotifLaw) -> None:
    stated = law.residuals["1.35"]["held_out"]
    assert stated["count"] == 4
    assert all(0.0 < stated["errors"][name]["largest_percent"] < 0.2 for name in ("membrane", "bending", "curvature"))


def test_stiffnesses_are_positive_definite_between_cells(law: MotifLaw) -> None:
    thickness, width = (each.ravel() for each in np.meshgrid(np.linspace(0.4, 0.6, 41), np.linspace(0.8, 1.6, 31)))
    values = law.evaluate(design(THICKNESS, WIDTH), thickness, width)
    assert values.inside.all() and (np.linalg.eigvalsh(values.stiffness) > 0.0).all()


def test_places_have_the_sizes_of_the_design(law: MotifLaw) -> None:
    sheet = design(THICKNESS, WIDTH)
    points = np.array([[0.0, 0.0], [20.0, -11.0]])
    radius = np.linalg.norm(points, axis=1)
    expected = law.evaluate(sheet, 0.4 + 0.2 * radius / 30.0, 0.8 + 0.8 * (points[:, 0] + 30.0) / 60.0)
    for ours, known in zip(parts(law.evaluate_at(sheet, points)), parts(expected), strict=True):
        np.testing.assert_allclose(ours, known, rtol=1e-9)


def test_outside_the_range_the_nearest_sizes_count(law: MotifLaw) -> None:
    values = law.evaluate(design(THICKNESS, WIDTH), [0.3, 0.4], [1.2, 1.2])
    assert values.inside.tolist() == [False, True]
    assert values.outside == ("rods.thickness_mm = 0.3: is outside the law's 0.4 to 0.6",)
    np.testing.assert_allclose(values.stiffness[0], values.stiffness[1])


def test_cells_without_a_law_cut_the_range(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sheet = design(THICKNESS | {"from": 0.3})
    law = law_of(sheet, tmp_path, monkeypatch)
    values = law.evaluate(sheet, [0.31, 0.4], 1.2)
    assert values.inside.tolist() == [False, True]
    assert "2 x 2 cells relax to" in values.outside[0]
    law.check(sheet)
    with pytest.raises(LawError, match=r"^rods.motif: the motif has no law of one cell") as refused:
        law.check(design(0.31))
    assert refused.value.field == "rods.motif"
    with pytest.raises(CampaignError, match=r"thickness 0.3 mm, width 1.2 mm: the motif has no law of one cell"):
        law_of(design(0.3), tmp_path, monkeypatch)


def test_files_give_the_same_law(law: MotifLaw, tmp_path: Path) -> None:
    content = law_bytes(law)
    (tmp_path / "law.npz").write_bytes(content)
    again = load_law(tmp_path / "law.npz")
    assert isinstance(again, MotifLaw)
    assert law_bytes(again) == content and law_digest(again) == law_digest(law)
    sheet = design(THICKNESS, WIDTH)
    for ours, known in zip(*(parts(each.evaluate(sheet, 0.47, 1.1)) for each in (again, law)), strict=True):
        np.testing.assert_array_equal(ours, known)


def test_designs_of_the_other_kind_are_refused(law: MotifLaw) -> None:
    with pytest.raises(ForeignLaw, match="stars: the law is for a motif of drawn rods"):
        law.check(Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 1}}))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"fabric": {"thickness_mm": 0.7}}, "fabric.thickness_mm = 0.7: the law is for another material, of 0.8"),
        ({"lattice": {"kind": "square", "spacing_mm": 11.0}}, "lattice: the law is for another lattice"),
        ({"rods": {"motif": grid()[0][:1]}}, "rods.motif = 1 lines: the law is for another motif, of 2 lines"),
        ({"rods": {"motif": grid(9.0)[0]}}, r"rods.motif\[0\].line_mm: the law is for another motif"),
        ({"rods": {"join_mm": 0.2}}, "rods.join_mm = 0.2: the law is for another motif, of 0.1"),
        ({"own": {"thickness_mm": 0.5}}, r"rods.motif\[0\].thickness_mm: the law is for lines with the same"),
        ({"own": {"kappa_bar_per_mm": 0.01}}, r"rods.motif\[1\].kappa_bar_per_mm = 0.01: the law is for another motif"),
        ({"fabric": {"bending": "none"}}, "fabric.bending"),
        ({"rods": {"draw": [{"line_mm": [(-20, 3), (20, 3)]}]}}, "rods.draw: must be left out"),
    ],
)
def test_other_designs_are_refused(law: MotifLaw, change: dict[str, Any], message: str) -> None:
    with pytest.raises(LawError, match=message):
        law.check(design(**change))


def test_a_cell_that_cannot_be_drawn_names_its_place_once(law: MotifLaw) -> None:
    for sample in law.samples:
        sample["problem"] = "rods: motif[0] and motif[1] lie on each other: draw the line once"
    (table,) = law.tables
    unsolved = replace(law, tables=(replace(table, solved=np.zeros_like(table.solved)),))
    with pytest.raises(LawError, match=r"^rods: motif\[0\] and motif\[1\] lie on each other.* \(thickness") as refused:
        unsolved.check(design())
    assert refused.value.field == "rods"


def test_stiffness_follows_the_modulus(law: MotifLaw) -> None:
    soft, stiff = (design(fabric={"modulus_mpa": modulus}) for modulus in (7.1875, 14.375))
    ours, known = (law.evaluate(each, 0.45, 1.2) for each in (stiff, soft))
    np.testing.assert_allclose(ours.stiffness, 2.0 * known.stiffness)
    np.testing.assert_array_equal(ours.curvature, known.curvature)


def test_lines_with_sizes_of_their_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A number stays as it is; a field is an axis of its own."""
    fixed = design(THICKNESS, own={"thickness_mm": 0.8})
    law = law_of(fixed, tmp_path, monkeypatch)
    assert [(size.key, size.lines) for size in law.plan.sizes] == [("thickness_mm", (0,)), ("width_mm", (0, 1))]
    law.check(fixed)
    with pytest.raises(ForeignLaw, match=r"rods.motif\[1\].thickness_mm = 0.7: the law is for another motif, of 0.8"):
        law.check(design(THICKNESS, own={"thickness_mm": 0.7}))
    two = design(THICKNESS, own={"thickness_mm": THICKNESS | {"to": 0.5}})
    law = law_of(two, tmp_path, monkeypatch)
    assert [size.lines for size in law.plan.sizes] == [(0,), (1,), (0, 1)]
    assert law.evaluate_at(two, np.zeros((1, 2))).inside.all()
    with pytest.raises(TypeError, match="2 given, the law has thickness_mm_of_lines_0, thickness_mm_of_lines_1, width"):
        law.evaluate(two, 0.4, 1.2)


def test_rounded_sizes_are_those_that_are_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rounding = {"first_layer_mm": 0.2, "layer_mm": 0.1, "line_mm": 0.4}
    sheet = design(THICKNESS, 1.1, rods={"rounding": rounding})
    law = law_of(sheet, tmp_path, monkeypatch)
    thickness, width = law.plan.sizes
    assert (thickness.nodes[0], thickness.nodes[-1], width.nodes) == (0.4, 0.6, (1.2,))
    np.testing.assert_allclose(law.plan.sizes_at(sheet, np.array([[10.0, 0.0]])), [[0.5, 1.2]])


def test_sizes_that_vary_together_need_only_cells_around_them(
    law: MotifLaw, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Half of the grid here; other nodes follow from these, which changes the law by half a percent at most."""
    thickness = WIDTH | {"from": 0.4, "to": 0.8}
    sheet = design(thickness, WIDTH | {"to": 2.0})
    whole, layout = law_of(sheet, tmp_path, monkeypatch), layout_of(sheet)
    tasks = whole.plan.tasks_for_sizes(whole.plan.sizes_on(sheet, layout))
    assert len(tasks) <= 0.55 * sum(not task.held_out for task in whole.plan.tasks())
    some = fit_law(whole.plan, run_campaign(whole.plan, tmp_path, respond=made_up, tasks=tasks))
    assert isinstance(some, MotifLaw) and some.covers(sheet, layout) and not law.covers(sheet, layout)
    points = np.random.default_rng(0).uniform(-29.0, 29.0, (50, 2))
    for ours, known in zip(*(parts(each.evaluate_at(sheet, points)) for each in (some, whole)), strict=True):
        np.testing.assert_allclose(ours, known, atol=5e-3 * np.abs(known).max())


def random_tensors(count: int, seed: int = 3) -> SheetTensors:
    rng = np.random.default_rng(seed)

    def positive(k: int) -> Floats:
        root = rng.normal(size=(count, k, k))
        return np.asarray(root @ np.swapaxes(root, 1, 2) + 0.1 * np.eye(k))

    metric, stiffness = positive(2), np.zeros((count, 6, 6))
    stiffness[:, :3, :3], stiffness[:, 3:, 3:] = 100.0 * positive(3), 5.0 * positive(3)
    return SheetTensors(
        np.stack([metric[:, 0, 0], metric[:, 1, 1], metric[:, 0, 1]], axis=-1),
        stiffness,
        0.02 * rng.normal(size=(count, 3)),
    )


def turned(tensors: SheetTensors, angle: float) -> SheetTensors:
    """The tensors of the same sheet after a turn by an angle (rad)."""
    c, s = np.cos(angle), np.sin(angle)
    plain = np.array([[c * c, s * s, -2 * c * s], [s * s, c * c, 2 * c * s], [c * s, -c * s, c * c - s * s]])
    both = np.kron(np.eye(2), turned_voigt(angle))
    return SheetTensors(tensors.metric @ plain.T, both.T @ tensors.stiffness @ both, tensors.curvature @ plain.T)


def difference(one: SheetTensors, other: SheetTensors) -> float:
    pairs = ((one.metric, other.metric), (one.stiffness, other.stiffness), (one.curvature, other.curvature))
    return max(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in pairs)


def test_the_table_of_a_turned_motif_is_the_turned_table() -> None:
    nodes = Size("thickness_mm", (0.3, 0.35, 0.45, 0.6), (0,)), Size("width_mm", (0.8, 1.2, 1.6), (0,))
    plan = LawPlan(motif_design(parallel()), nodes, (1.35,), 2.0)
    cells, angle = random_tensors(12), 0.7
    sizes = np.column_stack([np.linspace(0.31, 0.59, 9), np.linspace(1.5, 0.9, 9)])
    solved = np.ones((4, 3), dtype=bool)

    def at(tensors: SheetTensors) -> SheetTensors:
        return MotifTable(plan, 1.35, stored_tensors(tensors).reshape(4, 3, -1), solved)(sizes)

    plain, other = at(cells), at(turned(cells, angle))
    assert difference(other, turned(plain, angle)) < 1e-10
    # and the errors do not depend on the axes
    elsewhere = random_tensors(9, seed=8)
    np.testing.assert_allclose(
        tensor_errors(turned(plain, angle), turned(elsewhere, angle)), tensor_errors(plain, elsewhere), rtol=1e-8
    )


THINNER = {"profile": "radial", "from": 0.5, "to": 0.4, "over_mm": 30.0}


def tensors_at(law: MotifLaw, design: Design, points: np.ndarray) -> SheetTensors:
    values = law.evaluate_at(design, points)
    return SheetTensors(values.metric, values.stiffness, values.curvature)


@pytest.mark.slow
def test_left_out_sizes_are_within_the_stated_errors(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    motif, lattice = parallel()
    rods = {"motif": motif, "thickness_mm": THINNER}
    sheet = {"rods": rods, "lattice": lattice, "border": {"rectangle_mm": (60, 60)}, "mesh": {"edge_mm": 2.5}}
    sheet["fabric"] = {"bending": "paper"}
    design = Design.from_dict(sheet)
    law = law_of(design, tmp_path, monkeypatch, None)
    stated = [each["largest_percent"] for each in law.residuals["1.35"]["held_out"]["errors"].values()]
    for radius in (4.0, 17.0):
        thickness = 0.5 - 0.1 * radius / 30.0
        cell = motif_tensors(motif_responses(motif_design(parallel(), thickness), 2.5).to_dict())
        errors = tensor_errors(tensors_at(law, design, np.array([[radius, 0.0]])), cell)[0]
        assert (errors <= 2.0 * np.array(stated) + 0.01).all(), (errors, stated)
        assert errors.max() < 0.5


@pytest.mark.slow
def test_unequal_stretch_has_a_law(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the stretches of x and y exchanged, a square grid has the law turned by 90 degrees, up to its mesh."""
    designs = [motif_design(grid(), 0.5, fabric={"stretch": pair}) for pair in ([1.35, 1.15], [1.15, 1.35])]
    laws = [law_of(each, tmp_path / str(number), monkeypatch, None) for number, each in enumerate(designs)]
    plain, other = (tensors_at(law, each, np.zeros((1, 2))) for law, each in zip(laws, designs, strict=True))
    assert (tensor_errors(other, turned(plain, np.pi / 2))[0] < [0.01, 0.1, 1.5, 1.0]).all()
    assert abs(plain.curvature[0, 0]) > 1.2 * abs(plain.curvature[0, 1])
    with pytest.raises(ForeignLaw, match=r"fabric.stretch = \[1.15, 1.35\]: the law was made for \[1.35, 1.15\]"):
        laws[0].check(designs[1])
