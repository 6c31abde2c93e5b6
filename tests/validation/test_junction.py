"""V12: junctions of rods. N rods that meet are N - 1 copies each, bonded pair by pair."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.discrete.energies.rods.network import RodNetwork, rod_network
from asterism.discrete.model.state import State, moved_state
from asterism.discrete.model.system import System
from asterism.equilibrium.arrays import Array
from tests.validation.rods import Material, crumpled, flat, lowest, rod_system, solve

ARM = Material(width=1.2, thickness=0.3)
LENGTH, EDGES = 10.0, 6


def star(directions: Array, kappa: float = 0.0) -> tuple[System, Array, RodNetwork]:
    """Arms of one length from the origin, in the given directions (rad), joined; nothing is held."""
    along = LENGTH * np.arange(1, EDGES + 1) / EDGES
    arms = [np.outer(along, [np.cos(a), np.sin(a)]) for a in directions]
    printed = np.vstack([np.zeros((1, 2)), *arms])
    paths = tuple(np.concatenate([[0], 1 + EDGES * i + np.arange(EDGES)]) for i in range(len(directions)))
    network = rod_network(paths, np.zeros(len(directions), dtype=int), printed)
    held = np.zeros(3 * len(printed) + len(network.edges), dtype=bool)
    return rod_system(network, printed, ARM, held, kappa=kappa), printed, network


def regular(n: int) -> Array:
    return -0.5 * np.pi + 2.0 * np.pi * np.arange(n) / n


@pytest.mark.parametrize("n", range(2, 9))
def test_flat_star_is_at_rest(n):
    """Any number of arms, at uneven angles too: as printed there is no energy and no force."""
    for directions in (regular(n), regular(n) + np.random.default_rng(n).uniform(-0.25, 0.25, n)):
        system, printed, _ = star(directions)
        state = flat(system, printed)
        assert system.energy(state) < 1e-20
        assert np.abs(system.gradient(state)).max() < 1e-9


@pytest.mark.parametrize("n", range(2, 9))
def test_copies_add_up_to_the_arm(n):
    """Every arm gives the shares 1/(N - 1) to N - 1 partners; along the arm its cross-section is whole."""
    _, _, network = star(regular(n))
    junction = network.stencil_vertices[:, 1] == 0
    assert junction.sum() == n * (n - 1) // 2
    share = np.zeros(len(network.edges))
    np.add.at(share, network.stencil_edges[junction], network.weight[junction, None])
    np.testing.assert_allclose(share[network.edges[:, 0] == 0], 1.0)
    np.testing.assert_array_equal(network.weight[~junction], 1.0)


@pytest.mark.parametrize("n", range(2, 9))
def test_loaded_star_keeps_its_symmetry(n):
    """Tips on a table, rest curvature, a load on the centre: turned by an arm, or mirrored, the shape is the same."""
    system, printed, _ = star(regular(n), kappa=0.05)
    held = system.held.copy()
    held[2 + 3 * EDGES : 3 * len(printed) : 3 * EDGES] = True  # z of the tips
    held[[0, 1, 3]] = True  # drift and spin in the plane, which nothing drives
    if n == 2:
        held[3 * len(printed)] = True  # a straight rod can also turn about itself
    system = System(system.parts, len(printed), system.edges, held)
    load = np.zeros((len(printed), 3))
    load[0, 2] = 0.5 * n * ARM.about_width / LENGTH**2
    start = flat(system, printed)
    noise = np.where(held[: 3 * len(printed)], 0.0, 1e-3 * np.random.default_rng(5).normal(size=start.positions.size))
    start = moved_state(start, system.edges, start.positions + noise.reshape(-1, 3), np.zeros(len(system.edges)))
    state = solve(system, start, [load]).state
    assert lowest(system, state) > 0.0
    assert state.positions[0, 2] > 0.1 * LENGTH
    angle = 2.0 * np.pi / n
    turn = np.array([[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
    for values in (state.positions[1:], state.directors):
        arms = values.reshape(n, EDGES, 3)
        size = np.abs(arms).max()
        np.testing.assert_allclose(np.roll(arms @ turn.T, 1, axis=0), arms, atol=1e-8 * size)
        mirrored = (arms * [-1.0, 1.0, 1.0])[-np.arange(n) % n]
        np.testing.assert_allclose(mirrored, arms, atol=1e-8 * size)


def test_two_joined_halves_are_one_rod():
    """A straight rod cut in two that run away from the cut: the same energies and forces at any state."""
    n = 12
    printed = np.column_stack([np.linspace(0.0, LENGTH, n + 1), np.zeros(n + 1)])
    whole = rod_network((np.arange(n + 1),), np.array([-1]), printed)
    halves = rod_network((np.arange(5, -1, -1), np.arange(5, n + 1)), np.array([0, 0]), printed)
    held = np.zeros(3 * (n + 1) + n, dtype=bool)
    one, other = (rod_system(network, printed, ARM, held, kappa=0.05) for network in (whole, halves))
    state = crumpled(one, flat(one, printed))
    # edge k of the halves is this edge of the whole, and its turns count the other way on the first half
    edge = np.concatenate([np.arange(4, -1, -1), np.arange(5, n)])
    sign = np.where(np.arange(n) < 5, -1.0, 1.0)
    same = State(state.positions, state.directors[edge])
    expected, found = one.energies(state), other.energies(same)
    for name, value in expected.items():
        assert value > 0.0
        assert found[name] == pytest.approx(value, rel=1e-12), name
    gradient, image = one.full_gradient(state), other.full_gradient(same)
    scale = np.abs(gradient).max()
    np.testing.assert_allclose(image[: 3 * n + 3], gradient[: 3 * n + 3], atol=1e-12 * scale)
    np.testing.assert_allclose(image[3 * n + 3 :], sign * gradient[3 * n + 3 :][edge], atol=1e-12 * scale)
