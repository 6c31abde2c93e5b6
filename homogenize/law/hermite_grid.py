"""Interpolation on a grid: cubic along each axis, with exact first derivatives.

In every box of the grid a function is the tensor product of cubic Hermite polynomials. The slopes at the nodes come
from the data along grid lines (`homogenize.law.grid_slopes`). With the rule "monotone" the function is monotone along
every grid line on which the data are; the rule "smooth" follows a smooth maximum more closely. Mixed derivatives at the
nodes are slopes of slopes. The function and its first derivatives are continuous.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.homogenize.law.grid_slopes import SlopeRule, node_slopes


class HermiteGrid:
    """Q functions of A coordinates, given by their values at the nodes of a grid.

    Parameters
    ----------
    axes : A increasing lists of nodes. Along a list of one node the functions are constant.
    values : (n1, ..., nA, Q).
    rules : (Q,) rule for the slopes of each function.

    Examples
    --------
    >>> grid = HermiteGrid([np.array([0.0, 1.0, 2.0])], np.array([[0.0], [1.0], [4.0]]), ["smooth"])
    >>> value, slope = grid(np.array([[1.5]]))
    >>> value, slope
    (array([[2.25]]), array([[[3.]]]))
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
        return np.ascontiguousarray(stacked.reshape(-1, 4**count, stacked.shape[-1]))

    def box(self, points: Floats) -> tuple[Ints, Floats]:
        """Number of the box that each point (N, A) lies in, (N,), and place in the box (N, A) from 0 to 1."""
        place = np.empty_like(points)
        number = np.zeros(len(points), dtype=np.int64)
        for axis, nodes in enumerate(self.axes):
            index = np.searchsorted(nodes[1:-1], points[:, axis], side="right")
            place[:, axis] = (points[:, axis] - nodes[index]) / (nodes[index + 1] - nodes[index])
            number = number * self.boxes[axis] + index
        return number, place

    def __call__(self, points: Floats) -> tuple[Floats, Floats]:
        """Values (N, Q) and first derivatives (N, A, Q) at points (N, A) within the grid."""
        number, place = self.box(points)
        basis, slope = _cubics(place)
        index = np.unravel_index(number, self.boxes)
        count = len(self.axes)
        for axis, nodes in enumerate(self.axes):
            slope[:, axis] /= np.diff(nodes)[index[axis]][:, None]
        weights = np.empty((len(points), count + 1, 4**count))
        for row in range(count + 1):  # row 0: values; row a + 1: derivative along axis a
            factors = [slope[:, axis] if row == axis + 1 else basis[:, axis] for axis in range(count)]
            tensor = factors[-1]
            for factor in factors[-2::-1]:
                tensor = (factor[:, :, None] * tensor[:, None, :]).reshape(len(points), -1)
            weights[:, row] = tensor
        both = weights @ self._coefficients[number]
        return both[:, 0], both[:, 1:]


def _cubics(t: Floats) -> tuple[Floats, Floats]:
    """(N, A, 4) cubic Hermite polynomials at t (N, A): values at 0 and 1, slopes at 0 and 1; and their derivatives."""
    u = 1 - t
    values = np.stack([(1 + 2 * t) * u * u, (1 + 2 * u) * t * t, t * u * u, -u * t * t], axis=-1)
    slopes = np.stack([-6 * t * u, 6 * t * u, u * (1 - 3 * t), t * (3 * t - 2)], axis=-1)
    return values, slopes
