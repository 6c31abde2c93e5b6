"""The law: exact where it must be, smooth, never silent out of its range, refused where it does not belong.

The law that comes with the package: how good it says it is, and what it is made of.
"""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.interpolate import Akima1DInterpolator, CubicSpline, PchipInterpolator

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.campaign.fit_law import fill_failed_rows, fit_law, held_out_errors, sample_quantities
from asterism.homogenize.campaign.kept_samples import attempt
from asterism.homogenize.errors import CampaignError, LawError
from asterism.homogenize.law.hermite_grid import HermiteGrid, SlopeRule, node_slopes
from asterism.homogenize.law.law_file import law_bytes, law_digest, load_law
from asterism.homogenize.law.material import PAPER_MATERIAL, Material, load_material
from asterism.homogenize.law.plan import CellTask, LawPlan, SampleRecord
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL, QUANTITY_NAMES, StarLaw, to_stored
from asterism.pattern.design.design import Design
from tests.homogenize import fake

PLAN = {
    "stretches": [1.35, 1.75],
    "lengths_mm": [1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0],
    "thicknesses_mm": [0.2, 0.3, 0.4, 0.6],
    "widths_mm": [0.8, 1.2, 1.6],
    "held_out": 10,
}


def law(respond: Any = fake.solve_cell, **plan: Any) -> StarLaw:
    return fitted(Material.from_dict({"name": "test", "plan": {**PLAN, **plan}}).law_plan(), respond)


def fitted(plan: LawPlan, respond: Any, tasks: list[CellTask] | None = None) -> StarLaw:
    records = []
    for task in tasks or plan.tasks():
        cell = plan.cell_design(task)
        answer = attempt(lambda cell=cell: respond(cell, 2.0).to_dict(), ArithmeticError)
        records.append(SampleRecord(task, plan.label(task), answer.sample, answer.failed, 0.1))
    law = fit_law(plan, records, {"command": "none"})
    assert isinstance(law, StarLaw)
    return law


LAW = law()


def npz(**arrays: Any) -> bytes:
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


def spoiled(path: Path, **changes: Any) -> Path:
    """The file of the law with other arrays."""
    with np.load(io.BytesIO(law_bytes(LAW))) as archive:
        arrays = {name: np.array(archive[name]) for name in archive.files}
    path.write_bytes(npz(**arrays | {name: change(arrays[name]) for name, change in changes.items()}))
    return path


def packed(data: Any) -> Floats:
    return np.frombuffer(json.dumps(data).encode(), np.uint8)


def design(**changes: Any) -> Design:
    data: dict[str, Any] = {"stars": {"length_mm": 5.0}, "border": {"rings": 1}}
    for place, value in changes.items():
        section, key = place.split("__")
        data.setdefault(section, {})[key] = value
    return Design.from_dict(data)


@pytest.mark.parametrize("stretch", [1.35, 1.75])
def test_bare_fabric_is_exact(stretch: float) -> None:
    values = LAW.at(stretch)(np.zeros(5), np.array([0.2, 0.31, 0.6, 5.0, 0.01]), 1.1)
    assert np.abs(values.value["lam"] * stretch - 1).max() < 1e-14 and values.inside.all()
    assert (values.value["kappa"] == 0).all() and np.abs(values.value["bending"] - 0.5).max() < 1e-14


def test_cells_of_the_plan_are_met_exactly() -> None:
    table = LAW.at(1.35)
    sizes = np.stack(np.meshgrid(*table.plan.axis_nodes, indexing="ij"), axis=-1).reshape(-1, 3)
    values = table(*sizes.T)
    for q, name in enumerate(QUANTITY_NAMES):
        nodes = table.node_values[..., q].ravel()
        assert np.abs(values.value[name] - nodes).max() <= 1e-13 * np.abs(nodes).max(), name


def test_neighbouring_boxes_join_smoothly() -> None:
    rng = np.random.default_rng(1)
    axes = [np.array([0.0, 1, 3, 4]), np.array([0.0, 2, 3]), np.array([0.0, 1, 4])]
    grid = HermiteGrid(axes, rng.random((4, 3, 3, 2)), ["monotone", "smooth"])
    for axis, node in ((0, 1.0), (0, 3.0), (1, 2.0), (2, 1.0)):
        points = rng.random((20, 3)) * [4, 3, 4]
        step, values = 1e-6, []
        for steps in (-2, -1, 1, 2):
            points[:, axis] = node + steps * step
            values.append(grid(points))
        far_before, before, after, far_after = values
        assert np.abs(after - before).max() < 1e-4
        # second derivatives jump there
        assert np.abs((far_after - after) - (before - far_before)).max() < 1e-4 * step


