"""Every pixel sees the nearest triangle, without holes between neighbours; what is held is seen in pictures."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from PIL import Image
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from asterism import Design, Shape
from asterism.draw.render import PINS, rasterise
from asterism.draw.scene import BALL_RADIUS_FACTOR, TUBE_RADIUS_FACTOR, pin_marks
from asterism.pattern.geometry.diameter import diameter
from tests.asterism.sheets import dome, grid, sheet


def test_triangles_that_cross_are_cut_along_their_line() -> None:
    corners = np.array([[0.0, 0.0], [40.0, 0.0], [0.0, 40.0]])
    places, triangles = np.concatenate([corners, corners]), np.array([[0, 1, 2], [3, 4, 5]])
    depth = np.concatenate([corners[:, 0], np.full(3, 10.0)])
    raster = rasterise(places, depth, triangles, 40, 40)
    column = np.arange(40)[None] + 0.5
    covered = raster.face >= 0
    assert set(np.unique(raster.face)) == {-1, 0, 1}
    assert np.allclose(raster.depth[covered], np.broadcast_to(np.maximum(column, 10.0), (40, 40))[covered])
    assert np.array_equal(raster.face[covered], np.broadcast_to(column < 10, (40, 40))[covered].astype(int))


def test_a_mesh_has_no_holes_and_its_weights_give_the_pixel_back() -> None:
    flat, triangles = grid(100.0, 80.0, 3.0)
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


RECTANGLE = {"stars": {"length_mm": 8.0}, "border": {"rectangle_mm": [100.0, 80.0]}}


def held(*pins: dict[str, Any]) -> Shape:
    """A dome, as if these pins held it."""
    design = Design.from_dict(RECTANGLE | {"pins": list(pins)}).to_dict()
    shape = sheet(dome)
    return replace(shape, held=bool(pins), summary=dict(shape.summary) | {"design": design})


def test_balls_at_points() -> None:
    shape = held({"points_mm": [[10.0, 5.0]]}, {"corners": [0, 2]})
    points, normals, triangles = pin_marks(shape)
    radius = BALL_RADIUS_FACTOR * diameter(shape.positions)
    places = shape.at(np.array([[10.0, 5.0], [-50.0, -40.0], [50.0, 40.0]]))
    outwards = points.reshape(3, -1, 3) - places[:, None]
    assert np.linalg.norm(outwards, axis=2) == pytest.approx(radius)
    assert normals == pytest.approx(outwards.reshape(-1, 3) / radius)
    # closed surfaces that turn left as seen from outside
    volume = np.linalg.det(points[triangles]).sum() / 6.0
    assert 0.6 < volume / (3 * 4.0 / 3.0 * np.pi * radius**3) < 1.0


def test_tubes_along_sides() -> None:
    shape = held({"edges": [1]})
    points, normals, triangles = pin_marks(shape)
    radius = TUBE_RADIUS_FACTOR * diameter(shape.positions)
    side = shape.at(np.column_stack([np.full(400, 50.0), np.linspace(-40.0, 40.0, 400)]))
    away = np.linalg.norm(points[:, None] - side, axis=2).min(axis=1)
    assert away.max() < 1.2 * radius and np.median(away) > 0.8 * radius
    a, b, c = points[triangles].transpose(1, 0, 2)
    assert (np.einsum("ti,ti->t", np.cross(b - a, c - a), normals[triangles].sum(axis=1)) > -1e-12).all()


def test_sheets_without_known_pins_have_no_marks() -> None:
    plain, corners = sheet(dome), held({"where": "corners"})
    other_print = replace(corners, printed=0.5 * corners.printed)
    for shape in (held(), plain, replace(plain, held=True), other_print):
        assert [len(each) for each in pin_marks(shape)] == [0, 0, 0]


@pytest.mark.slow
def test_pictures_show_them() -> None:
    def red(shape: Shape) -> float:
        colours = np.asarray(Image.open(BytesIO(shape._repr_png_())).convert("RGB")).astype(float)
        return float((np.ptp(colours, axis=2) > 255.0 * 0.6 * np.ptp(PINS)).mean())

    assert red(held()) < 1e-5 and red(held({"where": "border"})) > 1e-3


@pytest.mark.parametrize(("edges", "lines"), [([0, 2], 2), ([0, 1, 2, 3], 1), ([3, 0], 1)])
def test_sides_that_follow_each_other_are_one_tube(edges: list[int], lines: int) -> None:
    shape = held({"edges": edges})
    points, _, triangles = pin_marks(shape)
    edge = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    graph = coo_array((np.ones(len(edge)), edge.T), shape=2 * (len(points),))
    sizes = np.bincount(connected_components(graph, directed=False)[1])
    assert np.count_nonzero(sizes > sizes.min()) == lines


def test_a_finely_drawn_outline_is_marked_soon() -> None:
    angle = 2.0 * np.pi * np.arange(1000) / 1000
    border = {"polygon_mm": (38.0 * np.column_stack([np.cos(angle), np.sin(angle)])).tolist()}
    shape = held({"where": "border"})
    design = shape.summary["design"] | {"border": border}
    assert 8000 <= len(pin_marks(replace(shape, summary=shape.summary | {"design": design}))[0]) < 10_000
