"""How far the law of a motif is from cells that its fit has not seen."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.motif_table import MotifTable
from asterism.homogenize.law.tensor_forms import SheetTensors

# errors in percent: of the length of the flat sheet, of energies, and of the largest curvature
MIN_CURVATURE = 1e-9  # 1/mm, of a sheet that does not curl
MOTIF_QUANTITIES = ("stretch", "membrane", "bending", "curvature")


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
