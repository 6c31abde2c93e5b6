"""simulate: the numbers of the summary, what they are made from, warnings, and forces between plastic and fabric."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import asterism
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.exact.simulation import exact_shape, exact_warnings, line_forces
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.materials import Fabric
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.reports.write_results import write_results
from asterism.results.record import keys_of
from asterism.results.records.exact import ExactRecord
from asterism.shape.comparison import compare_shapes
from asterism.shape.shape import Shape
from tests.asterism.previews.designs import edited


def small(name: str = "tube", **sections: dict) -> Design:
    return edited(name, **{"border": {"rings": 1}, "mesh": {"edge_mm": 3.0}} | sections)


@pytest.fixture(scope="module")
def shape() -> asterism.Shape:
    return exact_shape(small())


def test_summary_is_complete(shape: asterism.Shape) -> None:
    s = shape.summary
    assert [name for name, text in keys_of(type(s)).items() if name not in s and not text.endswith("Optional.")] == []
    assert s["converged"] and s["is_minimum"]
    parts = s["energy_parts_n_mm"]
    assert sum(parts.values()) == pytest.approx(s["energy_n_mm"]) and {name: s[name] for name in parts} == parts
    assert s["stars_total"] == 7 and s["stars_up"] == 7
    assert s["vertices"] == len(shape.positions) and s["triangles"] == len(shape.triangles)
    assert 1 / 1.35 < s["contraction"] < 1.0
    assert list(s["extent_mm"]) == sorted(s["extent_mm"], reverse=True)


def test_a_free_sheet_lies_on_its_principal_axes(shape: asterism.Shape) -> None:
    assert shape.height_mm == pytest.approx(shape.extent_mm[2], rel=0.05)
    assert np.abs(shape.positions.mean(axis=0)).max() < 1.0
    assert not shape.held
    # and the design of its summary makes the same shape
    again = exact_shape(Design.from_dict(dict(shape.summary["design"])))
    np.testing.assert_allclose(again.positions, shape.positions, atol=1e-6)


def test_pinned_sheets_stay_where_the_pins_hold_them() -> None:
    design = small("dome")
    shape = exact_shape(design)
    rim = np.isclose(np.linalg.norm(shape.printed, axis=1), np.linalg.norm(shape.printed, axis=1).max())
    np.testing.assert_allclose(shape.positions[rim, :2], 0.74 * shape.printed[rim], atol=1e-12)
    np.testing.assert_allclose(shape.positions[rim, 2], 0.0, atol=1e-12)
    assert shape.held and shape.summary["extent_mm"][2] == shape.summary["height_mm"]


@pytest.mark.slow
def test_a_free_sheet_does_not_fall_before_it_is_pinned() -> None:
    """Nor does one that is never pinned: that is refused."""
    fabric, gravity = {"modulus_mpa": 0.5}, {"on": True}
    late = [{"where": "corners", "scale": 0.8, "step": 1}]
    summary = exact_shape(small(fabric=fabric, gravity=gravity, pins=late)).summary
    assert summary["is_minimum"] and summary["gravity"] != 0.0
    assert max(step["iterations"] for step in summary["path"]) < 100
    with pytest.raises(DesignError, match=r"^gravity\.on = True: .* a free sheet falls"):
        exact_shape(small(fabric=fabric, gravity=gravity))


@pytest.mark.slow
def test_starts_from_a_shape_of_the_design():
    """From its own shape on another mesh, it is back in the same minimum after a few iterations."""
    data = {"stars": {"length_mm": 8.0}, "border": {"rings": 1}}
    coarse, fine = (Design.from_dict(data | {"mesh": {"edge_mm": edge}}) for edge in (2.5, 2.0))
    alone = exact_shape(fine)
    near = exact_shape(fine, near=exact_shape(coarse))
    assert near.summary["is_minimum"] and near.summary["result_is"] == "from a shape that was given"
    assert alone.summary["result_is"] == "the default start's"
    assert near.summary["energy_n_mm"] == pytest.approx(alone.summary["energy_n_mm"], rel=1e-9)
    assert near.summary["iterations"] < 0.5 * alone.summary["iterations"]
    with pytest.raises(ValueError, match="near"):
        exact_shape(fine, starts=2, near=alone)


def sheet(**fabric: Any) -> Design:
    """Seven free stars on an even mesh."""
    return Design.from_dict(
        {
            "stars": {"length_mm": 8.0, "thickness_mm": 0.35},
            "fabric": {"modulus_mpa": Fabric().modulus_mpa, **fabric},
            "border": {"rings": 1},
            "mesh": {"edge_mm": 2.0},
        }
    )


@pytest.mark.slow
def test_three_plates_are_the_papers_hinges() -> None:
    fabric, design = Fabric(), sheet()
    plate_n_mm = fabric.modulus_mpa * fabric.thickness_mm**3 / (12.0 * (1.0 - fabric.poisson**2))
    three = sheet(bending="consistent", bending_stiffness_n_mm=3.0 * plate_n_mm)
    hinges, *others = (exact_shape(each) for each in (design, three, sheet(bending="consistent")))
    assert all(shape.summary["is_minimum"] for shape in (hinges, *others))
    plan = layout(design)
    far = [compare_shapes(hinges, shape, plan, symmetries(design, plan)).rms_percent for shape in others]
    assert far[0] < 2.0 < far[1]


SUMMARY = {
    "converged": True, "is_minimum": True, "smallest_eigenvalue": 1e-3, "gradient_norm": 1e-9,
    "gradient_tolerance": 1e-8, "self_intersections": 0, "self_contact": None, "stars_total": 19,
    "stars_off_branch": [], "mesh_error_percent": None, "mesh_tolerance_percent": None, "vertices": 900,
}  # fmt: skip


def said(scale: float = 1.0, **changes: Any) -> list[str]:
    pins = [{"where": "border", "scale": scale}]
    design = Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 2}, "pins": pins})
    return exact_warnings(ExactRecord.from_json(SUMMARY | changes), design, layout(design))


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"scale": 2.0}, "the pins hold the sheet 2 times as wide"),
        ({"stars_off_branch": [3]}, "1 of 19 stars of the exact shape is not on the side that the design asks for"),
        ({"self_intersections": 4}, "passes through itself (4 crossings); --contact prevents this"),
        ({"self_intersections": 4, "self_contact": {"pairs": 0}}, "(4 crossings)"),
        ({"is_minimum": False, "smallest_eigenvalue": -1e-5}, "smallest eigenvalue -1.0e-05 N/mm is not positive"),
        (
            {"converged": False, "is_minimum": False, "gradient_norm": 1e-3},
            "not an equilibrium: gradient 1.0e-03 N is above 1.0e-08 N",
        ),
    ],
)
def test_what_is_wrong_is_said_once(changes: dict[str, Any], line: str) -> None:
    assert said() == []
    (only,) = said(**changes)
    assert line in only
    if changes.get("self_contact"):
        assert "--contact" not in only


@pytest.mark.parametrize(("axis", "edge", "told"), [(30.0, 2.0, True), (30.0, 0.5, False), (None, 2.0, False)])
def test_a_free_roll_on_a_coarse_mesh_has_no_certain_radius(axis: float | None, edge: float, told: bool) -> None:
    hinges = {"fabric": {"bending": "paper"}}
    free = Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 2}} | hinges)
    summary = ExactRecord.from_json(SUMMARY | {"roll_axis_deg": axis, "edge_mm": edge})
    assert ["depends on the mesh" in line for line in exact_warnings(summary, free, layout(free))] == [True] * told


def star_shape(edge_mm: float, **fabric: float) -> Shape:
    """A single star of the paper's sizes."""
    data = {"border": {"rings": 0}, "stars": {"length_mm": 10.0, "thickness_mm": 0.3}, "mesh": {"edge_mm": edge_mm}}
    shape = exact_shape(Design.from_dict({**data, "fabric": fabric}))
    assert shape.summary["is_minimum"]
    return shape


