"""The tensors of a sheet in the forms that a law of a motif interpolates, and back.

Metric and stiffnesses are symmetric and positive definite. Their matrix logarithms are interpolated ("log-Euclidean",
Arsigny, Fillard, Pennec and Ayache 2007), so that they stay positive definite between the cells. Stiffnesses are
written in an orthonormal basis of symmetric matrices (Kelvin, Mandel) first: a turn of the axes is then an orthogonal
matrix, and the interpolation does not depend on the axes. Instead of the rest curvature its moment is interpolated:
that of a rod with the width w on fabric of the thickness h2 is nearly `w (h1 + h2)` in the thickness h1, while the rest
curvature itself grows without limit for thin rods.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.anisotropy import VOIGT_ENTRIES, VOIGT_NORM, voigt_matrices

# of a row of stored forms
METRIC, MEMBRANE, BENDING, MOMENT = slice(0, 3), slice(3, 9), slice(9, 15), slice(15, 18)
STORED_SIZE = 18
# Voigt vector (11, 22, 2 x 12) of a curvature with the components 11, 22, 12
TO_VOIGT = np.array([1.0, 1.0, 2.0])


@dataclass(frozen=True)
class SheetTensors:
    """Tensors of a sheet at n places."""

    metric: Floats  # (n, 3) components 11, 22, 12 of the rest metric
    stiffness: Floats  # (n, 6, 6) membrane (N/mm) and bending (N mm), Voigt; without coupling
    curvature: Floats  # (n, 3) rest curvature, components 11, 22, 12, 1/mm; negative with the plastic outside


def stored_tensors(tensors: SheetTensors) -> Floats:
    """(n, 18) stored forms.

    >>> sheet = SheetTensors(np.array([[0.9, 0.8, 0.1]]), np.eye(6)[None], np.array([[-0.01, 0.0, 0.0]]))
    >>> again = tensors_of_stored(stored_tensors(sheet))
    >>> again.metric.round(12), again.curvature.round(12) + 0.0
    (array([[0.9, 0.8, 0.1]]), array([[-0.01,  0.  ,  0.  ]]))
    """
    membrane, bending = tensors.stiffness[:, :3, :3], tensors.stiffness[:, 3:, 3:]
    moment = np.einsum("nij,nj->ni", bending, tensors.curvature * TO_VOIGT)
    parts = [_plane_entries(_of_eigenvalues(np.log, plane_matrix(tensors.metric)))]
    for each in (membrane, bending):
        logarithm = _of_eigenvalues(np.log, each * VOIGT_NORM)
        parts.append(np.stack([logarithm[..., i, j] for i, j in VOIGT_ENTRIES], axis=-1))
    return np.hstack([*parts, moment])


def tensors_of_stored(stored: Floats) -> SheetTensors:
    """The tensors of stored forms (n, 18)."""
    stiffness = np.zeros((len(stored), 6, 6))
    for part, where in ((MEMBRANE, slice(0, 3)), (BENDING, slice(3, 6))):
        stiffness[:, where, where] = _of_eigenvalues(np.exp, voigt_matrices(stored[:, part])) / VOIGT_NORM
    voigt = np.linalg.solve(stiffness[:, 3:, 3:], stored[:, MOMENT, None])[..., 0]
    metric = _plane_entries(_of_eigenvalues(np.exp, plane_matrix(stored[:, METRIC])))
    return SheetTensors(metric, stiffness, voigt / TO_VOIGT)


def plane_matrix(entries: Floats) -> Floats:
    """(..., 2, 2) symmetric matrices from their components 11, 22, 12."""
    return entries[..., [0, 2, 2, 1]].reshape(*entries.shape[:-1], 2, 2)


def _plane_entries(matrices: Floats) -> Floats:
    return matrices[..., [0, 1, 0], [0, 1, 1]]


def _of_eigenvalues(function: Callable[[Floats], Floats], matrices: Floats) -> Floats:
    """The function of symmetric matrices (..., k, k) that acts on their eigenvalues."""
    sizes, axes = np.linalg.eigh(matrices)
    return np.asarray((axes * function(sizes)[..., None, :]) @ np.swapaxes(axes, -1, -2))
