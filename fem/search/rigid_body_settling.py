"""Rigid-body settling: rotates a sheet that is fixed at a point or a line until its dead loads are in equilibrium.

Newton's method moves points along straight lines, so a large rotation would stretch the sheet on its way.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.rigid import span_a_plane

RANK_TOLERANCE = 1e-9  # 1: singular value over the largest, below which it is zero (points on a line, parallel loads)


def settle_rigid_body(shell: Shell, x: Floats) -> Floats:
    """(N, 3) the state x after the rotation that maximises the work of the dead loads; x if it cannot rotate.

    Both x and the result meet the supports.
    """
    places = x[shell.fixed_points]
    if not shell.loads.any() or not len(places) or span_a_plane(places):
        return x
    free = shell.rigid_motions(x).shape[1]
    pivot = places.mean(axis=0)
    arms = shell.translated(x, -pivot)
    _, sizes, axes = np.linalg.svd(places - pivot)
    if free == 1 and sizes[0] > RANK_TOLERANCE * shell.extent:
        rotation = _about_line(arms, shell.loads, axes[0])
    elif free == 3 and sizes[0] <= RANK_TOLERANCE * shell.extent:
        rotation = _about_point(arms, shell.loads)
    else:
        return x  # other supports fix some components
    return shell.translated(arms @ rotation.T, pivot)


def _about_line(arms: Floats, loads: Floats, axis: Floats) -> Floats:
    """(3, 3) the rotation about an axis that maximises the work of the loads on points at arms (N, 3) mm."""
    across = arms - np.outer(arms @ axis, axis)
    along, aside = float((loads * across).sum()), float((loads * np.cross(axis, across)).sum())
    return np.asarray(Rotation.from_rotvec(np.arctan2(aside, along) * axis).as_matrix())


def _about_point(arms: Floats, loads: Floats) -> Floats:
    """(3, 3) the rotation about a point that maximises the work of the loads (Kabsch 1976)."""
    u, sizes, vt = np.linalg.svd(arms.T @ loads)
    if sizes[1] <= RANK_TOLERANCE * sizes[0]:  # all loads are parallel
        return np.asarray(Rotation.align_vectors(vt[0], u[:, 0])[0].as_matrix()) if sizes[0] > 0.0 else np.eye(3)
    vt[-1] *= np.sign(np.linalg.det(u @ vt))
    return np.asarray((u @ vt).T)
