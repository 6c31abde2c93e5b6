"""The search from coarse to fine finds the same minimum as one mesh, and records its effort."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.ladder import Ladder
from asterism.discrete.release.levels import SharedSearch, solve_on_meshes
from asterism.discrete.release.prolongation import prolong
from asterism.pattern import gallery
from asterism.pattern.geometry.rigid_fit import rigid_fit
from tests.discrete.models import model_of


def model(edge: float, **changes: object) -> DiscreteModel:
    data = gallery.load("tube").to_dict()
    data["border"] = {"rings": 1}
    data["mesh"] = {"edge_mm": edge}
    data["fabric"] |= {"bending": "paper"}
    return model_of(data | changes, edge)


def search(edge: float, **changes: object) -> SharedSearch:
    """All meshes of a search that ends on this edge."""
    fine = model(edge, **changes)
    return SharedSearch(Ladder(fine.design, fine.layout))


# a saw cut
SLIT = {"polygon_mm": [[-25, -25], [25, -25], [25, -0.05], [3, 0], [25, 0.05], [25, 25], [-25, 25]]}


@pytest.mark.parametrize("border", [{"rings": 1}, SLIT])
@pytest.mark.slow
def test_levels_agree_with_one_mesh(border: dict[str, object]) -> None:
    fine = model(1.0, border=border)
    found, levels = solve_on_meshes(search(1.0, border=border))
    assert [level.vertices for level in levels][-1] == fine.n_vertices
    assert len(levels) == 2 and levels[0].vertices < fine.n_vertices / 2
    assert found.iterations == sum(level.iterations for level in levels)
    alone = solve_on_mesh(fine)
    assert found.is_minimum and alone.is_minimum
    assert found.energy == pytest.approx(alone.energy, rel=1e-9)


@pytest.mark.slow
def test_a_coarse_mesh_is_solved_as_accurately_as_the_next_mesh_needs() -> None:
    sheet = model(3.4)
    accurate, early = (solve_on_mesh(sheet, coarse=coarse) for coarse in (False, True))
    assert accurate.is_minimum and not early.is_minimum
    assert early.factorisations < accurate.factorisations
    assert early.energy == pytest.approx(accurate.energy, rel=1e-9)
    rotation, shift = rigid_fit(early.state.positions, accurate.state.positions)
    np.testing.assert_allclose(early.state.rotated(rotation, shift).positions, accurate.state.positions, atol=1e-3)


@pytest.mark.slow
def test_small_models_have_one_level() -> None:
    _, levels = solve_on_meshes(search(3.0))
    assert len(levels) == 1


def test_prolongation_keeps_the_length_of_the_arms_and_the_shape() -> None:
    coarse, fine = model(3.4), model(1.7)
    found = solve_on_mesh(coarse)
    state = prolong(coarse, found.state, fine)
    edges = state.positions[fine.edges[:, 1]] - state.positions[fine.edges[:, 0]]
    printed = fine.parts["rod_stretch"].params[:, 1]
    np.testing.assert_allclose(np.linalg.norm(edges, axis=1), printed, rtol=2e-3)
    centres = [m.mesh.star_vertices for m in (coarse, fine)]
    between = [
        np.linalg.norm(s.positions[c][:, None] - s.positions[c][None], axis=2)
        for s, c in zip((found.state, state), centres, strict=True)
    ]
    np.testing.assert_allclose(between[0], between[1], atol=0.5)
    normal = (state.directors * edges).sum(axis=1)
    np.testing.assert_allclose(normal, 0.0, atol=1e-12)


@pytest.mark.slow
def test_the_same_answer_on_the_second_run() -> None:
    first, second = (solve_on_meshes(search(1.0))[0] for _ in range(2))
    np.testing.assert_allclose(first.state.positions, second.state.positions, atol=1e-7)
