"""Resultants of loads, and derivatives of the potential of an end moment."""

import numpy as np
import pytest

from asterism.fem.elements.deformation import affine
from asterism.fem.supports.end_moment import EndMoment
from asterism.fem.supports.loads import area_load, edge_load, point_load
from tests.fem.meshes import facets_where, rectangle, turned
from tests.fem.spaces import SPACES

spaces = pytest.mark.parametrize("space_of", SPACES.values(), ids=SPACES.keys())


def _place(space, matrix, offset=(0.0, 0.0, 0.0)):
    return space.interpolate(affine(matrix, offset).jets)


def _work(space, loads, matrix, offset=(0.0, 0.0, 0.0)) -> float:
    return float(np.sum(loads * _place(space, matrix, offset)))


@spaces
def test_resultants_and_moments(space_of) -> None:
    """The work of a load on every affine motion: its resultant and its moments."""
    space = space_of(rectangle(3, 2, 3.0, 2.0, amount=0.2))
    nothing = np.zeros((3, 2))
    tilt = np.array([[0.0, 0], [0, 0], [0.7, -0.2]])
    weight = area_load(space, (0.0, 0.0, -0.5))
    assert _work(space, weight, nothing, (1.0, 2.0, 3.0)) == pytest.approx(-0.5 * 6 * 3)
    assert _work(space, weight, tilt) == pytest.approx(-0.5 * 6 * (0.7 * 1.5 - 0.2 * 1.0))
    linear = area_load(space, lambda p: np.column_stack([p[:, 0], 0 * p[:, 0], 0 * p[:, 0]]))
    assert _work(space, linear, np.array([[1.0, 0], [0, 0], [0, 0]])) == pytest.approx(9.0 * 2)
    end = facets_where(space.mesh, lambda x, y: x > 3 - 1e-9)
    pull = edge_load(space, end, (2.0, 0.0, 0.0))
    assert _work(space, pull, np.array([[1.0, 10.0], [0, 0], [0, 0]])) == pytest.approx(2.0 * (3 * 2 + 10 * 2))
    point = point_load(space, [1.3, 0.4], [0.0, 0.0, 5.0])
    assert _work(space, point, tilt, (0, 0, 1.0)) == pytest.approx(5.0 * (1 + 0.7 * 1.3 - 0.2 * 0.4))


@spaces
def test_end_moment_works_with_the_angle(space_of) -> None:
    """Rotations about the axis, also beyond pi: the energy is -m length angle."""
    space = space_of(turned(rectangle(2, 2), 30.0, (4.0, 1.0)))
    side = np.array([-np.sin(np.radians(30.0)), np.cos(np.radians(30.0)), 0.0])
    edge = facets_where(
        space.mesh, lambda x, y: x * np.cos(np.pi / 6) + y * 0.5 > 4 * np.cos(np.pi / 6) + 0.5 + 1 - 1e-6
    )
    for angle in (-1.0, 0.3, 2.0, 5.0):
        moment = EndMoment(space, edge, 0.25, side, near=angle + 0.4)
        # Rodrigues
        k = np.cross(side, np.eye(3)).T
        turn = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
        assert moment.energy(_place(space, turn[:, :2])) == pytest.approx(-0.25 * 1.0 * angle)


@spaces
def test_end_moment_derivatives(space_of) -> None:
    space = space_of(rectangle(2, 1))
    moment = EndMoment(space, facets_where(space.mesh, lambda x, y: x > 1 - 1e-9), 0.7, (0.2, 1.0, 0.3))
    rng = np.random.default_rng(0)
    x = _place(space, rng.normal(size=(3, 2))) + 0.05 * rng.normal(size=(space.size, 3))
    move = rng.normal(size=x.shape)
    step = 1e-6
    slope = (moment.energy(x + step * move) - moment.energy(x - step * move)) / (2 * step)
    assert np.sum(moment.gradient(x) * move) == pytest.approx(slope, rel=1e-6)
    change = (moment.gradient(x + step * move) - moment.gradient(x - step * move)) / (2 * step)
    hessian = moment.hessian(x)
    assert np.linalg.norm(hessian @ move.ravel() - change.ravel()) < 1e-6 * np.linalg.norm(change)
    assert abs(hessian - hessian.T).max() < 1e-12 * abs(hessian).max()
    for axis in np.eye(3):  # no resultant force
        assert abs(_work(space, moment.gradient(x), np.zeros((3, 2)), axis)) < 1e-9


def test_axis_along_the_fibres_is_refused() -> None:
    space = SPACES["lifted"](rectangle(2, 1))
    with pytest.raises(ValueError, match="the axis is parallel to the fibres"):
        EndMoment(space, facets_where(space.mesh, lambda x, y: x > 1 - 1e-9), 1.0, (1.0, 0.0, 0.0))
