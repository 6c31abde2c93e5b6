"""Meshes the shell's tests share."""

import numpy as np
from skfem import MeshTri


def jittered(cells: int, width: float = 1.0, height: float = 1.0, amount: float = 0.2, seed: int = 0) -> MeshTri:
    """Rectangle from the origin, `cells` along its shorter side, inner vertices moved by up to `amount` of a cell."""
    size = min(width, height) / cells
    mesh = MeshTri.init_tensor(
        np.linspace(0.0, width, round(width / size) + 1), np.linspace(0.0, height, round(height / size) + 1)
    )
    points, inner = mesh.p.copy(), mesh.interior_nodes()
    points[:, inner] += amount * size * np.random.default_rng(seed).uniform(-1.0, 1.0, (2, len(inner)))
    return MeshTri(points, mesh.t)
