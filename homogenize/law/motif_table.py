"""The tensors of a motif's sheet as smooth functions of the sizes of its rods."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.law.hermite_grid import HermiteGrid
from asterism.homogenize.law.tensor_forms import STORED_SIZE, SheetTensors, tensors_of_stored

# relative, of a size beyond the range of the law: rounding
SIZE_TOLERANCE = 1e-6
# of logarithms: a place so near to a node counts as on it, and in all boxes around it
LOG_SIZE_TOLERANCE = 1e-9


@dataclass(frozen=True)
class MotifTable:
    """Cells on a grid of sizes.

    The stored forms (`homogenize.law.tensor_forms`) are cubic splines over the logarithms of the sizes. These are
    linear in the answers of the cells, and so the law of a turned motif is the turned law.

    Attributes
    ----------
    nodes : (n1,), ..., (nA,) mm, increasing sizes.
    stored : (n1, ..., nA, 18) stored forms. A cell without a law has those of its own answer, or else of the nearest.
    solved : (n1, ..., nA) False for cells without a law.
    """

    nodes: tuple[Floats, ...]
    stored: Floats
    solved: Bools

    @cached_property
    def _grid(self) -> HermiteGrid | None:
        if not self.nodes:
            return None
        return HermiteGrid([np.log(nodes) for nodes in self.nodes], self.stored, ["spline"] * STORED_SIZE)

    @cached_property
    def _solved_boxes(self) -> Bools:
        boxes = self.solved
        for axis in range(boxes.ndim):
            if (n := boxes.shape[axis]) > 1:
                boxes = np.take(boxes, range(n - 1), axis) & np.take(boxes, range(1, n), axis)
        return boxes.ravel()

    @property
    def has_range(self) -> bool:
        """Whether the law covers any sizes."""
        return bool(self._solved_boxes.any())

    def __call__(self, sizes: Floats) -> tuple[SheetTensors, SheetTensors, Bools]:
        """The tensors at sizes (n, A) mm, their derivatives by the sizes, and whether the law covers the sizes, (n,).

        Outside of the nodes the tensors are those of the nearest sizes, and derivatives across the range are zero.
        """
        if self._grid is None:
            stored = np.repeat(self.stored[None], len(sizes), axis=0)
            return *tensors_of_stored(stored, np.empty((len(sizes), 0, STORED_SIZE))), np.full(
                len(sizes), self.solved[()]
            )
        low, high = (np.array([nodes[end] for nodes in self.nodes]) for end in (0, -1))
        within = (sizes >= low * (1.0 - SIZE_TOLERANCE)) & (sizes <= high * (1.0 + SIZE_TOLERANCE))
        clipped = np.clip(np.nan_to_num(sizes, nan=0.0), low, high)
        places = np.log(clipped)
        stored, slopes = self._grid(places)
        slopes *= (within & (high > low))[:, :, None] / clipped[:, :, None]
        return *tensors_of_stored(stored, slopes), within.all(axis=1) & self._is_solved(places)

    def _is_solved(self, places: Floats) -> Bools:
        """(n,) whether a place lies in a solved box, or on its boundary."""
        assert self._grid is not None, "a place has coordinates"
        solved = self._solved_boxes[self._grid.box(places)[0]]
        for sides in () if solved.all() else product((-LOG_SIZE_TOLERANCE, LOG_SIZE_TOLERANCE), repeat=len(self.nodes)):
            solved |= self._solved_boxes[self._grid.box(places + np.array(sides))[0]]
        return solved
