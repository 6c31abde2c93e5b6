"""Edits: the linear response, then the equilibrium from the state before."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.linear_response import linear_response
from asterism.fem.search.mixed_newton import MAX_STEP
from asterism.fem.search.relax import follow, relax
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields, of_stretch
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import PointSupport
from tests.distances import rms_distance
from tests.fem.hexagons import density, hexagon, radius
from tests.fem.loads import point_load


def dome(amount: float) -> Fields:
    """Fields of a bowl that deepens with the amount."""
    return of_stretch(density(100.0), lambda p: 0.85 - (0.1 + amount) * radius(p) ** 2, 0.004 + 0.1 * amount)


def distance(shell: Shell, x: Floats, y: Floats) -> float:
    """Rms distance in mm at the vertices after a rigid fit."""
    at = shell.space.locate(shell.space.mesh.p.T).value
    return rms_distance(at @ x, at @ y)


def test_the_response_is_the_derivative() -> None:
    """The error of the linear response is of second order in the edit; a free sheet's has no rigid motion."""
    shell = Shell(Argyris(hexagon(1)), dome(0.0))
    factor = shell.factor()
    start = relax(shell, factor)
    errors, moves = [], []
    for amount in (0.01, 0.005):
        follow(shell, start.x, factor)  # the factor belongs to the start again
        edited = shell.with_fields(dome(amount))
        guess = linear_response(edited, start.x, factor)
        moved = edited.restrict(guess.x - start.x)
        assert np.linalg.norm(edited.rigid_modes(start.x).T @ moved) < 1e-9 * np.linalg.norm(moved)
        found = follow(edited, guess.x, factor, strains=guess.strains)
        assert found.is_minimum and found.factorisations <= 3  # that of the certificate among them
        errors.append(distance(shell, guess.x, found.x))
        moves.append(distance(shell, start.x, found.x))
    assert moves[0] > 0.5
    assert errors[0] < 0.05 * moves[0]
    assert 3.3 < errors[0] / errors[1] < 4.7


def test_with_fields_shares_the_pattern_and_leaves_the_first_shell_unchanged() -> None:
    """It equals a newly built shell bit for bit, also its loads and its cached properties."""
    loads = point_load(Argyris(hexagon(1)), np.zeros(2), np.array([0.0, 0.0, 1e-3]))
    shell = Shell(Argyris(hexagon(1)), dome(0.0))
    x = shell.flat + 0.1 * np.random.default_rng(0).normal(size=shell.flat.shape)
    before, stiffness, forces = shell.energies(x), shell.flat_stiffness.copy(), shell.flat_forces(x)
    edited, fresh = shell.with_fields(dome(0.01), loads), Shell(shell.space, dome(0.01), loads=loads)
    assert edited.pattern is shell.pattern
    assert edited.energies(x) == fresh.energies(x) != before
    for array in ("gradient", "hessian", "flat_forces"):
        assert np.array_equal(getattr(edited, array)(x), getattr(fresh, array)(x))
    assert np.array_equal(edited.flat_stiffness, fresh.flat_stiffness)
    assert shell.energies(x) == before and np.array_equal(shell.flat_stiffness, stiffness)
    stiffer = shell.with_fields(of_stretch(Density(2.0 * density().stiffness), 0.8))
    assert np.allclose(stiffer.flat_forces(x), 2.0 * forces) and np.array_equal(shell.flat_forces(x), forces)
    assert not shell.loads.any()
    with pytest.raises(ValueError, match="loads"):
        shell.with_fields(dome(0.0), loads[:-1])


def test_loads_and_large_edits() -> None:
    """A load moves its point as its equilibrium does; the response to a very large load is limited to a Newton step."""
    mesh = hexagon(1)
    corners = np.arange(1, 7)
    held = [PointSupport(corners, np.column_stack([0.8 * mesh.p.T[corners], np.zeros(6)]))]
    shell = Shell(Argyris(mesh), dome(0.0), held)
    factor = shell.factor()
    start = relax(shell, factor)
    load = point_load(shell.space, np.zeros(2), np.array([0.0, 0.0, 1.0]))
    small, large = (
        linear_response(Shell(shell.space, dome(0.0), held, force * load), start.x, factor).x - start.x
        for force in (1e-6, 1e9)
    )
    loaded = follow(Shell(shell.space, dome(0.0), held, 1e-6 * load), start.x, shell.factor())
    assert float((load * small).sum()) == pytest.approx(float((load * (loaded.x - start.x)).sum()), rel=1e-2)
    assert np.abs(large).max() == pytest.approx(MAX_STEP * shell.extent)
    assert large / np.abs(large).max() == pytest.approx(small / np.abs(small).max(), abs=1e-3)
