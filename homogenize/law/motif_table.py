"""The tensors of a motif's sheet as smooth functions of the sizes of its rods."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.law.hermite_grid import HermiteGrid
from asterism.homogenize.law.tensor_forms import STORED_SIZE, SheetTensors, tensors_of_stored

# relative, of a size beyond the range of the law: rounding
SIZE_TOLERANCE = 1e-6
# of logarithms: a place so near to a node counts as on it, and in all boxes around it
LOG_SIZE_TOLERANCE = 1e-9
# errors in percent: of the length of the flat sheet, of energies, and of the largest curvature
MIN_CURVATURE = 1e-9  # 1/mm, of a sheet that does not curl
MOTIF_QUANTITIES = ("stretch", "membrane", "bending", "curvature")


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


def tensor_errors(law: SheetTensors, cell: SheetTensors) -> Floats:
    """(n, 4) errors in percent of `MOTIF_QUANTITIES`, the same in all axes.

    - stretch: the largest error of the length of a line on the flat sheet;
    - membrane, bending: the largest error of the energy of a strain or curvature, over that energy;
    - curvature: the norm of the error of the rest curvature over the norm of the rest curvature.

    Examples
    --------
    >>> cell = SheetTensors(np.array([[0.81, 0.64, 0.0]]), np.eye(6)[None], np.array([[-0.01, 0.0, 0.0]]))
    >>> law = SheetTensors(1.02 * cell.metric, 1.01 * cell.stiffness, 0.99 * cell.curvature)
    >>> tensor_errors(law, cell).round(2)
    array([[1., 1., 1., 1.]])
    """
    metric, known = (_matrix(each.metric) for each in (law, cell))
    errors = [np.abs(np.sqrt(_ratios(metric, known)) - 1.0).max(axis=-1)]
    for part in (slice(0, 3), slice(3, 6)):
        errors.append(np.abs(_ratios(law.stiffness[:, part, part], cell.stiffness[:, part, part]) - 1.0).max(axis=-1))
    apart, size = (
        np.linalg.norm(_matrix(each), axis=(1, 2)) for each in (law.curvature - cell.curvature, cell.curvature)
    )
    errors.append(apart / np.maximum(size, MIN_CURVATURE))
    return 100.0 * np.stack(errors, axis=-1)


def held_out_errors(table: MotifTable, sizes: Floats, cells: SheetTensors) -> dict[str, Any]:
    """Errors at cells that the fit has not seen: median, root mean square and largest, in percent.

    Parameters
    ----------
    sizes : (n, A) of the cells, all of which have a law; those outside the range of the table are left out.
    cells : their tensors.
    """
    if not len(sizes):
        return {"count": 0, "errors": {}}
    law, _, inside = table(sizes)
    rows = tensor_errors(law, cells)[inside]
    if not len(rows):
        return {"count": 0, "errors": {}}
    errors = {
        name: {
            "median_percent": float(np.median(column)),
            "rms_percent": float(np.sqrt((column**2).mean())),
            "largest_percent": float(column.max()),
        }
        for name, column in zip(MOTIF_QUANTITIES, rows.T, strict=True)
    }
    return {"count": len(rows), "errors": errors}


def _matrix(entries: Floats) -> Floats:
    return entries[..., [0, 2, 2, 1]].reshape(*entries.shape[:-1], 2, 2)


def _ratios(ours: Floats, known: Floats) -> Floats:
    """(n, k) stationary ratios of two quadratic forms (n, k, k)."""
    root = np.linalg.inv(np.linalg.cholesky(known))
    return np.asarray(np.linalg.eigvalsh(root @ ours @ np.swapaxes(root, -1, -2)))