@pytest.mark.parametrize(
    ("sizes", "word"),
    [
        ((12.1, 0.3, 1.0), "length_mm = 12.1 is outside the law's 0 to 12"),
        ((5, 0.19, 1.0), "thickness_mm = 0.19 is outside the law's 0.2 to 0.6"),
        ((5, 0.3, 1.7), "width_mm = 1.7 is outside the law's 0.8 to 1.6"),
        ((float("nan"), 0.3, 1.0), "length_mm = nan"),
        ((-1, 0.3, 1.0), "length_mm = -1"),
    ],
)
def test_out_of_range_is_said_and_clamped(sizes: tuple[float, float, float], word: str) -> None:
    good = (5.0, 0.3, 1.0)
    table = LAW.at(1.35)
    values = table(*np.transpose([good, sizes, good]))
    assert values.inside.tolist() == [True, False, True]
    assert list(values.outside) == [1] and values.outside[1].startswith(word)
    nearest = table(*np.clip(np.nan_to_num(sizes), *table.plan.limits))
    assert {name: v[1] for name, v in values.value.items()} == pytest.approx(
        {name: v[0] for name, v in nearest.value.items()}, rel=1e-12
    )


@pytest.mark.parametrize("lengths", [[9.0], [9.0, 10.0]])
def test_one_length_answers_for_itself_and_not_for_shorter_arms(lengths: list[float], tmp_path: Path) -> None:
    own = law(stretches=[1.35], lengths_mm=lengths, thicknesses_mm=[0.3], widths_mm=[1.2], held_out=0)
    values = own.at(1.35)([0.0, 9.0, 5.0, 9.0, 9.0], [0.3, 0.3, 0.3, 0.31, 0.3], [1.2, 1.2, 1.2, 1.2, 1.3])
    assert values.inside.tolist() == [True, True, False, False, False]
    its = "9" if len(lengths) == 1 else "9 to 10"
    assert values.outside[2] == f"length_mm = 5 is outside the law's {its}"
    assert values.outside[3] == "thickness_mm = 0.31 is outside the law's 0.3"
    cell = fake.solve_cell(design(stars__length_mm=9.0, stars__thickness_mm=0.3, stars__width_mm=1.2), 2.0).data
    assert values.value["lam"][1] == pytest.approx(cell["lam"], rel=1e-12)
    assert values.value["kappa"][1] == pytest.approx(cell["natural_curvature"][0], rel=1e-12)
    (tmp_path / "own.npz").write_bytes(law_bytes(own))
    assert load_law(tmp_path / "own.npz").at(1.35)(9.0, 0.3, 1.2).inside.all()


def test_cells_without_an_answer_are_marked_with_their_surroundings() -> None:
    holed = law(fake.fails_when_thin)
    table = holed.at(1.35)
    assert (~table.solved).sum() == 6
    values = table(np.array([9.0, 11.0, 7.9, 9.0]), np.array([0.25, 0.25, 0.25, 0.31]), 1.0)
    assert values.inside.tolist() == [False, False, True, True]
    assert "no cell was solved near length_mm = 9" in values.outside[0]
    assert sum(s["problem"] is not None for s in holed.samples) >= 12


def test_the_contraction_of_a_tube_is_that_of_its_area() -> None:
    """The geometric mean of the stretches around and along it."""
    sample = fake.solve_cell(Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 1}}), 2.0).data
    sample |= {"natural_hoop": [0.9, 0.9, 0.8], "natural_axial": [0.8, 0.8, 0.9]}
    assert sample_quantities(sample, 1.35)[QUANTITY_NAMES.index("lam_n")] == pytest.approx(np.sqrt(0.72), rel=1e-12)


