"""Every pixel sees the nearest triangle, without holes between neighbours."""

from __future__ import annotations

import numpy as np

from asterism.draw.render import rasterise
from tests.asterism import sheets


def test_the_nearer_triangle_is_seen() -> None:
    square = np.array([[2.0, 2.0], [18.0, 2.0], [2.0, 18.0]])
    places, triangles = np.concatenate([square, square]), np.array([[0, 1, 2], [3, 4, 5]])
    for nearer in (0, 1):
        depth = np.repeat([1.0, 0.0] if nearer == 0 else [0.0, 1.0], 3)
        raster = rasterise(places, depth, triangles, 20, 20)
        assert set(np.unique(raster.face)) == {-1, nearer}
        assert np.allclose(raster.depth[raster.face >= 0], 1.0)


def test_triangles_that_cross_are_cut_along_their_line() -> None:
    corners = np.array([[0.0, 0.0], [40.0, 0.0], [0.0, 40.0]])
    places, triangles = np.concatenate([corners, corners]), np.array([[0, 1, 2], [3, 4, 5]])
    depth = np.concatenate([corners[:, 0], np.full(3, 10.0)])
    raster = rasterise(places, depth, triangles, 40, 40)
    column = np.arange(40)[None] + 0.5
    covered = raster.face >= 0
    assert np.array_equal(raster.face[covered], np.broadcast_to(column < 10, (40, 40))[covered].astype(int))


def test_a_mesh_has_no_holes_and_its_weights_give_the_pixel_back() -> None:
    flat, triangles = sheets.grid(100.0, 80.0, 3.0)
    places = 1.7 * flat + np.array([90.0, 71.0])
    raster = rasterise(places, np.zeros(len(flat)), triangles, 150, 190)
    x, y = np.arange(190) + 0.5, np.arange(150) + 0.5
    inside = ((x > 5) & (x < 175))[None] & ((y > 3) & (y < 139))[:, None]
    assert np.array_equal(raster.face >= 0, inside)
    row, column = np.nonzero(raster.face >= 0)
    centres = np.column_stack([column, row]) + 0.5
    across, upwards, constant = raster.affine(places, triangles)[:, raster.face[row, column]]
    assert np.allclose(across * centres[:, :1] + upwards * centres[:, 1:] + constant, centres, atol=1e-9)


def test_what_lies_outside_or_edge_on_is_left_out() -> None:
    places = np.array([[-50.0, -50.0], [-10.0, -50.0], [-50.0, -10.0], [5.0, 5.0], [9.0, 9.0], [7.0, 7.0]])
    raster = rasterise(places, np.zeros(6), np.array([[0, 1, 2], [3, 4, 5]]), 10, 10)
    assert (raster.face == -1).all()
