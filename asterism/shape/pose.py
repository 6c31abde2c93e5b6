"""The standard pose of a free sheet in pictures and measures."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float


def upright_rotation(
    printed: Float[np.ndarray, "V 2"],
    positions: Float[np.ndarray, "V 3"],
    weights: Float[np.ndarray, " V"],
    plastic_side: Float[np.ndarray, " 3"],
) -> Float[np.ndarray, "3 3"]:
    """Compute the rotation that turns the principal axes to x, y and z, with the plastic side up.

    If two moments are nearly equal (a dome seen from above, the section of a tube), their axes are undetermined. Then
    the plastic side and the printed directions decide, so that equal shapes have equal pictures.

    Parameters
    ----------
    printed, positions : (V, 2) and (V, 3) mm.
    weights : (V,), adding up to 1.
    plastic_side : (3,) mean direction of the normals, of any length.

    Returns
    -------
    (3, 3), applied to column vectors.
    """
    centred = positions - weights @ positions
    # principal axes of the second moments, the smallest first
    moments, axes = np.linalg.eigh((weights[:, None] * centred).T @ centred)
    (short, middle, long), moments = axes.T, moments[::-1]
    short = short * np.sign(np.linalg.det([long, middle, short]))
    if moments[1] < 1.3 * moments[2]:
        across = plastic_side - (plastic_side @ long) * long
        if np.linalg.norm(across) > 0:
            short = across / np.linalg.norm(across)
    elif plastic_side @ short < 0:
        short = -short
    middle = np.cross(short, long)

    flat = centred @ np.column_stack([long, middle])
    overlap = (weights[:, None] * (printed - weights @ printed)).T @ flat
    turn = np.arctan2(overlap[1, 0] - overlap[0, 1], overlap[0, 0] + overlap[1, 1])
    if moments[0] > 1.1 * moments[1]:
        # the longest axis is well determined and stays along x: the only choice left is a half turn
        turn = 0.0 if abs(turn) <= np.pi / 2 else np.pi
    cos, sin = np.cos(turn), np.sin(turn)
    return np.array([cos * long - sin * middle, sin * long + cos * middle, short])
