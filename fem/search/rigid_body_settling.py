"""A sheet that hangs from a point or from a line, turned about that to where its loads pull it.

Newton's method moves points along straight lines: what has to swing far would be stretched on its way.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from fem.elements.tabulation import Floats
from fem.shell.shell import Shell
from fem.supports.rigid import span_a_plane

ALIKE = 1e-9  # of the largest: what is left of loads, or of a line, in other directions


def settle_rigid_body(shell: Shell, x: Floats) -> Floats:
    """(N, 3) a state x that meets the conditions, as a rigid body where dead loads do no more work; else itself.

    Of all such places the one that the smallest turn leads to.
    """
    places = x[shell.fixed_points]
    if not shell.loads.any() or not len(places) or span_a_plane(places):
        return x
    free = shell.rigid_motions(x).shape[1]
    pivot = places.mean(axis=0)
    arms = shell.translated(x, -pivot)
    _, sizes, axes = np.linalg.svd(places - pivot)
    if free == 1 and sizes[0] > ALIKE * shell.extent:
        turn = _about_line(arms, shell.loads, axes[0])
    elif free == 3 and sizes[0] <= ALIKE * shell.extent:
        turn = _about_point(arms, shell.loads)
    else:
        return x  # something else is held, along some directions
    return shell.translated(arms @ turn.T, pivot)


def _about_line(arms: Floats, loads: Floats, axis: Floats) -> Floats:
    """(3, 3) the turn about an axis that takes points at the ends of arms (N, 3) mm as far along loads as it can."""
    across = arms - np.outer(arms @ axis, axis)
    along, aside = float((loads * across).sum()), float((loads * np.cross(axis, across)).sum())
    return np.asarray(Rotation.from_rotvec(np.arctan2(aside, along) * axis).as_matrix())


def _about_point(arms: Floats, loads: Floats) -> Floats:
    """(3, 3) the same of all turns; Kabsch 1976."""
    u, sizes, vt = np.linalg.svd(arms.T @ loads)
    if sizes[1] <= ALIKE * sizes[0]:  # all loads are parallel
        return np.asarray(Rotation.align_vectors(vt[0], u[:, 0])[0].as_matrix()) if sizes[0] > 0.0 else np.eye(3)
    vt[-1] *= np.sign(np.linalg.det(u @ vt))
    return np.asarray((u @ vt).T)
