"""The mesh of a layout: aligned with the lattice wherever that is possible, else constrained Delaunay."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import clusters, distance_to_outline, shown_place, triangle_angles
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.aligned_mesh import aligned_mesh
from asterism.pattern.mesh.graded_mesh import graded_mesh
from asterism.pattern.mesh.mesh import Mesh, check_edge, checked
from asterism.pattern.mesh.outline_points import (
    least_pieces,
    outline_points,
    pin_vertices,
    place_within,
    points_along,
    points_around,
)
from asterism.pattern.mesh.triangulate import triangulate

MeshKind = Literal["auto", "aligned", "delaunay"]


def mesh_layout(
    layout: Layout,
    edge_mm: float,
    kind: MeshKind = "auto",
    seed: int = 0,
    graded: bool | Literal["aligned"] = False,
    draft: bool = False,
) -> Mesh:
    """Mesh the sheet with edges of about `edge_mm`; "auto" prefers the aligned mesh (`seed` is the Delaunay one's).

    `graded`: finer at the arms and their tips, with as many triangles; "aligned" only where the mesh is aligned.
    `draft`: good enough to look at, and faster; triangles may be flatter where features or the outline are close.
    """
    if kind not in ("auto", "aligned", "delaunay"):
        raise MeshError(f"the mesh kind must be auto, aligned or delaunay, got {kind!r}")
    if kind == "aligned" and layout.drawn is not None:
        raise MeshError("mesh.kind = 'aligned': drawn rods have no aligned mesh; delaunay and auto mesh every sheet")
    if kind == "aligned" and layout.holes:
        raise MeshError("mesh.kind = 'aligned': sheets with holes have none; delaunay and auto mesh every sheet")
    mesh = _even_mesh(layout, edge_mm, kind, seed, draft)
    return graded_mesh(mesh, layout, edge_mm) if graded in (True, mesh.kind) else mesh


def _even_mesh(layout: Layout, edge_mm: float, kind: MeshKind, seed: int, draft: bool) -> Mesh:
    if kind != "delaunay" and layout.drawn is None and not layout.holes:
        try:
            return aligned_mesh(layout, edge_mm, draft)
        except MeshError as error:
            if kind == "aligned":
                raise MeshError(f"mesh.kind = 'aligned': {error}; delaunay and auto mesh every sheet") from None
    return delaunay_mesh(layout, edge_mm, seed, draft)


# arms and outline are split where they touch triangles with a smaller angle
POOR_ANGLE_DEG = 25.0
# drawings may have narrower places than stars, and are refused if their triangles stay flatter than this
MIN_DRAWN_ANGLE_DEG = 20.0


class _Frame(NamedTuple):
    """Lines of the mesh. Where rods run along the outline or a hole, the rods have the points."""

    outline: Floats  # (n, 2) mm, points along the outline
    step: Floats  # mm, length of the segments of rods, then of holes


def delaunay_mesh(layout: Layout, edge_mm: float, seed: int = 0, draft: bool = False) -> Mesh:
    """Triangles of about 30 degrees or more, with even segments along every rod and the outline.

    Parameters
    ----------
    edge_mm : wished length of an edge. Rods get at least two segments, more where they curve, and shorter ones where
        ends come close to other rods or to the outline.
    seed : another seed gives another mesh of the same quality, to see how much a result depends on the mesh.
    draft : segments beside flat triangles are not halved.
    """
    check_edge(layout, edge_mm)
    pins, tolerance = layout.pin_points, _tolerance(layout)
    length = np.array([rod.length for rod in layout.graph.rods])
    if (length <= tolerance).any():
        raise MeshError(f"arm {int(np.argmax(length <= tolerance))} has no length")
    least = np.array([least_pieces(rod) for rod in layout.graph.rods])
    if layout.drawn is not None:  # a short piece between two nodes is one edge
        least[length < 0.5 * edge_mm] = 1.0
    step = length / np.maximum(np.rint(length / edge_mm), least)
    on_outline = outline_points(layout.outline, edge_mm, pins, tolerance, np.zeros((0, 2)))
    frame = _Frame(on_outline, np.append(step, np.full(len(layout.holes), edge_mm)))
    best, best_angle = None, -1.0
    # drawings may have narrower places than stars
    splits = 3 if layout.drawn is None else 6
    for _ in range(1 if draft else splits + 1):
        mesh = _mesh(layout, frame, pins, edge_mm, seed)
        angles = triangle_angles(mesh.points, mesh.triangles).min(axis=1)
        if angles.min() > best_angle:
            best, best_angle = mesh, float(angles.min())
        if best_angle >= POOR_ANGLE_DEG:
            break
        poor = np.zeros(len(mesh.points), dtype=bool)
        poor[mesh.triangles[angles < POOR_ANGLE_DEG]] = True
        frame = _split(layout, frame, mesh, poor, edge_mm / 6)
    assert best is not None
    if layout.drawn is not None and not draft and best_angle < MIN_DRAWN_ANGLE_DEG:
        flattest = best.triangles[triangle_angles(best.points, best.triangles).min(axis=1).argmin()]
        at = shown_place(best.points[flattest].mean(axis=0))
        close = f"lines are too close together at {at} for triangles of {MIN_DRAWN_ANGLE_DEG:g} deg"
        raise MeshError(f"rods: {close}: move them apart, or use a shorter mesh.edge_mm")
    return checked(best, layout, 0.0)


def _mesh(layout: Layout, frame: _Frame, pins: Floats, edge_mm: float, seed: int) -> Mesh:
    """The mesh of a frame."""
    is_star = layout.drawn is None
    # ends of other arms that touch an arm are points of it; drawn rods are cut where they meet
    stops = np.concatenate([layout.centres, layout.arm_tip, pins]) if is_star else pins
    steps = iter(frame.step)
    lines = [points_along(rod, next(steps), stops, _tolerance(layout), is_star) for rod in layout.graph.rods]
    outline = np.concatenate([lines[rod][:-1] for rod in layout.rim]) if layout.rim else frame.outline
    edges = [
        np.concatenate([lines[rod][:-1] for rod in rim]) if rim else points_around(hole, step, pins, _tolerance(layout))
        for hole, rim, step in zip(layout.holes, layout.hole_rims, steps, strict=True)
    ]
    parts = [layout.centres, outline, *edges, *lines, pins]
    vertex, points = clusters(np.concatenate(parts), _tolerance(layout))
    chains = np.split(vertex, np.cumsum([len(part) for part in parts])[:-1])
    stars, border, holes, rods = chains[0], chains[1], chains[2 : 2 + len(edges)], chains[2 + len(edges) : -1]
    around = [hole for hole, rim in zip(holes, layout.hole_rims, strict=True) if not rim]
    off_rim = [np.column_stack([r[:-1], r[1:]]) for k, r in enumerate(rods) if k not in layout.rim]
    segments = np.concatenate([*(np.column_stack([ring, np.roll(ring, -1)]) for ring in (border, *around)), *off_rim])
    points = np.concatenate([points, _scattered(layout, points, edge_mm, seed)])
    # refinement leaves a mean area of 0.6 of the largest one, that of an equilateral triangle
    points, triangles = triangulate(
        points,
        segments,
        min_angle_deg=30.0,
        max_area=0.7 * edge_mm**2,
        holes=[place_within(points[hole]) for hole in holes],
    )
    held = pin_vertices(layout, points, np.concatenate([border, *holes]))
    return Mesh(points, triangles, tuple(rods), stars, border, held, "delaunay", tuple(holes))


def _split(layout: Layout, frame: _Frame, mesh: Mesh, poor: NDArray[np.bool_], shortest: float) -> _Frame:
    """Halve the segments of the rods and of the stretches of border that touch poor vertices."""
    touched = np.array([poor[line].any() for line in (*mesh.rods, *mesh.hole_vertices)], dtype=bool)
    step = np.where(touched & (frame.step > 2 * shortest), frame.step / 2, frame.step)
    if layout.rim:
        return _Frame(frame.outline, step)
    start, end = frame.outline, np.roll(frame.outline, -1, axis=0)
    at = mesh.border_vertices
    halve = (poor[at] | poor[np.roll(at, -1)]) & (np.linalg.norm(end - start, axis=1) > 2 * shortest)
    return _Frame(np.insert(frame.outline, np.flatnonzero(halve) + 1, (start + end)[halve] / 2, axis=0), step)


def _scattered(layout: Layout, points: Floats, edge_mm: float, seed: int) -> Floats:
    """A few random points inside, one edge away from all others; they make each seed's mesh different."""
    rng = np.random.default_rng(seed)
    low, high = layout.outline.min(axis=0), layout.outline.max(axis=0)
    scattered = low + (high - low) * rng.random((max(len(layout.centres), 8), 2))
    clear = cKDTree(points).query(scattered)[0] > 1.5 * edge_mm
    clear &= layout.is_on_sheet(scattered)
    for ring in layout.edges.rings:
        clear &= distance_to_outline(scattered, ring) > edge_mm
    scattered = scattered[clear]
    close = cKDTree(scattered).query_pairs(edge_mm, output_type="ndarray")
    return np.delete(scattered, np.unique(close[:, 1]), axis=0)


def _tolerance(layout: Layout) -> float:
    """Places closer than this, in mm, are one vertex."""
    return 1e-6 * layout.spacing_mm
