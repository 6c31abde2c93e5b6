"""Directions of the guesses of a free sheet: every axis of low energy, and symmetric axes once."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.initial_guesses import SYMMETRY_BREAKING_ANGLE, distinct_shapes, energy_minima
from asterism.fem.search.relax import relax
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.fem.shell.fields import of_stretch
from asterism.fem.shell.shell import Shell
from tests.fem.hexagons import RADIUS, density, hexagon

FAMILY = [SimpleShape("arc", 0.015, np.pi * number / 12) for number in range(12)]
THIRD = 2.0 * np.pi / 3.0
TURN = np.array([[np.cos(THIRD), -np.sin(THIRD)], [np.sin(THIRD), np.cos(THIRD)]])


@pytest.mark.parametrize(("sixfold", "angles"), [(100.0, (30.0, 90.0, 150.0)), (-100.0, (0.0, 60.0, 120.0))])
def test_every_axis_of_the_lattice_is_an_energy_minimum(sixfold: float, angles: tuple[float, ...]) -> None:
    shell = Shell(Argyris(hexagon(1)), of_stretch(density(sixfold), 0.8, 0.015))
    found = [np.degrees(shape.angle) for shape in energy_minima(shell, 0.8, FAMILY)]
    assert sorted(found) == pytest.approx(angles)


def test_an_isotropic_sheet_is_bent_away_from_symmetry_axes() -> None:
    shell = Shell(Argyris(hexagon(1)), of_stretch(density(), 0.8, 0.015))
    (only,) = energy_minima(shell, 0.8, FAMILY)
    assert only.angle == SYMMETRY_BREAKING_ANGLE


def test_equal_axes_count_once() -> None:
    first, *others = (SimpleShape("arc", 0.015, np.radians(angle)) for angle in (30.0, 90.0, 150.0))
    assert distinct_shapes(first, others, []) == others
    assert distinct_shapes(first, others, [TURN, TURN.T]) == []
    # the mirror y -> -y maps 30 to 150 degrees, and 90 to itself
    assert distinct_shapes(first, others, [np.diag([1.0, -1.0])]) == [others[0]]


def test_other_axes_are_other_forms() -> None:
    """A sheet that prefers lattice lines may roll about three axes; the lowest minimum is taken."""
    fields = of_stretch(density(100.0), 0.8, lambda p: 0.015 + 0.004 * (p @ np.array([0.8, 0.6])) / RADIUS)
    shell = Shell(Argyris(hexagon(1)), fields)
    lowest = relax(shell)
    energies = [trial.energy for trial in lowest.trials if trial.is_minimum]
    assert len(energies) == 3
    assert np.ptp(energies) > 1e-3 * lowest.energy
    for trial in lowest.trials:
        assert shell.energy(trial.x) == pytest.approx(trial.energy)
    assert lowest.energy == min(trial.energy for trial in lowest.trials)
    assert lowest.is_minimum and len(lowest.soft_modes) == 3
