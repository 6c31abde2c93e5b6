"""The constrained Delaunay mesh: any outline, arms in any direction, refined where features are close together."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from pattern.design.errors import MeshError
from pattern.geometry.arrays import Floats, Ints
from pattern.geometry.planar import distance_to_outline, distance_to_segment, inside, triangle_angles
from pattern.layout.layout import Layout
from pattern.mesh.check import check_edge, checked
from pattern.mesh.free.triangulate import triangulate
from pattern.mesh.mesh import Mesh
from pattern.mesh.outline_points import outline_points
from pattern.mesh.pin_vertices import pin_vertices, pins_on_sheet

REFINEMENT_ANGLE_DEG = 30.0
# arms and outline are split where they touch triangles with a smaller angle
POOR_ANGLE_DEG = 25.0
MAX_SPLITS = 3
# in units of the edge squared: refinement leaves a mean area of 0.6 of it, that of an equilateral triangle
MAX_AREA_EDGES_SQUARED = 0.7
# edges along arms of a graded mesh, over those far from them; quality makes all sizes between
ARM_EDGE_FACTOR = 0.2
# points closer than this part of the lattice distance are one vertex
MERGE_DISTANCE_SPACINGS = 1e-6


@dataclass(frozen=True)
class _Frame:
    """Lines of the mesh: points (n, 2) mm along the outline, and the length (mm) of each arm's segments."""

    outline: Floats
    step: Floats


def delaunay_mesh(
    layout: Layout, edge_mm: float, seed: int = 0, graded: bool = False, splits: int = MAX_SPLITS
) -> Mesh:
    """Triangles of about 30 degrees or more, with even segments along every arm and the outline.

    Parameters
    ----------
    edge_mm : wished length of an edge. Arms get at least two segments, and shorter ones where tips come close to
        other arms or to the outline.
    seed : another seed gives another mesh of the same quality, to see how much a result depends on the mesh.
    graded : arms get edges of a fifth of the length, so that the triangles beside them are small.
    splits : how often segments beside flat triangles are halved at most.
    """
    check_edge(layout, edge_mm)
    pins, tolerance = pins_on_sheet(layout), _tolerance(layout)
    length = layout.arm_length
    frame = _Frame(
        outline_points(
            layout.outline, edge_mm, np.concatenate([layout.arm_tip, layout.centres, pins]), tolerance, np.zeros((0, 2))
        ),
        length / np.maximum(np.rint(length / (ARM_EDGE_FACTOR * edge_mm if graded else edge_mm)), 2),
    )
    best, best_angle = None, -1.0
    for _ in range(splits + 1):
        mesh = _mesh(layout, frame, pins, edge_mm, seed)
        angles = triangle_angles(mesh.points, mesh.triangles).min(axis=1)
        if angles.min() > best_angle:
            best, best_angle = mesh, float(angles.min())
        if best_angle >= POOR_ANGLE_DEG:
            break
        poor = np.zeros(len(mesh.points), dtype=bool)
        poor[mesh.triangles[angles < POOR_ANGLE_DEG]] = True
        frame = _split(frame, mesh, poor, edge_mm / 6)
    assert best is not None
    return checked(best, layout, 0.0)


def _mesh(layout: Layout, frame: _Frame, pins: Floats, edge_mm: float, seed: int) -> Mesh:
    """The mesh of a frame."""
    arms = [_arm_points(layout, arm, step, pins) for arm, step in enumerate(frame.step)]
    parts = [layout.centres, frame.outline, *arms, pins]
    points, vertex = _merged(np.concatenate(parts), _tolerance(layout))
    chains = np.split(vertex, np.cumsum([len(part) for part in parts])[:-1])
    stars, border, rods = chains[0], chains[1], chains[2:-1]
    segments = np.concatenate(
        [np.column_stack([border, np.roll(border, -1)]), *(np.column_stack([r[:-1], r[1:]]) for r in rods)]
    )
    points = np.concatenate([points, _scattered(layout, points, edge_mm, seed)])
    points, triangles = triangulate(
        points, segments, min_angle_deg=REFINEMENT_ANGLE_DEG, max_area=MAX_AREA_EDGES_SQUARED * edge_mm**2
    )
    return Mesh(points, triangles, tuple(rods), stars, border, pin_vertices(layout, points, border), "delaunay")


def _arm_points(layout: Layout, arm: int, step: float, pins: Floats) -> Floats:
    """Points (n, 2) along an arm, even between its ends, the pins on it and other arms' ends that touch it."""
    centre, tip = layout.centres[layout.arm_star[arm]], layout.arm_tip[arm]
    length = float(np.linalg.norm(tip - centre))
    tolerance = _tolerance(layout)
    if length <= tolerance:
        raise MeshError(f"arm {arm} has no length")
    others = np.concatenate([layout.centres, layout.arm_tip, pins])
    others = others[distance_to_segment(others, centre, tip) <= tolerance]
    along = (others - centre) @ (tip - centre) / length
    between = others[(along > tolerance) & (along < length - tolerance)]
    stops = np.concatenate([centre[None], between[np.argsort(between @ (tip - centre))], tip[None]])
    stops, _ = _merged(stops, tolerance)
    pieces = [
        np.linspace(a, b, max(round(float(np.linalg.norm(b - a)) / step), 1) + 1)[:-1] for a, b in pairwise(stops)
    ]
    return np.concatenate([*pieces, tip[None]])


def _split(frame: _Frame, mesh: Mesh, poor: NDArray[np.bool_], shortest: float) -> _Frame:
    """Halve the segments of the arms and of the stretches of border that touch poor vertices."""
    arms = np.array([poor[rod].any() for rod in mesh.rods], dtype=bool)
    start, end = frame.outline, np.roll(frame.outline, -1, axis=0)
    at = mesh.border_vertices
    halve = (poor[at] | poor[np.roll(at, -1)]) & (np.linalg.norm(end - start, axis=1) > 2 * shortest)
    outline = np.insert(frame.outline, np.flatnonzero(halve) + 1, (start + end)[halve] / 2, axis=0)
    return replace(
        frame, outline=outline, step=np.where(arms & (frame.step > 2 * shortest), frame.step / 2, frame.step)
    )


def _merged(points: Floats, tolerance: float) -> tuple[Floats, Ints]:
    """The distinct points in their order, and for each point given its number among them."""
    pairs = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    n = len(points)
    label = connected_components(coo_array((np.ones(len(pairs)), pairs.T), shape=(n, n)), directed=False)[1]
    _, first, group = np.unique(label, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return points[first[order]], np.argsort(order)[group]


def _scattered(layout: Layout, points: Floats, edge_mm: float, seed: int) -> Floats:
    """A few random points inside, one edge away from all others; they make each seed's mesh different."""
    rng = np.random.default_rng(seed)
    low, high = layout.outline.min(axis=0), layout.outline.max(axis=0)
    scattered = low + (high - low) * rng.random((max(len(layout.centres), 8), 2))
    clear = cKDTree(points).query(scattered)[0] > 1.5 * edge_mm
    clear &= inside(scattered, layout.outline) & (distance_to_outline(scattered, layout.outline) > edge_mm)
    scattered = scattered[clear]
    close = cKDTree(scattered).query_pairs(edge_mm, output_type="ndarray")
    return np.delete(scattered, np.unique(close[:, 1]), axis=0)


def _tolerance(layout: Layout) -> float:
    """Places closer than this, in mm, are one vertex."""
    return MERGE_DISTANCE_SPACINGS * layout.spacing_mm
