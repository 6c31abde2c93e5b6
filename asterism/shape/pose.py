"""Principal axes of a sheet, and the pose in which a free sheet is shown and compared."""

from __future__ import annotations

import numpy as np

from pattern.geometry.arrays import Floats


def principal_axes(positions: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Axes of the second moments about the centre of mass.

    Parameters
    ----------
    positions : (V, 3) mm.
    weights : (V,), adding up to 1.

    Returns
    -------
    axes : (3, 3) rows, right-handed, the largest moment first.
    moments : (3,) mm^2.
    """
    centred = positions - weights @ positions
    moments, vectors = np.linalg.eigh((weights[:, None] * centred).T @ centred)
    axes = vectors.T[::-1].copy()
    axes[2] *= np.sign(np.linalg.det(axes))
    return axes, moments[::-1]


def upright_rotation(printed: Floats, positions: Floats, weights: Floats, plastic_side: Floats) -> Floats:
    """The rotation that lays the principal axes along x, y and z with the plastic side up.

    Axes of nearly equal moments (a dome from above, the section of a tube) have no direction of their own:
    there the plastic side and the printed directions decide, so that equal shapes get equal pictures.

    Parameters
    ----------
    printed : (V, 2) mm.
    positions : (V, 3) mm.
    weights : (V,), adding up to 1.
    plastic_side : (3,) any length, mean direction of the normals.

    Returns
    -------
    (3, 3), to be applied to columns.
    """
    (long, middle, short), moments = principal_axes(positions, weights)
    if moments[1] < 1.3 * moments[2]:
        across = plastic_side - (plastic_side @ long) * long
        if np.linalg.norm(across) > 0:
            short = across / np.linalg.norm(across)
    elif plastic_side @ short < 0:
        short = -short
    middle = np.cross(short, long)

    flat = (positions - weights @ positions) @ np.column_stack([long, middle])
    overlap = (weights[:, None] * (printed - weights @ printed)).T @ flat
    turn = np.arctan2(overlap[1, 0] - overlap[0, 1], overlap[0, 0] + overlap[1, 1])
    if moments[0] > 1.1 * moments[1]:
        # a clear long side stays along x: only a half turn is left to choose
        turn = 0.0 if abs(turn) <= np.pi / 2 else np.pi
    cos, sin = np.cos(turn), np.sin(turn)
    return np.array([cos * long - sin * middle, sin * long + cos * middle, short])
