"""The rigid motion that brings one set of points closest to another."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float


def rigid_fit(
    points: Float[np.ndarray, "n d"], targets: Float[np.ndarray, "n d"], weight: Float[np.ndarray, " n"] | None = None
) -> tuple[Float[np.ndarray, "d d"], Float[np.ndarray, " d"]]:
    """Rotation (d, d), proper, and shift (d,) that bring points (n, d) closest to targets: `x @ rotation.T + shift`.

    Kabsch 1976, least squares with weights (n,).
    """
    w = np.full(len(points), 1.0) if weight is None else weight
    w = w / w.sum()
    centre, goal = w @ points, w @ targets
    u, _, vt = np.linalg.svd((w[:, None] * (points - centre)).T @ (targets - goal))
    u[:, -1] *= np.sign(np.linalg.det(u @ vt))
    rotation = (u @ vt).T
    return rotation, goal - rotation @ centre
