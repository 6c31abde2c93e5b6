"""Compliance of a point, compared with the equilibrium under a small force there."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.linear_response import compliance
from asterism.fem.search.relax import follow, relax
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import PointSupport
from asterism.fem.supports.loads import point_load
from tests.fem.hexagons import FIELDS, RADIUS, hexagon

UP = np.array([0.0, 0.0, 1.0])


def test_compliance_is_the_displacement_per_small_force() -> None:
    mesh = hexagon(1)
    corners = np.arange(1, 7)
    held = [PointSupport(corners, np.column_stack([0.8 * mesh.p.T[corners], np.zeros(6)]))]
    shell = Shell(Argyris(mesh), FIELDS["dome"], held)
    factor = shell.factor()
    start = relax(shell, factor)
    load = point_load(shell.space, np.zeros(2), UP)
    found = compliance(shell, start.x, factor, load)
    moved = []
    for force in (0.02, -0.02):
        pushed = Shell(shell.space, FIELDS["dome"], held, force * load)
        state = follow(pushed, start.x, pushed.factor())
        assert state.is_minimum
        moved.append(float((load * (state.x - start.x)).sum()) / force)
    assert abs(moved[0] - moved[1]) > 1e-4 * found  # the loads are felt
    assert np.mean(moved) == pytest.approx(found, rel=1e-4)


def test_rigid_parts_of_the_load_do_not_count() -> None:
    shell = Shell(Argyris(hexagon(1)), FIELDS["rolled"])
    factor = shell.factor()
    start = relax(shell, factor)
    one, other = (point_load(shell.space, np.array([x, 0.0]), UP) for x in (0.5 * RADIUS, -0.5 * RADIUS))
    apart = compliance(shell, start.x, factor, one - other)
    assert apart > 0.0
    for motion in shell.rigid_modes(start.x).T:
        carried = shell.move(np.zeros_like(start.x), 5.0 * motion)
        assert compliance(shell, start.x, factor, one - other + carried) == pytest.approx(apart, rel=1e-6)
        assert compliance(shell, start.x, factor, carried) < 1e-6 * apart
