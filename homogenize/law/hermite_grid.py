"""Interpolation on a grid: cubic along each axis, with continuous first derivatives.

In every box of the grid a function is the tensor product of cubic Hermite polynomials. The slopes at the nodes come
from the data along grid lines. With the rule "monotone" the function is monotone along
every grid line on which the data are; the rule "smooth" follows a smooth maximum more closely. Mixed derivatives at the
nodes are slopes of slopes. The function and its first derivatives are continuous.

The rules for the slopes at the nodes are local, and exact for straight lines. scipy has interpolators with these slopes
(`PchipInterpolator`, `Akima1DInterpolator`), but their import takes half a second, which every preview would pay. The
tests compare the slopes with scipy's.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from typing import Literal

import numpy as np

from asterism.equilibrium.arrays import Bools, Floats, Ints

SlopeRule = Literal["monotone", "smooth", "spline"]
# mm, or difference of logarithms: a place so near to a node is on it
NODE_TOLERANCE = 1e-9


class HermiteGrid:
    """Q functions of A coordinates, given by their values at the nodes of a grid.

    Parameters
    ----------
    axes : A increasing lists of nodes. Along a list of one node the functions are constant.
    values : (n1, ..., nA, Q).
    rules : (Q,) rule for the slopes of each function.

    >>> grid = HermiteGrid([np.array([0.0, 1.0, 2.0])], np.array([[0.0], [1.0], [4.0]]), ["smooth"])
    >>> grid(np.array([[1.5]]))
    array([[2.25]])
    """

    def __init__(self, axes: Sequence[Floats], values: Floats, rules: Sequence[SlopeRule]) -> None:
        self.axes = [np.asarray(axis, dtype=float) for axis in axes]
        values = np.asarray(values, dtype=float)
        for number, axis in enumerate(self.axes):
            if len(axis) == 1:
                self.axes[number] = axis[0] + np.array([-0.5, 0.5])
                values = np.repeat(values, 2, axis=number)
        self.boxes = [len(axis) - 1 for axis in self.axes]
        self._coefficients = self._hermite(values, rules)

    def _hermite(self, values: Floats, rules: Sequence[SlopeRule]) -> Floats:
        """(boxes, 4^A, Q) values and slopes at the corners of each box, in coordinates that run from 0 to 1 in it."""
        count = len(self.axes)
        derivatives: dict[tuple[int, ...], Floats] = {(0,) * count: values}  # by the order along each axis
        for axis, nodes in enumerate(self.axes):
            for orders, known in list(derivatives.items()):
                along = np.empty_like(known)
                for rule in set(rules):
                    columns = np.array([other == rule for other in rules])
                    along[..., columns] = node_slopes(nodes, known[..., columns], axis, rule)
                derivatives[(*orders[:axis], 1, *orders[axis + 1 :])] = along
        entries = []
        for basis in product(range(4), repeat=count):
            # 0 and 1: value at the lower and the upper corner; 2 and 3: slope there
            orders = tuple(b // 2 for b in basis)
            part = derivatives[orders]
            for axis, (b, order) in enumerate(zip(basis, orders, strict=True)):
                part = np.take(part, np.arange(self.boxes[axis]) + b % 2, axis=axis)
                if order:
                    size = np.diff(self.axes[axis])
                    part = part * size.reshape([-1 if a == axis else 1 for a in range(count + 1)])
            entries.append(part)
        stacked = np.stack(entries, axis=-2)
        return np.ascontiguousarray(stacked.reshape(math.prod(self.boxes), 4**count, stacked.shape[-1]))

    def box(self, points: Floats) -> tuple[Ints, Floats]:
        """Number of the box that each point (N, A) lies in, (N,), and place in the box (N, A) from 0 to 1."""
        place = np.empty_like(points)
        number = np.zeros(len(points), dtype=np.int64)
        for axis, nodes in enumerate(self.axes):
            index = np.searchsorted(nodes[1:-1], points[:, axis], side="right")
            place[:, axis] = (points[:, axis] - nodes[index]) / (nodes[index + 1] - nodes[index])
            number = number * self.boxes[axis] + index
        return number, place

    def is_known(self, points: Floats, known: Bools) -> Bools:
        """(N,) whether all nodes are known that the values at points (N, A) depend on: two along each axis, or one."""
        for axis in range(known.ndim):
            known = np.repeat(known, 2, axis=axis) if known.shape[axis] == 1 else known
        number, place = self.box(points)
        lower = np.stack(np.unravel_index(number, self.boxes), axis=-1)
        span = np.array([np.diff(nodes)[index] for nodes, index in zip(self.axes, lower.T, strict=True)]).T
        out = np.ones(len(points), dtype=bool)
        for corner in product((0, 1), repeat=known.ndim):
            side = np.where(place * span < NODE_TOLERANCE, 0, np.where((1 - place) * span < NODE_TOLERANCE, 1, corner))
            out &= known[tuple((lower + side).T)]
        return out

    def __call__(self, points: Floats) -> Floats:
        """Values (N, Q) at points (N, A) within the grid."""
        number, place = self.box(points)
        t, u = place.T, 1 - place.T
        # of the values at 0 and 1, and of the slopes there
        factors = np.stack([(1 + 2 * t) * u * u, (1 + 2 * u) * t * t, t * u * u, -u * t * t], axis=-1)
        weights = factors[-1]
        for factor in factors[-2::-1]:
            weights = (factor[:, :, None] * weights[:, None, :]).reshape(len(points), -1)
        return np.asarray((weights[:, None] @ self._coefficients[number])[:, 0])


def node_slopes(nodes: Floats, values: Floats, axis: int, rule: SlopeRule) -> Floats:
    """Slopes of functions at their nodes along one axis.

    Parameters
    ----------
    nodes : (n,) increasing, at least two.
    values : values of the functions, n along the axis.
    axis : the axis along which the nodes lie.
    rule : "monotone" takes the slopes of Fritsch and Butland (1984) with the ends of Moler (Numerical Computing with
        MATLAB, 2004, section 3.6): the cubics between the nodes are monotone where the values are. "smooth" takes
        those of the modified Akima spline (Akima 1970; Moler and Ionita 2019). "spline" takes those of scipy's cubic
        spline, which are linear in the values.

    >>> node_slopes(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 4.0]), 0, "smooth")
    array([0., 2., 4.])
    """
    values = np.moveaxis(values, axis, 0)
    steps = np.diff(nodes).reshape(-1, *[1] * (values.ndim - 1))
    secants = np.diff(values, axis=0) / steps
    if len(secants) == 1:
        slopes = np.concatenate([secants, secants])
    elif rule == "monotone":
        slopes = _monotone(steps, secants)
    elif rule == "spline":
        from scipy.interpolate import CubicSpline  # slow to import; laws of motifs alone need it

        slopes = np.asarray(CubicSpline(nodes, values)(nodes, 1))
    elif len(secants) == 2:  # the parabola through the three nodes
        slopes = np.asarray(np.gradient(values, nodes, axis=0, edge_order=2))
    else:
        slopes = _smooth(secants)
    return np.moveaxis(slopes, 0, axis)


def _monotone(steps: Floats, secants: Floats) -> Floats:
    """Inside, the weighted harmonic mean of both secants, and 0 where they have no common sign."""
    before, after = 2 * steps[1:] + steps[:-1], steps[1:] + 2 * steps[:-1]
    agree = secants[1:] * secants[:-1] > 0
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        mean = (before + after) / (before / secants[:-1] + after / secants[1:])
    inside = np.where(agree, mean, 0.0)
    first = _at_end(steps[0], steps[1], secants[0], secants[1])
    last = _at_end(steps[-1], steps[-2], secants[-1], secants[-2])
    return np.concatenate([first[None], inside, last[None]])


def _at_end(step: Floats, next_step: Floats, secant: Floats, next_secant: Floats) -> Floats:
    """The parabola through three nodes, bounded so that the first cubic keeps the shape of the values."""
    slope = ((2 * step + next_step) * secant - step * next_secant) / (step + next_step)
    turns = np.sign(secant) != np.sign(next_secant)
    slope = np.where(turns & (np.abs(slope) > 3 * np.abs(secant)), 3 * secant, slope)
    return np.where(np.sign(slope) != np.sign(secant), 0.0, slope)


def _smooth(secants: Floats) -> Floats:
    """Mean of both secants at a node: the side on which the slope changes less weighs more."""
    left, right = 2 * secants[0] - secants[1], 2 * secants[-1] - secants[-2]
    left, right = [2 * left - secants[0], left], [right, 2 * right - secants[-1]]
    m = np.concatenate([left, secants, right])
    change = np.abs(np.diff(m, axis=0)) + np.abs(m[1:] + m[:-1]) / 2
    before, after = change[2:], change[:-2]  # weights of the secants before and after a node
    total = before + after
    # relative weights of both sides below this are rounding errors: the values around the node lie on a line
    known = total > 1e-9 * total.max()
    share = np.where(known, after, 0.0) / np.where(known, total, 1.0)
    return np.where(known, m[1:-2] + share * (m[2:-1] - m[1:-2]), (m[3:] + m[:-3]) / 2)