def test_a_rod_in_a_given_shape_needs_the_forces_of_beam_theory() -> None:
    """A deflection `a x^4` needs the line load `24 a EI` upwards, a displacement `b x^2` the load `-2 b EA`."""
    length, width, thickness = 40.0, 1.2, 0.4
    rods = {"draw": [{"line_mm": [[-length / 2, 0], [length / 2, 0]]}], "thickness_mm": thickness, "width_mm": width}
    border = {"rectangle_mm": [60.0, 20.0]}
    design = Design.from_dict({"border": border, "rods": rods, "fabric": {"bending": "paper"}})
    plan = layout(design)
    model = DiscreteModel(design, plan, mesh_layout(plan, 1.0, "delaunay"))
    at, rod = model.printed_state().positions, model.mesh.rods[0]
    x, modulus = at[:, 0], design.fabric.modulus * design.plastic.modulus_ratio
    inner = np.abs(x[rod][1:] + x[rod][:-1]) < 28.0  # away from the ends, where the rest curvature acts
    for a, b in ((2e-8, 0.0), (-2e-8, 0.0), (0.0, 1e-6)):
        # the second term along x keeps the length of the bent rod
        moved = at + np.column_stack([b * x**2 - 8.0 * a**2 * x**7 / 7.0, 0 * x, a * x**4])
        slope = np.diff(moved[rod, 2]) / np.diff(moved[rod, 0])
        up = np.column_stack([-slope, 0 * slope, np.ones(len(slope))])
        state = State(moved, up / np.linalg.norm(up, axis=1, keepdims=True))
        forces = line_forces(model, state)
        bending = modulus * width * thickness**3 / 12.0
        peel, shear = -24.0 * a * bending, 2.0 * b * modulus * width * thickness
        error = 0.01 * max(abs(peel), shear)
        assert forces["peel_n_per_mm"][inner] == pytest.approx(peel, abs=error)
        assert forces["shear_n_per_mm"][inner] == pytest.approx(shear, abs=error)


@pytest.mark.slow
def test_forces_are_proportional_to_the_moduli_and_converge_with_the_mesh() -> None:
    half, coarse, fine = (star_shape(edge, modulus_mpa=e).summary for edge, e in ((2.4, 1.0), (2.4, 2.0), (1.2, 2.0)))
    assert coarse["peel_star"] == 0
    for name in ("peel_n_per_mm", "shear_n_per_mm"):
        assert coarse[name] == pytest.approx(2.0 * half[name], rel=1e-5)
        assert coarse[name] == pytest.approx(fine[name], rel=0.05)


@pytest.mark.slow
def test_the_bond_is_drawn_where_its_forces_are_known(tmp_path: Path) -> None:
    known, unknown = star_shape(3.0, modulus_mpa=2.0), star_shape(3.0)
    assert "bond.png" in write_results(known, tmp_path / "known")
    red, _, blue = np.moveaxis(np.asarray(Image.open(tmp_path / "known" / "bond.png").convert("RGB"), dtype=int), 2, 0)
    assert np.count_nonzero(red > blue + 60) > 200
    assert "bond.png" not in write_results(unknown, tmp_path / "unknown")
    assert unknown.summary["peel_n_per_mm"] is None and "peel_n_per_mm" not in unknown.rod_fields
    assert "fabric" not in unknown.summary.table()
