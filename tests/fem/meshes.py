"""Meshes for the tests of the shell."""

import numpy as np
from skfem import MeshTri


def rectangle(columns: int, rows: int, width: float = 1.0, height: float = 1.0, amount: float = 0.0) -> MeshTri:
    """A rectangle from the origin whose inner vertices are shifted by up to `amount` of a cell."""
    x, y = np.linspace(0.0, width, columns + 1), np.linspace(0.0, height, rows + 1)
    mesh = MeshTri.init_tensor(x, y)
    points, inner = mesh.p.copy(), mesh.interior_nodes()
    moves = np.random.default_rng(0).uniform(-1.0, 1.0, (2, len(inner)))
    points[:, inner] += amount * np.array([[x[1]], [y[1]]]) * moves
    return MeshTri(points, mesh.t)


def graded(columns: int, rows: int, width: float, height: float, power: float = 1.5) -> MeshTri:
    """About the origin, finer towards the rim: a cell's distance from it goes with this power of its number."""

    def places(count: int) -> np.ndarray:
        u = np.linspace(-1.0, 1.0, count + 1)
        return np.sign(u) * (1.0 - (1.0 - np.abs(u)) ** power)

    return MeshTri.init_tensor(0.5 * width * places(columns), 0.5 * height * places(rows))


def turned(mesh: MeshTri, degrees: float, shift: tuple[float, float]) -> MeshTri:
    """The mesh rotated about the origin, then shifted."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return MeshTri(np.array([[c, -s], [s, c]]) @ mesh.p + np.array(shift)[:, None], mesh.t)


def facets_where(mesh: MeshTri, test) -> np.ndarray:
    """Outer edges whose midpoint (2,) passes a test of its coordinates x, y."""
    rim = mesh.boundary_facets()
    x, y = mesh.p[:, mesh.facets[:, rim]].mean(axis=1)
    return rim[test(x, y)]


def annulus(sectors: int, rings: list[float]) -> MeshTri:
    """Around the origin, the vertices of every second ring half a sector on; the polygons have their circles' areas."""
    angles = 2.0 * np.pi * np.arange(sectors) / sectors
    turns = [angles + np.pi / sectors * (i % 2) for i in range(len(rings))]
    points = np.hstack([r * np.array([np.cos(a), np.sin(a)]) for r, a in zip(rings, turns, strict=True)])
    j = np.arange(sectors)
    after = (j + 1) % sectors
    triangles = []
    for i in range(len(rings) - 1):
        a, b, c, d = (ring * sectors + k for ring in (i, i + 1) for k in (j, after))
        triangles += [(a, b, c), (b, d, c)] if i % 2 == 0 else [(a, b, d), (a, d, c)]
    scale = np.sqrt(2.0 * np.pi / sectors / np.sin(2.0 * np.pi / sectors))
    return MeshTri(scale * points, np.hstack([np.array(triple) for triple in triangles]))
