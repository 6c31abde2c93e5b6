"""The tensors of a sheet in the forms that a law of a motif interpolates, and back, with derivatives.

Metric and stiffnesses are symmetric and positive definite. Their matrix logarithms are interpolated ("log-Euclidean",
Arsigny, Fillard, Pennec and Ayache 2007), so that they stay positive definite between the cells. Stiffnesses are
written in an orthonormal basis of symmetric matrices (Kelvin, Mandel) first: a turn of the axes is then an orthogonal
matrix, and the interpolation does not depend on the axes. Instead of the rest curvature its moment is interpolated:
that of a rod with the width w on fabric of the thickness h2 is nearly `w (h1 + h2)` in the thickness h1, while the rest
curvature itself grows without limit for thin rods.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats

# of a row of stored forms
METRIC, MEMBRANE, BENDING, MOMENT = slice(0, 3), slice(3, 9), slice(9, 15), slice(15, 18)
STORED_SIZE = 18
# Voigt vector (11, 22, 2 x 12) of a curvature with the components 11, 22, 12
TO_VOIGT = np.array([1.0, 1.0, 2.0])
# of a Voigt stiffness in the orthonormal basis
_KELVIN = np.array([1.0, 1.0, np.sqrt(2.0)])
# relative difference of two eigenvalues, below which their divided difference is a derivative
_CLOSE = 1e-6


@dataclass(frozen=True)
class SheetTensors:
    """Tensors of a sheet at n places."""

    metric: Floats  # (n, 3) components 11, 22, 12 of the rest metric
    stiffness: Floats  # (n, 6, 6) membrane (N/mm) and bending (N mm), Voigt; without coupling
    curvature: Floats  # (n, 3) rest curvature, components 11, 22, 12, 1/mm; negative with the plastic outside


def stored_tensors(tensors: SheetTensors) -> Floats:
    """(n, 18) stored forms.

    Examples
    --------
    >>> sheet = SheetTensors(np.array([[0.9, 0.8, 0.1]]), np.eye(6)[None], np.array([[-0.01, 0.0, 0.0]]))
    >>> again, _ = tensors_of_stored(stored_tensors(sheet), np.empty((1, 0, STORED_SIZE)))
    >>> again.metric.round(12), again.curvature.round(12) + 0.0
    (array([[0.9, 0.8, 0.1]]), array([[-0.01,  0.  ,  0.  ]]))
    """
    membrane, bending = tensors.stiffness[:, :3, :3], tensors.stiffness[:, 3:, 3:]
    moment = np.einsum("nij,nj->ni", bending, tensors.curvature * TO_VOIGT)
    scale = np.outer(_KELVIN, _KELVIN)
    parts = [_entries(_logarithm(_metric_matrix(tensors.metric)))]
    parts += [_entries(_logarithm(each * scale)) for each in (membrane, bending)]
    return np.hstack([*parts, moment])


def tensors_of_stored(stored: Floats, slopes: Floats) -> tuple[SheetTensors, SheetTensors]:
    """The tensors of stored forms (n, 18), and their derivatives from those of the stored forms (n, A, 18)."""
    metric, metric_slope = _exponential(stored[:, METRIC], slopes[..., METRIC])
    stiffness = np.zeros((len(stored), 6, 6))
    stiffness_slope = np.zeros((*slopes.shape[:2], 6, 6))
    scale = np.outer(_KELVIN, _KELVIN)
    for part, where in ((MEMBRANE, slice(0, 3)), (BENDING, slice(3, 6))):
        value, slope = _exponential(stored[:, part], slopes[..., part])
        stiffness[:, where, where], stiffness_slope[..., where, where] = value / scale, slope / scale
    bending, bending_slope = stiffness[:, 3:, 3:], stiffness_slope[..., 3:, 3:]
    voigt = np.linalg.solve(bending, stored[:, MOMENT, None])[..., 0]
    load = slopes[..., MOMENT] - np.einsum("naij,nj->nai", bending_slope, voigt)
    voigt_slope = np.linalg.solve(bending[:, None], load[..., None])[..., 0]
    return (
        SheetTensors(_metric_entries(metric), stiffness, voigt / TO_VOIGT),
        SheetTensors(_metric_entries(metric_slope), stiffness_slope, voigt_slope / TO_VOIGT),
    )


def _metric_matrix(metric: Floats) -> Floats:
    return metric[..., [0, 2, 2, 1]].reshape(*metric.shape[:-1], 2, 2)


def _metric_entries(matrix: Floats) -> Floats:
    return np.stack([matrix[..., 0, 0], matrix[..., 1, 1], matrix[..., 0, 1]], axis=-1)


def _logarithm(matrices: Floats) -> Floats:
    sizes, axes = np.linalg.eigh(matrices)
    return np.asarray((axes * np.log(sizes)[..., None, :]) @ np.swapaxes(axes, -1, -2))


def _exponential(entries: Floats, slopes: Floats) -> tuple[Floats, Floats]:
    """Exponentials (n, k, k) of symmetric matrices by their `_entries`, and derivatives (n, A, k, k).

    The derivative is that of Daleckii and Krein: divided differences in the axes of the matrix.
    """
    sizes, axes = np.linalg.eigh(_symmetric(entries))
    back = np.swapaxes(axes, -1, -2)
    grown = np.exp(sizes)
    value = (axes * grown[..., None, :]) @ back
    if not slopes.shape[1]:
        return value, np.empty((len(entries), 0, *value.shape[1:]))
    apart = sizes[..., :, None] - sizes[..., None, :]
    mean = np.exp(0.5 * (sizes[..., :, None] + sizes[..., None, :]))
    close = np.abs(apart) < _CLOSE
    divided = np.where(
        close, mean, (grown[..., :, None] - grown[..., None, :]) / np.where(close, 1.0, apart)
    )  # the mean is exact to the square of the difference
    turned = back[:, None] @ _symmetric(slopes) @ axes[:, None]
    return value, np.asarray(axes[:, None] @ (turned * divided[:, None]) @ back[:, None])


def _entries(matrices: Floats) -> Floats:
    """(..., k (k + 1)/2) the entries of symmetric matrices: the diagonal, and those above it row by row."""
    k = matrices.shape[-1]
    rows, columns = _places(k)
    return np.asarray(matrices[..., rows, columns])


def _symmetric(entries: Floats) -> Floats:
    k = 2 if entries.shape[-1] == 3 else 3
    rows, columns = _places(k)
    out = np.empty((*entries.shape[:-1], k, k))
    out[..., rows, columns] = out[..., columns, rows] = entries
    return out


def _places(k: int) -> tuple[Floats, Floats]:
    above = np.triu_indices(k, 1)
    diagonal = np.arange(k)
    return np.concatenate([diagonal, above[0]]), np.concatenate([diagonal, above[1]])
