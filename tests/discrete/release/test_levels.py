"""The search from coarse to fine finds the same minimum as one mesh, and records its effort."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.discrete.model.state import State
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.levels import Ladder, SharedSearch, is_same_state, solve_on_meshes
from asterism.discrete.release.prolongation import fit_to_surface, prolong
from asterism.pattern.geometry.rigid_fit import rigid_fit
from tests.discrete.models import paper_tube

FINE_MM = 1.6


@pytest.fixture(autouse=True)
def small_meshes(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that a search on FINE_MM has a coarser mesh before."""
    monkeypatch.setattr("asterism.discrete.release.levels.COARSE_VERTICES", 500)


def search(edge: float, **changes: object) -> SharedSearch:
    """All meshes of a search that ends on this edge."""
    fine = paper_tube(edge, **changes)
    return SharedSearch(Ladder(fine.design, fine.layout))


# a saw cut
SLIT = {"polygon_mm": [[-25, -25], [25, -25], [25, -0.05], [3, 0], [25, 0.05], [25, 25], [-25, 25]]}


@pytest.mark.parametrize("border", [{"rings": 1}, SLIT])
@pytest.mark.slow
def test_levels_agree_with_one_mesh(border: dict[str, object]) -> None:
    fine = paper_tube(FINE_MM, border=border)
    found, levels = solve_on_meshes(search(FINE_MM, border=border))
    assert [level.vertices for level in levels][-1] == fine.n_vertices
    assert len(levels) == 2 and levels[0].vertices < fine.n_vertices / 2
    assert found.iterations == sum(level.iterations for level in levels)
    alone = solve_on_mesh(fine)
    assert found.is_minimum and alone.is_minimum
    assert found.energy == pytest.approx(alone.energy, rel=1e-9)


@pytest.mark.slow
def test_a_coarse_mesh_is_solved_as_accurately_as_the_next_mesh_needs() -> None:
    sheet = paper_tube(3.4)
    accurate, early = (solve_on_mesh(sheet, coarse=coarse) for coarse in (False, True))
    assert accurate.is_minimum and not early.is_minimum
    assert early.factorisations < accurate.factorisations
    assert early.energy == pytest.approx(accurate.energy, rel=1e-9)
    rotation, shift = rigid_fit(early.state.positions, accurate.state.positions)
    np.testing.assert_allclose(early.state.rotated(rotation, shift).positions, accurate.state.positions, atol=1e-3)


def test_an_arm_that_ends_beside_a_held_edge_does_not_pass_it() -> None:
    """At full length the arms of a sheet that has contracted to 0.8 would end 1.5 mm beyond the edge."""
    pins = [{"edges": [1, 3], "scale": 0.8}]
    sheet = paper_tube(2.0, border={"rectangle_mm": [48.0, 40.0]}, stars={"length_mm": 10.0}, pins=pins)
    sheet.set_release(1.0)
    state = fit_to_surface(sheet, 0.8 * np.column_stack([sheet.mesh.points, np.zeros(sheet.n_vertices)]))
    inside = np.abs(sheet.mesh.points[:, 0]) < 24.0 - 1e-9
    assert (np.abs(sheet.mesh.points[inside, 0]) > 23.4).any()  # tips
    assert np.abs(state.positions[inside, 0]).max() < 0.8 * 24.0


def test_prolongation_keeps_the_length_of_the_arms_and_the_shape() -> None:
    coarse, fine = paper_tube(3.4), paper_tube(1.7)
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


def turned(state: State, angle: float) -> State:
    c, s = np.cos(angle), np.sin(angle)
    return state.rotated(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, -2.0, 3.0]))


@pytest.mark.slow
def test_one_state_up_to_rigid_motions_but_not_up_to_mirrors() -> None:
    end = solve_on_mesh(paper_tube(3.4), coarse=True)
    assert is_same_state(end, replace(end, state=turned(end.state, 0.7)))
    mirrored = State(end.state.positions * [1.0, 1.0, -1.0], end.state.directors)
    assert not is_same_state(end, replace(end, state=mirrored))
    assert not is_same_state(end, replace(end, energies={"membrane": 1.0001 * end.energy}))
    assert not is_same_state(end, replace(end, bumps=-end.bumps))
    moved = end.state.positions + [0.0, 0.0, 1.0] * (np.arange(len(end.state.positions)) % 2)[:, None]
    assert not is_same_state(end, replace(end, state=State(moved, end.state.directors)))


@pytest.mark.slow
def test_a_second_search_joins_the_first_and_costs_less() -> None:
    shared = search(FINE_MM)
    first, levels = solve_on_meshes(shared)
    assert len(shared.ends) == 2 and shared.joined_at is None and len(levels) == 2

    start = shared.ends[0].state.positions + 0.02 * np.sin(shared.ladder.models[0].mesh.points[:, :1] + [0.0, 1.0, 2.0])
    second, joined = solve_on_meshes(shared, near=lambda points: start)
    assert shared.joined_at == shared.ladder.models[0].n_vertices == joined[0].vertices
    assert second.is_minimum and second.energy == first.energy
    assert [level.vertices for level in joined] == [level.vertices for level in levels]
    assert second.iterations == joined[0].iterations < first.iterations / 2 and joined[1].iterations == 0
    assert sum(step.iterations for step in second.path) == second.iterations
    # it ends where it would have ended alone
    alone, _ = solve_on_meshes(search(FINE_MM), near=lambda points: start)
    assert alone.energy == pytest.approx(second.energy, rel=1e-9)


@pytest.mark.slow
def test_a_second_search_goes_on_alone_where_it_must() -> None:
    shared = search(FINE_MM)
    first, _ = solve_on_meshes(shared)
    shared.ends[-1] = replace(first, smallest_eigenvalue=-1.0)  # the first search has found no minimum
    second, levels = solve_on_meshes(shared)
    assert shared.joined_at is None and second.is_minimum
    assert all(level.iterations > 0 for level in levels)
    np.testing.assert_allclose(second.state.positions, first.state.positions, atol=1e-7)
