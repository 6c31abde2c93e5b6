"""Rigid motions are left out of the certificate if, and only if, they cost no energy."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.newton.minimise import find_minimum
from asterism.fem.elements.argyris import Argyris, area_load
from asterism.fem.search.mixed_newton import mixed_newton
from asterism.fem.search.relax import follow
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import PointSupport, vertices_at
from asterism.fem.supports.rigid import span_a_plane
from tests.fem.meshes import rectangle

WEIGHT = 1e-4  # N/mm^2


def pendulum() -> Shell:
    """A stiff strip, pinned at the middle of its end, in gravity along -z."""
    space = Argyris(rectangle(4, 2, 10.0, 2.0))
    pin = PointSupport(vertices_at(space.mesh, np.array([[0.0, 1.0]])), np.zeros((1, 3)))
    loads = area_load(space, (0.0, 0.0, -WEIGHT))
    return Shell(space, Fields(Density(isotropic(100.0, 50.0, 0.3))), [pin], loads)


def upright(shell: Shell, sign: float) -> Floats:
    """The strip in the vertical plane, above its pin or below it."""
    turn = np.array([[0.0, 0.0, sign], [0.0, 1.0, 0.0], [-sign, 0.0, 0.0]])
    return shell.constrain(shell.translated(shell.flat, np.array([0.0, -1.0, 0.0])) @ turn.T)


def test_a_hanging_strip_is_free_to_rotate_about_the_vertical_only() -> None:
    shell = pendulum()
    found = follow(shell, upright(shell, 1.0), shell.factor())
    assert found.is_minimum and found.saddles_left == 0
    assert shell.rigid_modes(found.x).shape[1] == 1
    tip = shell.space.locate(np.array([[10.0, 1.0]])).value @ found.x
    assert np.allclose(tip, [[0.0, 0.0, -10.0]], atol=1e-2)


def test_a_standing_strip_is_a_saddle(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both swings have a negative stiffness, which comes from gravity alone."""
    shell = pendulum()
    factor, tolerance = shell.factor(), 1e-11 * shell.force_scale
    start = upright(shell, -1.0)
    monkeypatch.setattr("asterism.equilibrium.newton.minimise.MAX_SADDLES", 0)
    standing = find_minimum(shell, start, factor, tolerance, lambda x: mixed_newton(shell, x, factor, tolerance), 0.1)
    assert standing.converged and not standing.definite and not standing.is_minimum
    assert standing.lowest is not None and standing.lowest.value < 0.0


@pytest.mark.parametrize("pins, left", [(0, 6), (1, 3), (2, 1), (3, 0)])
def test_pins_stop_motions_one_by_one(pins: int, left: int) -> None:
    space = Argyris(rectangle(4, 2, 10.0, 2.0))
    corners = np.array([[0.0, 0.0], [10.0, 0.0], [0.0, 2.0]])[:pins]
    held = [PointSupport(vertices_at(space.mesh, corners), np.column_stack([corners, np.zeros(pins)]))] if pins else []
    shell = Shell(space, Fields(Density(isotropic(100.0, 50.0, 0.3))), held)
    modes = shell.rigid_modes(shell.flat)
    assert modes.shape[1] == left
    assert len(shell.support(shell.flat)) == left
    assert np.allclose(modes.T @ modes, np.eye(left))


def test_points_not_on_a_line_stop_every_motion() -> None:
    """Points on one line leave the rotation about it free."""
    mesh = rectangle(4, 2, 10.0, 2.0)
    for places, free in (([[0.0, 0.0], [5.0, 0.0], [10.0, 0.0]], 1), ([[0.0, 0.0], [5.0, 2.0], [10.0, 0.0]], 0)):
        at = np.array(places)
        pins = PointSupport(vertices_at(mesh, at), np.column_stack([at, np.zeros(3)]))
        shell = Shell(Argyris(mesh), Fields(Density(isotropic(100.0, 50.0, 0.3))), [pins])
        assert span_a_plane(shell.flat[shell.fixed_points]) == (free == 0)
        assert shell.rigid_modes(shell.flat).shape == (shell.pattern.size, free)
