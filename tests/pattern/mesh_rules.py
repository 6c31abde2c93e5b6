"""What holds for every mesh of a layout, whichever way it was made."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.planar import (
    distance_to_outline,
    distance_to_segment,
    polygon_area,
    triangle_angles,
    triangle_areas,
)
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh


def smallest_angle(mesh: Mesh) -> float:
    """Degrees."""
    return float(triangle_angles(mesh.points, mesh.triangles).min())


def edges_of(triangles: Ints) -> tuple[Ints, Ints]:
    """Edges (E, 2) with the smaller vertex first, and the number of triangles at each."""
    pairs = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(pairs, axis=1), axis=0, return_counts=True)


def obey(layout: Layout, mesh: Mesh) -> None:
    """Assert all of it."""
    points, triangles, border = mesh.points, mesh.triangles, mesh.border_vertices
    area = polygon_area(layout.outline)
    areas = triangle_areas(points, triangles)
    assert areas.min() > 0
    assert abs(areas.sum() - area) < 1e-8 * area
    assert np.array_equal(np.unique(triangles), np.arange(len(points))), "every point is used"
    assert len(cKDTree(points).query_pairs(1e-7)) == 0

    edges, count = edges_of(triangles)
    assert set(count) <= {1, 2}
    assert len(points) - len(edges) + len(triangles) == 1, "a disk"
    outer = {*map(tuple, edges[count == 1].tolist())}
    around = np.sort(np.column_stack([border, np.roll(border, -1)]), axis=1)
    assert outer == {*map(tuple, around.tolist())}, "the outline is the border"
    assert np.allclose(points[border[0]], layout.outline[0], atol=1e-9)
    assert polygon_area(points[border]) > 0
    assert distance_to_outline(points[border], layout.outline).max() < 1e-4
    assert cKDTree(points[border]).query(layout.outline)[0].max() < 1e-9, "corners are vertices"

    assert np.allclose(points[mesh.star_vertices], layout.centres, rtol=0, atol=1e-4)
    assert len(mesh.rods) == len(layout.arm_star)
    known = {*map(tuple, edges.tolist())}
    for arm, rod in enumerate(mesh.rods):
        assert rod[0] == mesh.star_vertices[layout.arm_star[arm]]
        assert np.allclose(points[rod[-1]], layout.arm_tip[arm], rtol=0, atol=1e-4)
        assert {*map(tuple, np.sort(np.column_stack([rod[:-1], rod[1:]]), axis=1).tolist())} <= known
        steps = np.linalg.norm(np.diff(points[rod], axis=0), axis=1)
        assert abs(steps.sum() - layout.arm_length[arm]) < 1e-4

    assert len(mesh.pin_vertices) == len(layout.pins)
    for pin, held in zip(layout.pins, mesh.pin_vertices, strict=True):
        assert np.allclose(points[held[: len(pin.points)]], pin.points, rtol=0, atol=1e-4)
        for edge in pin.edges:
            a, b = layout.outline[edge], layout.outline[(edge + 1) % len(layout.outline)]
            on = np.flatnonzero(distance_to_segment(points, a, b) < 1e-6)
            assert {*on.tolist()} <= {*held.tolist()}


def even_rods(mesh: Mesh, tolerance: float = 1e-9) -> bool:
    """Whether all segments of each arm are equally long."""
    return all(np.ptp(np.linalg.norm(np.diff(mesh.points[r], axis=0), axis=1)) < tolerance for r in mesh.rods)


def same_after(mesh: Mesh, image: Floats, tolerance: float = 1e-11) -> bool:
    """Whether moving the points to `image` (V, 2) gives the same mesh: places and triangles."""
    distance, partner = cKDTree(mesh.points).query(image)
    there = {*map(tuple, np.sort(partner[mesh.triangles], axis=1).tolist())}
    return bool(distance.max() < tolerance) and there == {*map(tuple, np.sort(mesh.triangles, axis=1).tolist())}