def test_beyond_the_last_answer_rows_go_on_in_a_straight_line() -> None:
    """Shorter arms that have none lie between two that do."""
    lengths = np.array([0.0, 1.0, 2.0, 4.0, 5.0, 6.0])
    stored = np.stack([lengths**2, -3.0 * lengths], axis=-1)[:, None, None]
    good = np.array([True, True, False, True, False, False])[:, None, None]
    coordinates = [lengths, np.zeros(1), np.zeros(1)]
    whole = fill_failed_rows(coordinates, np.where(good[..., None], stored, np.nan))[:, 0, 0]
    np.testing.assert_array_equal(whole[[0, 1, 3]], stored[[0, 1, 3], 0, 0])
    np.testing.assert_allclose(whole[4:], [[21.0, -15.0], [26.0, -18.0]], rtol=1e-13)
    assert 1.0 < whole[2, 0] < 16.0 and whole[2, 1] == pytest.approx(-6.0)


def test_bare_fabric_alone_says_nothing_about_stars() -> None:
    lengths, widths = np.array([0.0, 7.0]), np.array([0.9, 1.0, 1.2])
    curl = np.array([[0.0, 0.0, 0.0], [np.nan, 0.105, 0.097]])
    whole = fill_failed_rows([lengths, widths], curl[..., None], has_bare=True)[..., 0]
    assert whole[1] == pytest.approx([0.109, 0.105, 0.097])
    table = HermiteGrid([lengths, widths], whole[..., None], ["monotone"])
    between = table(np.column_stack([np.full(9, 7.0), np.linspace(1.0, 1.2, 9)]))[:, 0]
    assert between.max() == pytest.approx(0.105) and (np.diff(between) < 0.0).all()


def test_sheets_that_hardly_curl_have_no_sixfold_part() -> None:
    """The energies of two directions differ by rounding there, and a cubic makes much of it."""
    cell = fake.solve_cell(design(), 2.0).data
    for curl, sixfold in ((0.029, 0.0), (0.031, 7.0), (-0.031, 7.0)):
        rolled = {"natural_curvature": [curl / cell["spacing_mm"]] * 3, "sixfold": 7.0}
        assert sample_quantities(cell | rolled, 1.35)[QUANTITY_NAMES.index("c3")] == sixfold


def _curls_down(design: Design, edge_mm: float) -> fake.Answer:
    answer = fake.curls_more(design, edge_mm)
    answer.data["natural_curvature"] = [-kappa for kappa in answer.data["natural_curvature"]]
    return answer


@pytest.mark.slow
def test_tight_sheets_are_marked_and_keep_their_values() -> None:
    values = LAW.at(1.35)(np.array([2.0, 12.0]), 0.2, 1.2)
    curls = 17.320508 * values.value["kappa"]
    assert values.not_scale_separated.tolist() == [False, False] and curls.max() < 1.5
    tighter, down = (law(each).at(1.35)(np.array([2.0, 12.0]), 0.2, 1.2) for each in (fake.curls_more, _curls_down))
    assert down.not_scale_separated.tolist() == [False, True]
    assert tighter.not_scale_separated.tolist() == [False, True] and tighter.inside.all()
    np.testing.assert_allclose(tighter.value["kappa"], 4 * values.value["kappa"], rtol=1e-3)
    held = law(fake.curls_more).residuals["1.35"]["held_out"]
    assert held["tight"]["count"] > 0 and held["count"] + held["tight"]["count"] == 10


def test_reliefs_are_those_of_the_cells_and_flat_without_arms() -> None:
    table = LAW.at(1.35)
    found = table.corrugation(np.array([0.0, 4.0, 5.0]), 0.3, 1.2)
    assert found.shape == (3, 2, len(LAW.waves)) and (found[0] == 0.0).all()
    expected = 0.02 * np.outer([4.0, 5.0], np.arange(24.0)).reshape(2, 2, 12)
    np.testing.assert_allclose(found[1:], expected, atol=2e-3)
    np.testing.assert_array_equal(table.corrugation(99.0, 0.3, 1.2), table.corrugation(12.0, 0.3, 1.2))


def test_held_out_cells_are_met() -> None:
    for entry in LAW.residuals.values():
        held = entry["held_out"]
        assert held["count"] == 10
        assert held["errors"]["lam"]["largest_percent"] < 0.2
        assert held["errors"]["kappa"]["largest_percent"] < 3 and held["errors"]["bending"]["largest_percent"] < 3


