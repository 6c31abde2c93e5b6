"""Rigid motions are left out of the certificate if, and only if, they cost no energy.

Rigid-body settling of sheets that are fixed at a point or a line.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.newton.certificate import smallest_eigenvalue
from asterism.equilibrium.newton.minimise import is_definite_on_support
from asterism.fem.elements.argyris import Argyris, area_load
from asterism.fem.search.initial_guesses import settle_rigid_body
from asterism.fem.search.mixed_newton import mixed_newton
from asterism.fem.search.relax import follow, relax
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import Condition, EdgeSupport, PointSupport, vertices_at
from asterism.fem.supports.rigid import span_a_plane
from tests.fem.hexagons import FIELDS
from tests.fem.loads import point_load
from tests.fem.maps import arc
from tests.fem.meshes import facets_where, rectangle

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


def test_a_standing_strip_is_a_saddle() -> None:
    """Both swings have a negative stiffness, which comes from gravity alone."""
    shell = pendulum()
    factor, tolerance = shell.factor(), 1e-11 * shell.force_scale
    standing = mixed_newton(shell, upright(shell, -1.0), factor, tolerance)
    assert standing.converged and shell.rigid_modes(standing.state).shape[1] == 1
    data = shell.hessian(standing.state)
    assert not is_definite_on_support(shell, standing.state, data, factor)
    assert smallest_eigenvalue(shell.pattern, data, factor, shell.rigid_modes(standing.state)).value < 0.0


@pytest.mark.parametrize(
    ("places", "left"),
    [
        ([], 6),
        ([[0.0, 0.0]], 3),
        ([[0.0, 0.0], [10.0, 0.0]], 1),
        ([[0.0, 0.0], [5.0, 0.0], [10.0, 0.0]], 1),  # points on one line leave the rotation about it free
        ([[0.0, 0.0], [5.0, 2.0], [10.0, 0.0]], 0),
        ([[0.0, 0.0], [10.0, 0.0], [0.0, 2.0]], 0),
    ],
)
def test_pins_stop_motions_one_by_one(places: list[list[float]], left: int) -> None:
    space, at = Argyris(rectangle(4, 2, 10.0, 2.0)), np.array(places)
    held = [PointSupport(vertices_at(space.mesh, at), np.pad(at, ((0, 0), (0, 1))))] if places else []
    shell = Shell(space, Fields(Density(isotropic(100.0, 50.0, 0.3))), held)
    modes = shell.rigid_modes(shell.flat)
    assert modes.shape == (shell.pattern.size, left)
    assert len(shell.support(shell.flat)) == left
    assert np.allclose(modes.T @ modes, np.eye(left))
    if len(places) == 3:
        assert span_a_plane(shell.flat[shell.fixed_points]) == (left == 0)


SIZE = 60.0
DOWN = (0.0, 0.0, -1e-6)  # N/mm^2
CORNER, SIDE = np.zeros((1, 2)), np.array([[0.0, 0.0], [0.0, 0.5 * SIZE], [0.0, SIZE]])


def hanging(points: np.ndarray, loads: object = None, more: tuple[Condition, ...] = ()) -> Shell:
    space = Argyris(rectangle(4, 4, SIZE, SIZE))
    places = np.array([1.0, 2.0, 3.0]) + np.column_stack([points, np.zeros(len(points))])
    held = (PointSupport(vertices_at(space.mesh, points), places), *more) if len(points) else more
    return Shell(space, FIELDS["bowl"], held, area_load(space, DOWN) if loads is None else loads(space))  # type: ignore[operator]


def work(shell: Shell, x: np.ndarray) -> float:
    return float((shell.loads * x).sum())


@pytest.mark.parametrize("points", [CORNER, SIDE], ids=["point", "line"])
@pytest.mark.parametrize("several", [0.0, 1.0, -1.0], ids=["weight", "loads", "opposite loads"])
def test_settling_maximises_the_work_of_the_loads(points: np.ndarray, several: float) -> None:
    """Fixed points and lengths are kept, and no other admissible rotation gives the loads more work."""
    across = several * np.array([[1.0, 0.2, -0.5], [0.3, -1.0, 0.4], [0.0, 0.2, 0.1]])
    loads = (lambda space: point_load(space, [[40.0, 10.0], [20.0, 50.0], [59.0, 59.0]], across)) if several else None
    shell = hanging(points, loads)
    start = shell.constrain(shell.space.interpolate(arc(1.0 / (2.2 * SIZE)).jets))
    x = settle_rigid_body(shell, start)
    held = shell.fixed_points
    assert x[held] == pytest.approx(start[held], abs=1e-9)
    assert shell.constrain(x) == pytest.approx(x, abs=1e-9)
    assert shell.energies(x)["sheet"] == pytest.approx(shell.energies(start)["sheet"], rel=1e-9)
    random, pivot = np.random.default_rng(0), x[held].mean(axis=0)
    for size in np.repeat([1.0, 1e-3], 50):
        turn = random.normal(size=3) if len(points) == 1 else random.normal() * np.array([0.0, 1.0, 0.0])
        turn *= size
        other = shell.translated(shell.translated(x, -pivot) @ Rotation.from_rotvec(turn).as_matrix().T, pivot)
        assert work(shell, other) <= work(shell, x) * (1 + 1e-12) + 1e-15


def test_a_sheet_that_cannot_rotate_is_unchanged() -> None:
    edge = EdgeSupport(facets_where(rectangle(4, 4, SIZE, SIZE), lambda x, y: x < 1e-9), clamped=True)
    slid = PointSupport(np.array([24]), np.array([[SIZE, SIZE, 3.0]]), np.eye(3)[2:], "slides")
    corners = np.array([[0.0, 0.0], [SIZE, 0.0], [0.0, SIZE]])
    for shell in (
        hanging(corners),
        hanging(np.empty((0, 2)), more=(edge,)),
        hanging(CORNER, more=(slid,)),
        hanging(CORNER, lambda space: np.zeros((space.size, 3))),
    ):
        x = shell.constrain(shell.flat)
        assert settle_rigid_body(shell, x) is x


@pytest.mark.parametrize("points", [CORNER, SIDE], ids=["point", "line"])
def test_light_sheets_settle(points: np.ndarray) -> None:
    found = relax(hanging(points))
    assert found.is_minimum and found.iterations < 60
