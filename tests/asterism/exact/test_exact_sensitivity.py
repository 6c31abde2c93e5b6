"""Sensitivities of an exact shape against finite changes of its stars."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.ladder import model_on
from asterism.discrete.release.prolongation import fit_to_surface
from asterism.discrete.release.single_mesh import solve_on_mesh
from asterism.equilibrium.arrays import Floats
from asterism.exact.exact_sensitivity import ExactSensitivity, mesh_along_arms
from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.point_location import locate
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import with_painted_stars
from asterism.shape.shape import Shape

SIZES = {"length_mm": 7.0, "thickness_mm": 0.45, "width_mm": 1.2}
PINNED = {"corners": [0, 2, 4], "target_mm": [[20.0, 10.0, 0.0], [-22.0, 2.0, 2.0], [2.0, -23.0, 0.0]]}
# printed points inside of triangles, off the arms
POINTS = np.array([[3.0, 4.0], [-9.0, 11.0], [14.0, -6.0], [-11.0, -7.0], [5.0, -15.0]])


def sheet(pins: list[dict[str, object]]) -> Design:
    """With hinges: on the graded meshes of plates the mesh itself moves, which changes differences by 2.6 %."""
    data = {"stars": dict(SIZES), "border": {"rings": 1}, "pins": pins, "mesh": {"edge_mm": 2.5}}
    return Design.from_dict(data | {"fabric": {"bending": "paper"}})


def places_after(design: Design, shape: Shape, star: int, column: int, change: float) -> Floats:
    """(n, 3) the points after a star has changed, on a mesh of the same triangles."""
    plan = layout(design)
    sizes = np.full((1, 3), np.nan)
    sizes[0, column] = plan.star_sizes_mm[star, column] + change
    changed = with_painted_stars(design, [plan.sites[star]], sizes)
    after = layout(changed)
    mesh = mesh_along_arms(model_on(design, plan, shape.summary["edge_mm"]).mesh, plan, after)
    model = DiscreteModel(changed, after, mesh)
    positions = solve_on_mesh(model, fit_to_surface(model, shape.positions)).state.positions
    triangle, weights = locate(mesh.points, mesh.triangles, POINTS)
    return np.asarray(np.einsum("nk,nkc->nc", weights, positions[mesh.triangles[triangle]]))


@pytest.mark.slow
@pytest.mark.parametrize("pins", [[], [PINNED]], ids=["free", "pinned"])
@pytest.mark.parametrize(("size", "step"), [("length_mm", 0.08), ("thickness_mm", 0.004)])
def test_the_derivative_is_the_limit_of_finite_changes(
    pins: list[dict[str, object]], size: Literal["length_mm", "thickness_mm"], step: float
) -> None:
    design = sheet(pins)
    shape = exact_shape(design)
    moves = ExactSensitivity(design, shape, POINTS).moves(size)
    column = list(SIZES).index(size)
    for star in (0, 5):
        errors = []
        for change in (step, step / 4.0):
            before, after = (places_after(design, shape, star, column, sign * change) for sign in (-1.0, 1.0))
            predicted = before + 2.0 * change * moves[..., star]
            if not pins:
                rotation, shift = rigid_fit(after, before)
                after = after @ rotation.T + shift
                rotation, shift = rigid_fit(predicted, before)
                predicted = predicted @ rotation.T + shift
            errors.append(np.linalg.norm(after - predicted) / np.linalg.norm(predicted - before))
        # the error falls with the step; what is left are the tolerances of the equilibria
        assert errors[1] < 0.02 and (errors[1] < errors[0] or errors[0] < 0.01)


@pytest.mark.slow
def test_stars_changed_together_give_the_same_as_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    design = sheet([PINNED])
    sensitivity = ExactSensitivity(design, exact_shape(design), POINTS)
    together = sensitivity.moves("length_mm")
    monkeypatch.setattr("asterism.exact.exact_sensitivity.EXACT_COLOUR_STEPS", 1000)
    alone = sensitivity.moves("length_mm")
    assert np.abs(together - alone).max() < 1e-6 * np.abs(alone).max()


def test_the_shape_of_another_design_is_refused() -> None:
    star = {"stars": dict(SIZES), "border": {"rings": 0}, "mesh": {"edge_mm": 4.0}}
    design = Design.from_dict(star)
    shape = exact_shape(design)
    with pytest.raises(ValueError, match="has the mesh of another design"):
        ExactSensitivity(Design.from_dict(star | {"border": {"rings": 1}}), shape, np.zeros((1, 2)))
    thicker = Design.from_dict(star | {"stars": SIZES | {"thickness_mm": 0.6}})
    with pytest.raises(ValueError, match="is no minimum of the exact model, which has one"):
        ExactSensitivity(thicker, shape, np.zeros((1, 2)))