def test_errors_are_of_the_cell_or_of_a_part_of_the_largest() -> None:
    """Of a tenth for what changes its sign, of three hundredths else: a cell near zero does not count for all."""
    table = LAW.at(1.35)
    values = {name: float(value[0]) for name, value in table(7.0, 0.35, 1.0).value.items()}
    cell = values | {"lam": values["lam"] / 1.01, "a12": 0.0, "c3": 0.0, "offset_mm": 0.0}
    task = CellTask(1.35, True, (7.0, 0.35, 1.0))
    row = to_stored(np.array([cell[name] for name in QUANTITY_NAMES]), table.spacing_mm)
    found = held_out_errors(table, [(task, row)])
    percent = found["cells"][0]["error_percent"]
    assert percent["lam"] == pytest.approx(1.0) and percent["kappa"] == 0.0
    for name, part in (("a12", 0.1), ("c3", 0.1), ("offset_mm", 0.03)):
        largest = table.node_values[..., QUANTITY_NAMES.index(name)].max()
        assert percent[name] == pytest.approx(100.0 * values[name] / (part * largest)), name
    assert found["errors"]["c3"]["largest_percent"] == percent["c3"]


def test_a_file_holds_all_of_it(tmp_path: Path) -> None:
    path = tmp_path / "law.npz"
    path.write_bytes(law_bytes(LAW))
    again = load_law(path)
    assert law_bytes(again) == law_bytes(LAW) and law_digest(again) == law_digest(LAW)
    assert again.made == {"command": "none"} and len(again.samples) == len(LAW.plan.tasks())
    found, known = (one.at(1.75)(7.3, 0.33, 1.1).value for one in (again, LAW))
    assert found == known


def test_a_law_from_before_a_size_was_known_is_for_its_usual_value(tmp_path: Path) -> None:
    known = law(widths_mm=[1.2])
    with np.load(io.BytesIO(law_bytes(known))) as archive:
        arrays = {name: np.array(archive[name]) for name in archive.files}
    plan = json.loads(arrays["plan"].tobytes())
    assert plan["sizes"].pop()["key"] == "width_mm"
    arrays["plan"] = np.frombuffer(json.dumps(plan).encode(), np.uint8)
    arrays |= {name: array[:, :, 0] for name, array in arrays.items() if "/" in name}
    np.savez(tmp_path / "law.npz", **arrays)
    assert law_digest(load_law(tmp_path / "law.npz")) == law_digest(known)
    # sizes of a later version, twice, or in another order are none that this one knows
    length, thickness = plan["sizes"]
    for sizes in ([length, thickness, {"key": "height_mm", "nodes": [1.0]}], [length, length], [thickness, length]):
        arrays["plan"] = np.frombuffer(json.dumps(plan | {"sizes": sizes}).encode(), np.uint8)
        np.savez(tmp_path / "law.npz", **arrays)
        with pytest.raises(LawError, match="is not a law, or damaged"):
            load_law(tmp_path / "law.npz")


