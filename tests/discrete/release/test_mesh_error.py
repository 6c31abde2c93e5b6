"""The estimate of the mesh error, on shapes whose error is known and on meshes of one sheet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.discrete.model.state import State
from asterism.discrete.release.equilibrium import Equilibrium
from asterism.discrete.release.levels import EDGE_RATIO, Ladder, model_on
from asterism.discrete.release.mesh_error import ORDER, change_percent, mesh_error
from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.results.records.exact import mesh_error_in_words
from asterism.shape.comparison import compare_shapes


def plate_sheet(**mesh: object) -> Design:
    """Seven stars of a dome on the plate."""
    data = gallery.load("dome").to_dict()
    return Design.from_dict(
        data | {"border": {"rings": 1}, "fabric": data["fabric"] | {"bending": "plate"}, "mesh": mesh}
    )


@pytest.mark.parametrize("ratio", [1.3, EDGE_RATIO, 2.0])
def test_errors_of_the_assumed_order_are_found(ratio: float) -> None:
    vertices = [round(500 * ratio ** (2 * n)) for n in range(3)]
    errors = 100.0 * np.array(vertices) ** (-0.5 * ORDER)
    found = mesh_error(vertices, [None, *-np.diff(errors)])
    assert found.percent == pytest.approx(errors[-1], rel=1e-2) and not found.forms_differ


def test_an_accidental_agreement_of_two_meshes_is_not_taken_for_a_small_error() -> None:
    steady, lucky = (
        mesh_error([500, 1000, 2000], [None, 2.0, last]).percent for last in (2.0 * EDGE_RATIO**-ORDER, 0.01)
    )
    assert steady is not None and lucky == pytest.approx(steady, rel=0.05)


def test_one_mesh_and_forms_that_differ_have_no_error() -> None:
    found = mesh_error([500], [None])
    assert found.percent is None and found.change_percent is None and not found.forms_differ
    found = mesh_error([500, 1000, 2000], [None, 0.5, 12.0])
    assert found.forms_differ and found.percent is None and found.change_percent == 12.0
    # once two meshes agree again, the change of form before them does not count
    assert mesh_error([500, 1000, 2000], [None, 12.0, 0.4]).percent == pytest.approx(0.4 / (EDGE_RATIO**ORDER - 1.0))


def end_of(design: Design, plan: Layout, edge: float, height: float, turn: float) -> tuple:
    """A model of a sheet and its print bent to a bowl, turned about z (rad)."""
    model = model_on(design, plan, edge)
    points = model.mesh.points - model.mesh.points.mean(axis=0)
    bowl = np.column_stack([points, height * (points**2).sum(axis=1) / (points**2).sum(axis=1).max()])
    c, s = np.cos(turn), np.sin(turn)
    state = State(bowl @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]), np.empty((0, 3)))
    blank = Equilibrium(state, {}, 0.0, 1.0, 1.0, 0.0, np.empty(0), 0, 0, 0, "none")
    return model, blank


@pytest.mark.parametrize(("pins", "is_free"), [([], True), ([{"where": "border"}], False)])
def test_supported_sheets_differ_as_their_supports_hold_them(pins: list[object], is_free: bool) -> None:
    """A shape that has turned is another one if the supports fix it, and the same if they are free."""
    design = Design.from_dict(plate_sheet().to_dict() | {"pins": pins})
    plan = layout(design)
    fine, coarse = end_of(design, plan, 2.5, 5.0, 0.0), end_of(design, plan, 5.0, 5.0, 0.1)
    change = change_percent(*coarse, *fine)
    assert (change < 0.1) is is_free and (change > 1.0) is not is_free
    higher = replace(fine[1], state=State(fine[1].state.positions * [1.0, 1.0, 1.5], fine[1].state.directors))
    assert change_percent(*coarse, fine[0], higher) > 0.5


def test_the_ladder_makes_finer_meshes_when_they_are_needed() -> None:
    design = plate_sheet()
    ladder = Ladder(design, layout(design))
    assert len(ladder.models) == 1 and ladder.tolerance_percent == 1.0
    assert ladder.finer_than(0) and ladder.finer_than(1) and len(ladder.models) == 3
    assert np.allclose(np.divide(ladder.edges[:-1], ladder.edges[1:]), EDGE_RATIO)
    given = plate_sheet(edge_mm=3.0)
    single = Ladder(given, layout(given))
    assert single.tolerance_percent is None and single.edges[-1] == 3.0
    assert not single.finer_than(len(single.models) - 1)


@pytest.mark.slow
def test_the_search_ends_within_its_tolerance_and_the_error_is_as_stated() -> None:
    fine = exact_shape(plate_sheet(tolerance_percent=0.3))
    coarse = exact_shape(plate_sheet(tolerance_percent=3.0))
    plan = layout(plate_sheet())
    for shape, tolerance in ((fine, 0.3), (coarse, 3.0)):
        s = shape.summary
        assert s["is_minimum"] and s["mesh_error_percent"] <= s["mesh_tolerance_percent"] == tolerance
        assert mesh_error_in_words(s) == f"about {s['mesh_error_percent']:.1f} % of the diameter"
        assert s["levels"][0]["change_percent"] is None and s["levels"][-1]["change_percent"] > 0.0
    assert coarse.summary["vertices"] < fine.summary["vertices"]
    distance = compare_shapes(fine, coarse, plan, symmetries(plate_sheet(), plan)).rms_percent
    assert distance < coarse.summary["mesh_error_percent"] + fine.summary["mesh_error_percent"]


@pytest.mark.slow
def test_a_search_that_ends_at_its_largest_mesh_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("asterism.discrete.release.levels.MAX_VERTICES", 400)
    s = exact_shape(plate_sheet(tolerance_percent=0.1)).summary
    assert s["is_minimum"] and s["mesh_error_percent"] > 0.1
    assert [line.split(":")[-1] for line in s["warnings"] if "above the tolerance of 0.1 %" in line] == [
        f" the search ended at {s['vertices']} vertices"
    ]


@pytest.mark.slow
def test_the_hinges_of_the_paper_have_no_mesh_error() -> None:
    """Their stiffness follows the mesh, so that meshes may agree on a wrong shape."""
    data = gallery.load("tube").to_dict() | {"border": {"rings": 1}, "mesh": {"edge_mm": 1.0}}
    data["fabric"] |= {"bending": "paper"}
    s = exact_shape(Design.from_dict(data)).summary
    assert len(s["levels"]) == 2 and s["mesh_error_percent"] is None and s["mesh_change_percent"] > 0.0
    assert mesh_error_in_words(s).startswith("not known, the stiffness of the hinges follows the mesh; ")
    one = exact_shape(Design.from_dict(data | {"mesh": {"edge_mm": 3.0}})).summary
    assert one["mesh_change_percent"] is None and mesh_error_in_words(one) == "not known, one mesh was solved"


@pytest.mark.slow
def test_summary_says_which_bending_was_used() -> None:
    data = gallery.load("star").to_dict()
    energy = {}
    every = {"hinges", "plate", "folds"}
    for bending, parts in (("paper", {"hinges"}), ("plate", {"plate", "folds"}), ("none", set())):
        data["fabric"] = data["fabric"] | {"bending": bending}
        summary = exact_shape(Design.from_dict(data | {"mesh": {"edge_mm": 2.0}})).summary
        assert summary["fabric_bending"] == bending and summary["is_minimum"]
        assert every & set(summary["energy_parts_n_mm"]) == parts
        energy[bending] = summary["fabric_bending_n_mm"]
        assert energy[bending] == pytest.approx(sum(summary[part] for part in parts))
    assert energy["paper"] > energy["plate"] > energy["none"] == 0.0
