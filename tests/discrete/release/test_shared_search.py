"""A second search ends where it reaches the state of the first one, and only there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.discrete.model.state import State
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.levels import is_same_state, solve_on_meshes
from tests.discrete.release.test_levels import model, search


def turned(state: State, angle: float) -> State:
    c, s = np.cos(angle), np.sin(angle)
    return state.rotated(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, -2.0, 3.0]))


@pytest.mark.slow
def test_one_state_up_to_rigid_motions_but_not_up_to_mirrors() -> None:
    end = solve_on_mesh(model(3.4), coarse=True)
    assert is_same_state(end, replace(end, state=turned(end.state, 0.7)))
    mirrored = State(end.state.positions * [1.0, 1.0, -1.0], end.state.directors)
    assert not is_same_state(end, replace(end, state=mirrored))
    assert not is_same_state(end, replace(end, energies={"membrane": 1.0001 * end.energy}))
    assert not is_same_state(end, replace(end, bumps=-end.bumps))
    moved = end.state.positions + [0.0, 0.0, 1.0] * (np.arange(len(end.state.positions)) % 2)[:, None]
    assert not is_same_state(end, replace(end, state=State(moved, end.state.directors)))


@pytest.mark.slow
def test_a_second_search_joins_the_first_and_costs_less() -> None:
    shared = search(1.0)
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
    alone, _ = solve_on_meshes(search(1.0), near=lambda points: start)
    assert alone.energy == pytest.approx(second.energy, rel=1e-9)


@pytest.mark.slow
def test_a_second_search_goes_on_alone_where_it_must() -> None:
    shared = search(1.0)
    first, _ = solve_on_meshes(shared)
    shared.ends[-1] = replace(first, smallest_eigenvalue=-1.0)  # the first search has found no minimum
    second, levels = solve_on_meshes(shared)
    assert shared.joined_at is None and second.is_minimum
    assert all(level.iterations > 0 for level in levels)