def test_files_that_are_no_laws(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, cut = tmp_path / "law.npz", io.BytesIO()
    header = b"{'descr': '<i8', 'fortran_order': False, 'shape': (L,".ljust(117) + b"\n"
    with zipfile.ZipFile(cut, "w") as archive:
        archive.writestr("format.npy", b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + bytes(8))
    no_array = npz(format=np.array({"a": 1}, dtype=object))
    for content in (b"", b"PK nonsense", law_bytes(LAW)[:900], npz(a=np.zeros(3)), no_array, cut.getvalue()):
        path.write_bytes(content)
        with pytest.raises(LawError, match="is not a law") as caught:
            load_law(path)
        assert str(path) in str(caught.value) and "\n" not in str(caught.value)
    with pytest.raises(LawError, match="cannot be read: No such file"):
        load_law(tmp_path / "none.npz")
    path.write_bytes(law_bytes(LAW))
    monkeypatch.setattr("asterism.homogenize.law.law_file.LAW_FORMAT", 99)
    with pytest.raises(LawError, match="has format 5, this version reads 99; make it again"):
        load_law(path)


def test_a_byte_that_changed_is_told_in_one_line(tmp_path: Path) -> None:
    """Wherever it is: in the archive's own tables, or in what it packs."""
    path, whole = tmp_path / "law.npz", law_bytes(LAW)
    rng = np.random.default_rng(3)
    told = 0
    for place in [*rng.integers(0, 3000, 60), *rng.integers(len(whole) - 3000, len(whole), 60)]:
        path.write_bytes(whole[:place] + bytes([whole[place] ^ int(rng.integers(1, 256))]) + whole[place + 1 :])
        try:
            load_law(path)
        except LawError as error:
            assert str(path) in str(error) and "\n" not in str(error)
            told += 1
    assert told > 60


def zero_size(number: int) -> Any:
    plan = LAW.plan.to_dict()
    plan["sizes"][number]["nodes"][0] = 0.0
    return lambda _: packed(plan)


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize(
    ("name", "changed"),
    [
        *(("plan", zero_size(number)) for number in range(3)),
        ("made", lambda _: packed([])),
        ("residuals", lambda _: packed({"1.35": {"held_out": {}}})),
        ("0/stored", lambda stored: np.where(np.arange(stored.size).reshape(stored.shape) == 9, np.nan, stored)),
        ("0/solved", lambda solved: solved.astype(float)),
        ("0/stored", lambda stored: stored[..., :-1]),
        ("1/stored", lambda stored: stored[1:]),
    ],
)
def test_laws_of_impossible_numbers_or_parts_of_others_are_damaged(name: str, changed: Any, tmp_path: Path) -> None:
    with pytest.raises(LawError, match="is not a law, or damaged"):
        load_law(spoiled(tmp_path / "law.npz", **{name: changed}))


def test_stars_turned_by_half_a_turn_have_their_relief_turned() -> None:
    """In print a star's bump turns with it; 120 degrees change nothing."""
    sizes = ([8.0, 5.0], 0.3, 1.2)
    offsets = np.random.default_rng(1).uniform(-9.0, 9.0, (20, 2))
    reliefs = {
        turn: LAW.corrugation(design(lattice__orientation_deg=turn), *sizes) for turn in (0.0, 60.0, 120.0, 180.0)
    }
    heights = {turn: relief @ LAW.waves(offsets).T for turn, relief in reliefs.items()}
    np.testing.assert_array_equal(reliefs[0.0], LAW.at(1.35).corrugation(*sizes))
    np.testing.assert_array_equal(reliefs[120.0], reliefs[0.0])
    for turn in (60.0, 180.0):
        np.testing.assert_allclose(reliefs[turn] @ LAW.waves(-offsets).T, heights[0.0], atol=1e-12)
        assert np.abs(heights[turn] - heights[0.0]).max() > 0.1


def test_a_law_says_for_which_designs_it_is() -> None:
    assert LAW.check(design()).stretch == 1.35 and LAW.check(design(fabric__stretch=1.75)).stretch == 1.75
    # in the four digits of a measured material; a fifth of a percent of E1/E2 is a fifth of a percent of the curvature
    LAW.check(design(plastic__modulus_ratio=3203.0))
    # what does not change the shape of a sheet without weight, or is the same star after a turn
    LAW.check(design(fabric__modulus_mpa=1.0, fabric__density_kg_m3=100.0))
    for turn in (-180.0, 60.0, 120.0):
        LAW.check(design(lattice__orientation_deg=turn))
    # the same lattice in another basis, but not one of every other star
    a, b = (np.array([[15.0, 5 * 3**0.5], [0.0, 10 * 3**0.5]])).tolist()
    rectangle = {"rectangle_mm": [60, 60]}
    for basis in ([b, a], [a, [-15.0, 5 * 3**0.5]]):
        custom = {"kind": "custom", "vectors_mm": basis}
        LAW.check(Design.from_dict({"stars": {"length_mm": 5.0}, "lattice": custom, "border": rectangle}))
    custom = {"kind": "custom", "vectors_mm": [a, [0.0, 20 * 3**0.5]]}
    with pytest.raises(LawError, match=r"lattice.kind = custom"):
        LAW.check(Design.from_dict({"stars": {"length_mm": 5.0}, "lattice": custom, "border": rectangle}))


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"fabric__stretch": 1.5}, "fabric.stretch = 1.5: the law was made for 1.35, 1.75"),
        ({"fabric__stretch": [1.35, 1.3]}, "fabric.stretch = [1.35, 1.3]: the law was made for 1.35, 1.75"),
        ({"fabric__modulus_mpa": [8.0, 4.0]}, "fabric.modulus_mpa = 8 MPa along and 4 MPa across the grain at 0 deg"),
        ({"fabric__thickness_mm": 0.7}, "fabric.thickness_mm = 0.7: the law is for another material, of 0.8"),
        ({"fabric__bending": "consistent"}, "fabric.bending = consistent: the law is for another material"),
        ({"plastic__modulus_ratio": 3210.0}, "plastic.modulus_ratio = 3210.0: the law is for another material"),
        ({"plastic__kappa_bar_per_mm": 1e-4}, "plastic.kappa_bar_per_mm = 0.0001: the law is for another material"),
        ({"lattice__spacing_mm": 18.0}, "lattice.spacing_mm"),
        ({"lattice__arms": 6}, "lattice.arms"),
        ({"lattice__orientation_deg": 30.0}, "lattice.orientation_deg = 30.0: the law is for another lattice, of 0.0"),
    ],
)
def test_foreign_designs_are_refused_with_what_differs(change: dict[str, Any], word: str) -> None:
    with pytest.raises(LawError) as caught:
        LAW.check(design(**change))
    assert word in str(caught.value) and "\n" not in str(caught.value)


