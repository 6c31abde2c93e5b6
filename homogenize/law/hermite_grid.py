"""Smooth functions on a grid of three sizes: cubic in each direction, with exact derivatives.

In every box of the grid a function is the tensor product of cubic Hermite polynomials. Slopes at the nodes come from
the data along grid lines: those of Fritsch and Butland (1984; PCHIP), so that the function is monotone along grid
lines wherever the data are, or of the modified Akima spline, which follows a smooth maximum more closely. Mixed slopes
are slopes of slopes. The function and its first derivatives are continuous.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator, PchipInterpolator

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
SlopeRule = Literal["monotone", "smooth"]


class HermiteGrid:
    """Q functions of three coordinates, given at the nodes of a grid.

    Parameters
    ----------
    axes : three increasing lists of nodes; a list of one node stands for a function that does not vary along it.
    values : (n0, n1, n2, Q).
    rules : (Q) how slopes are found.
    """

    def __init__(self, axes: Sequence[Floats], values: Floats, rules: Sequence[SlopeRule]) -> None:
        self.axes = [np.asarray(axis, dtype=float) for axis in axes]
        values = np.asarray(values, dtype=float)
        for number, axis in enumerate(self.axes):
            if len(axis) == 1:
                self.axes[number] = axis[0] + np.array([-0.5, 0.5])
                values = np.repeat(values, 2, axis=number)
        self.boxes = [len(axis) - 1 for axis in self.axes]
        self._table = self._hermite(values, rules)

    def _hermite(self, values: Floats, rules: Sequence[SlopeRule]) -> Floats:
        """(boxes, 64, Q): values and slopes at the corners of each box, in units of the box."""
        jets: dict[tuple[int, ...], Floats] = {(0, 0, 0): values}
        for axis, nodes in enumerate(self.axes):
            for orders, known in list(jets.items()):
                # slopes of values keep them monotone; slopes of slopes have nothing to keep
                along = np.empty_like(known)
                for rule in set(rules):
                    its = np.array([other == rule for other in rules])
                    along[..., its] = _slopes(nodes, known[..., its], axis, rule)
                raised = (*orders[:axis], 1, *orders[axis + 1 :])
                jets[raised] = along
        entries = []
        for basis in product(range(4), repeat=3):
            # 0, 1: value at the lower and upper corner; 2, 3: slope there
            orders = tuple(b // 2 for b in basis)
            part = jets[orders]
            for axis, (b, order) in enumerate(zip(basis, orders, strict=True)):
                part = np.take(part, np.arange(self.boxes[axis]) + b % 2, axis=axis)
                if order:
                    size = np.diff(self.axes[axis])
                    part = part * size.reshape([-1 if a == axis else 1 for a in range(4)])
            entries.append(part)
        table = np.stack(entries, axis=-2)
        return np.ascontiguousarray(table.reshape(-1, 64, table.shape[-1]))

    def box(self, points: Floats) -> tuple[NDArray[np.int64], Floats]:
        """Number of the box that each point (N, 3) lies in, (N,), and place in it (N, 3) from 0 to 1."""
        place = np.empty_like(points)
        number = np.zeros(len(points), dtype=np.int64)
        for axis, nodes in enumerate(self.axes):
            index = np.searchsorted(nodes[1:-1], points[:, axis], side="right")
            place[:, axis] = (points[:, axis] - nodes[index]) / (nodes[index + 1] - nodes[index])
            number = number * self.boxes[axis] + index
        return number, place

    def __call__(self, points: Floats) -> tuple[Floats, Floats]:
        """Values (N, Q) and first derivatives (N, 3, Q) at points (N, 3) within the grid."""
        number, place = self.box(points)
        basis, slope = _cubics(place)
        size = [np.diff(nodes) for nodes in self.axes]
        index = np.unravel_index(number, self.boxes)
        weights = np.empty((len(points), 4, 4, 4, 4))
        for row in range(4):
            one, two, three = (
                slope[:, axis] / size[axis][index[axis]][:, None] if row == axis + 1 else basis[:, axis]
                for axis in range(3)
            )
            weights[:, row] = one[:, :, None, None] * (two[:, :, None] * three[:, None, :])[:, None]
        both = weights.reshape(-1, 4, 64) @ self._table[number]
        return both[:, 0], both[:, 1:]


def _cubics(t: Floats) -> tuple[Floats, Floats]:
    """(N, 3, 4) Hermite cubics at t (N, 3): values at 0 and 1, slopes at 0 and 1; and their derivatives."""
    u = 1 - t
    values = np.stack([(1 + 2 * t) * u * u, (1 + 2 * u) * t * t, t * u * u, -u * t * t], axis=-1)
    slopes = np.stack([-6 * t * u, 6 * t * u, u * (1 - 3 * t), t * (3 * t - 2)], axis=-1)
    return values, slopes


def _slopes(nodes: Floats, values: Floats, axis: int, rule: SlopeRule) -> Floats:
    if len(nodes) == 2:
        step = np.diff(values, axis=axis) / (nodes[1] - nodes[0])
        return np.concatenate([step, step], axis=axis)
    if rule == "smooth" and len(nodes) == 3:  # the parabola's
        return np.gradient(values, nodes, axis=axis, edge_order=2)
    if rule == "smooth":
        return np.asarray(Akima1DInterpolator(nodes, values, axis=axis, method="makima").derivative()(nodes))
    return np.asarray(PchipInterpolator(nodes, values, axis=axis).derivative()(nodes))
