"""The linear response to the stiffnesses of a shell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.linear_response import STIFFNESSES, part_stresses, rms_of, stiffness_responses
from asterism.fem.search.relax import follow, relax
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import Fields, of_stretch
from asterism.fem.shell.shell import Shell
from tests.fem.hexagons import hexagon, radius

ERROR = 1e-3


def fields(**factors: float) -> Fields:
    """A free bowl with all four parts, each with a factor."""
    of = dict.fromkeys(STIFFNESSES, 1.0) | factors
    stiffness = isotropic(20.0 * of["membrane"], 100.0 * of["bending"], 0.3)
    density = Density(stiffness, sixfold=2000.0 * of["sixfold"], saturation=0.05)
    bowl = of_stretch(density, lambda p: 0.85 - 0.1 * radius(p) ** 2, 0.004)
    return replace(bowl, gaussian=-20.0 * of["gaussian"])


def soft_term(e: Floats) -> tuple[Floats, Floats, Floats]:
    """A quartic energy of the membrane strains."""
    square = (e[:, :3] ** 2).sum(axis=1)
    slope, bend = np.zeros_like(e), np.zeros((len(e), 6, 6))
    slope[:, :3] = 4.0 * square[:, None] * e[:, :3]
    return square**2, slope, bend


def test_the_parts_are_the_whole_stress() -> None:
    plain = fields()
    density = replace(plain.density, term=soft_term, prestress=np.array([0.1, 0.2, 0.0, 0.3, 0.1, 0.2]))
    shell = Shell(Argyris(hexagon(1)), replace(plain, density=density))
    x = relax(Shell(Argyris(hexagon(1)), plain), shell.factor()).x
    parts = part_stresses(shell, x)
    np.testing.assert_allclose(sum(parts), shell.density(shell.strains(x))[1], atol=1e-12)
    assert all(np.abs(part).max() > 1e-6 for part in parts)


def test_the_response_is_that_of_a_shell_with_another_stiffness() -> None:
    shell = Shell(Argyris(hexagon(1)), fields())
    factor = shell.factor()
    start = relax(shell, factor)
    moves = stiffness_responses(shell, start.x, factor)
    distances = rms_of(shell, start.x, moves)
    largest = np.abs(moves).max()
    assert np.abs(moves.sum(axis=1)).max() < 1e-6 * largest  # a common error moves nothing
    for k, part in enumerate(STIFFNESSES):
        found = follow(shell.with_fields(fields(**{part: 1.0 + ERROR})), start.x, shell.factor())
        apart = shell.restrict(found.x - start.x) / ERROR
        (turned,) = rms_of(shell, start.x, apart[:, None])
        (left,) = rms_of(shell, start.x, (apart - moves[:, k])[:, None])
        assert found.is_minimum and turned == pytest.approx(distances[k], rel=0.02)
        assert left < 0.05 * distances[k], part
        assert 0.0 < distances[k] < largest