def test_stiffness_follows_the_modulus() -> None:
    soft, hard = (LAW.evaluate(design(fabric__modulus_mpa=e), 7.0, 0.3, 1.0) for e in (7.1875, 14.375))
    assert hard.value["bending"] == pytest.approx(2 * soft.value["bending"])
    assert hard.value["a11"] == pytest.approx(2 * soft.value["a11"])
    assert hard.value["kappa"] == soft.value["kappa"] and hard.value["lam"] == soft.value["lam"]


@pytest.mark.slow
def test_cells_that_are_held_out_do_not_make_the_law() -> None:
    def else_elsewhere(design: Design, edge_mm: float) -> fake.Answer:
        answer = fake.solve_cell(design, edge_mm)
        sizes = tuple(getattr(design.stars, f"{name}_mm") for name in ("length", "thickness", "width"))
        answer.data["lam"] *= 2.0 if sizes in held_out else 1.0
        return answer

    plan = Material.from_dict({"plan": {"stretches": [1.35], "held_out": 10}}).law_plan()
    tasks = [task for task in plan.tasks() if task.held_out]
    held_out = {task.sizes for task in tasks}
    cells = fitted(plan, else_elsewhere).at(1.35)
    assert len(tasks) == 10
    sizes = np.array(sorted(held_out)).T
    known = fitted(plan, fake.solve_cell).at(1.35)(*sizes).value["lam"]
    assert cells(*sizes).value["lam"] == pytest.approx(known, abs=1e-14)


def test_a_law_needs_an_answer_of_half_of_its_cells() -> None:
    def below(longest: float) -> Any:
        def some(design: Design, edge_mm: float) -> fake.Answer:
            short = float(design.stars.length_mm) <= longest  # type: ignore[arg-type]
            return fake.solve_cell(design, edge_mm) if short else fake.no()

        return some

    lengths = [2.0, 4.0, 6.0, 8.0]
    assert law(below(4.0), lengths_mm=lengths).at(1.35).solved.sum() == 3 * 4 * 3
    with pytest.raises(CampaignError, match="fewer than half"):
        law(below(2.0), lengths_mm=lengths)


@pytest.mark.slow
def test_bare_fabric_has_an_answer_where_short_arms_have_none() -> None:
    def fails_when_short(design: Design, edge_mm: float) -> fake.Answer:
        short = 0.0 < float(design.stars.length_mm) < 3.0  # type: ignore[arg-type]
        return fake.no() if short else fake.solve_cell(design, edge_mm)

    table = law(fails_when_short).at(1.35)
    assert table([0.0, 0.5, 5.0], 0.3, 1.2).inside.tolist() == [True, False, True]


def test_damaged_cells_of_a_law_are_named_when_they_are_read(tmp_path: Path) -> None:
    """They are unpacked at the first access: a preview does without them."""
    law = load_law(spoiled(tmp_path / "law.npz", samples=lambda packed: np.append(packed[:99], packed[99:] ^ 255)))
    with pytest.raises(LawError, match=r"law\.npz: its cells are damaged"):
        len(law.samples)


