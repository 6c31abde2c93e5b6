"""Interpolation of sheets: exact for polynomials of its degree, and never across a notch."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.discrete.release.prolongation import interpolate_surface
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.mesh import Mesh
from asterism.pattern.mesh.meshing import mesh_layout

WHOLE = [[-30, -30], [30, -30], [30, 30], [-30, 30]]
# a cut whose lips are 0.2 mm apart at the rim, and meet in the middle
SLIT = [[-30, -30], [30, -30], [30, -0.1], [0, 0], [30, 0.1], [30, 30], [-30, 30]]


def mesh(border: list[list[float]], edge_mm: float) -> Mesh:
    data = {"stars": {"length_mm": 6.0}, "border": {"polygon_mm": border}}
    return mesh_layout(layout(Design.from_dict(data)), edge_mm)


def bowl(points: Array) -> Array:
    x, y = points.T
    return np.column_stack([0.8 * points, 0.01 * (x**2 + x * y)])


def opened(points: Array) -> Array:
    """One lip up, the other one down."""
    x, y = points.T
    return np.column_stack([points, np.where(x > 0.0, np.sign(y) * 0.01 * x**2, 0.0)])


@pytest.mark.parametrize("border", [WHOLE, SLIT])
@pytest.mark.parametrize(("smooth", "part"), [(True, 0.4), (False, 1.0)])
def test_a_bowl_is_interpolated(border: list[list[float]], smooth: bool, part: float) -> None:
    """Flat triangles deviate from a surface by 1/8 of its curvature times the square of their edge."""
    coarse, fine = mesh(border, 4.0), mesh(border, 1.5)
    found = interpolate_surface(coarse.points, coarse.triangles, bowl(coarse.points), fine.points, smooth)
    corners = coarse.points[coarse.triangles]
    edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
    curvature = np.linalg.eigvalsh([[0.02, 0.01], [0.01, 0.0]]).max()
    assert np.abs(found - bowl(fine.points)).max() < part * curvature * edge**2 / 8.0


@pytest.mark.parametrize("smooth", [True, False])
def test_lips_of_a_slit_stay_apart(smooth: bool) -> None:
    coarse, fine = mesh(SLIT, 4.0), mesh(SLIT, 1.5)
    found = interpolate_surface(coarse.points, coarse.triangles, opened(coarse.points), fine.points, smooth)
    lips = (np.abs(fine.points[:, 1]) < 0.2) & (fine.points[:, 0] > 5.0)
    assert lips.sum() > 20
    assert np.abs(found - opened(fine.points))[lips].max() < 0.1


def test_beyond_the_rim_the_nearest_triangle_continues() -> None:
    coarse = mesh(SLIT, 4.0)
    beyond = np.array([[-30.5, 11.0], [12.0, 30.0 + 1e-12], [30.4, -30.4]])
    tilted = np.column_stack([coarse.points, coarse.points @ [0.3, -0.2]])
    found = interpolate_surface(coarse.points, coarse.triangles, tilted, beyond, True)
    assert found == pytest.approx(np.column_stack([beyond, beyond @ [0.3, -0.2]]), abs=1e-9)
