"""Rigid-body settling of sheets that are fixed at a point or a line."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from asterism.fem.elements.argyris import Argyris, area_load
from asterism.fem.search.initial_guesses import settle_rigid_body
from asterism.fem.search.relax import relax
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import Condition, EdgeSupport, PointSupport, vertices_at
from tests.fem.hexagons import FIELDS
from tests.fem.loads import point_load
from tests.fem.maps import arc
from tests.fem.meshes import facets_where, rectangle

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