STEPS = hnp.arrays(float, st.integers(3, 8), elements=st.floats(0.1, 10.0))
# whole numbers give equal secants and secants of zero
VALUES = st.one_of(st.floats(-100.0, 100.0, allow_subnormal=False), st.integers(-2, 2).map(float))


def scipy_slopes(nodes: Floats, values: Floats, axis: int, rule: SlopeRule) -> Floats:
    if rule == "monotone":
        return np.asarray(PchipInterpolator(nodes, values, axis=axis).derivative()(nodes))
    if rule == "spline":
        return np.asarray(CubicSpline(nodes, values, axis=axis)(nodes, 1))
    return np.asarray(Akima1DInterpolator(nodes, values, axis=axis, method="makima").derivative()(nodes))


@pytest.mark.slow
@pytest.mark.parametrize("rule", ["monotone", "smooth", "spline"])
@settings(deadline=None, max_examples=60)
@given(steps=STEPS, data=st.data())
def test_slopes_are_those_of_scipy(rule: SlopeRule, steps: Floats, data: st.DataObject) -> None:
    nodes = np.cumsum(steps)
    if len(nodes) == 3 and rule == "smooth":
        rule = "monotone"  # three nodes have a parabola with the other rule
    values = data.draw(hnp.arrays(float, (2, len(nodes), 3), elements=VALUES))
    expected = scipy_slopes(nodes, values, 1, rule)
    np.testing.assert_allclose(node_slopes(nodes, values, 1, rule), expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("rule", ["monotone", "smooth", "spline"])
@pytest.mark.parametrize("count", [2, 3, 5])
def test_straight_lines_have_their_slope(rule: SlopeRule, count: int) -> None:
    nodes = np.arange(count) ** 1.5
    np.testing.assert_allclose(node_slopes(nodes, 2.0 - 3.0 * nodes, 0, rule), -3.0, rtol=1e-12)


@pytest.fixture(scope="module")
def papers() -> StarLaw:
    return load_law()


def test_it_is_of_the_plan_that_comes_with_it(papers: StarLaw) -> None:
    """And says by which command, with which versions, on what machine and in what time."""
    assert papers.plan == load_material(PAPER_MATERIAL).law_plan()
    assert papers.made["command"] == "asterism calibrate"
    assert {"asterism", "numpy", "scipy"} <= set(papers.made["versions"]) and papers.made["machine"]["cores"] > 0
    assert papers.made["cell_seconds"] > 0.0


@pytest.mark.parametrize("stretch", ["1.35", "1.75"])
def test_cells_that_it_has_not_seen(papers: StarLaw, stretch: str) -> None:
    """Over the stated range, in percent of the cell."""
    held = papers.residuals[stretch]["held_out"]
    assert held["count"] + held["tight"]["count"] == papers.plan.held_out and held["count"] > 20
    typical = {"lam": 0.05, "lam_n": 0.05, "kappa": 1.0, "bending": 1.0}
    assert all(held["errors"][name]["median_percent"] < percent for name, percent in typical.items())
    allowed = {"lam": 0.2, "lam_n": 0.2, "kappa": 8.0, "bending": 8.0}
    worst = {name: held["errors"][name]["largest_percent"] for name in allowed}
    assert all(worst[name] < percent for name, percent in allowed.items()), worst
    for cell in held["cells"]:
        (a, b), (own, other) = ((cell[which]["a11"], cell[which]["a12"]) for which in ("law", "cell"))
        if not cell["tight"]:
            assert _size(a - own, b - other) < 0.08 * _size(own, other), cell


def _size(a11: float, a12: float) -> float:
    """Frobenius norm of an isotropic plane stiffness."""
    return float(np.sqrt(2.0 * a11**2 + 2.0 * a12**2 + (a11 - a12) ** 2))


def test_every_cell_of_the_stated_range_bumps_up(papers: StarLaw) -> None:
    seen = 0
    for cell in papers.samples:
        found = cell["sample"]
        assert found is not None, cell
        curl = np.mean(found["natural_curvature"]) * found["spacing_mm"]
        if curl > MAX_SEPARATED_CURL or cell["length_mm"] == 0.0:
            continue
        seen += 1
        assert cell["problem"] is None, cell
        assert min(found["natural_bump_mm"]) > 0.0
    assert seen > 0.6 * len(papers.samples)
