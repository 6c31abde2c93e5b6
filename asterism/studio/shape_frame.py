"""A shape of either model as the view takes it: its mesh, and the arrays on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_array

from asterism.draw.ribbons import ribbons
from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.normals import sum_at_vertices, vertex_normals
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.layout import off_sheet_mm
from asterism.shape.cell_mean import CellMean
from asterism.shape.shape import Shape
from asterism.shape.surface_fields import surface_triangle_areas
from asterism.studio.messages import Frame, SheetPart, ShownMesh
from asterism.studio.sheet_marks import SheetMarks, mesh_message, ribbon_stations


def shape_messages(shape: Shape, number: int = 1, stage: str = "equilibrium") -> tuple[ShownMesh, Frame]:
    """The mesh of a shape under a number, and its frame; a free sheet stands as its `aligned()` copy, on the ground.

    Shapes from files without a design have no needles and no strains.
    """
    if not shape.held:
        shape = shape.aligned()
        shape = replace(shape, positions=shape.positions - [0.0, 0.0, shape.positions[:, 2].min()])
    positions, layout, small = shape.positions, shape.layout, np.float32
    part, strain = _sheet_part(shape), np.empty(0)
    arm_site: Ints = np.zeros(len(part.arms), dtype=np.int64)
    if layout is not None:
        arm_site = ribbon_stations(layout).site
        strain = _area_strain(shape)
    curvature = shape.point_fields.get("mean_curvature_per_mm", np.empty(0))
    frame = Frame(
        seq=0,
        mesh=number,
        stage=stage,
        positions=part.positions,
        curvature=_without_gaps(np.asarray(curvature, dtype=float), shape.triangles).astype(small),
        strain=strain.astype(small),
        arms=part.arms,
        arm_normals=part.arm_normals,
        needles=part.needles,
        is_minimum=bool(shape.summary.get("is_minimum", False)),
        height_mm=float(np.ptp(positions[:, 2])),
    )
    return mesh_message(number, shape.printed, shape.triangles, arm_site), frame


def settled_messages(
    exact: Shape, near: Shape | None, pose: tuple[Floats, Floats] | None, number: int, smooth: bool = False
) -> tuple[ShownMesh, Frame]:
    """The same of an exact shape beside the preview from which it was computed, in the pose of the sheet on the page.

    Parameters
    ----------
    pose : printed (V, 2) and shown (V, 3) places of that sheet, mm; by default that of `shape_messages`.
    smooth : with the sheet without its bumps.
    """
    mesh, frame = shape_messages(exact, number, "exact")
    if near is None:
        return mesh, replace(frame, smooth=_without_bumps(exact, frame.positions) if smooth else None)
    layout = exact.layout
    off = 0.0 if layout is None else off_sheet_mm(layout, len(near.printed))
    before, positions = near.at(exact.printed, off), exact.positions
    if pose is not None:
        rotation, shift = rigid_fit(near.at(pose[0], off), np.asarray(pose[1], dtype=float))
        before = before @ rotation.T + shift
    if not exact.held:
        rotation, shift = rigid_fit(positions, before, exact.weights)
        positions = positions @ rotation.T + shift
    moved = replace(exact, positions=positions)
    shown, other = _sheet_part(moved), _sheet_part(replace(exact, positions=before))
    parts = {name: getattr(shown, name) for name in ("positions", "arms", "arm_normals", "needles")}
    return mesh, replace(frame, before=other, smooth=_without_bumps(exact, positions) if smooth else None, **parts)


def _without_bumps(shape: Shape, positions: Floats) -> SheetPart | None:
    """The sheet at positions (V, 3), moved along its normal to the means over a cell of the lattice."""
    if shape.layout is None:
        return None
    positions = np.asarray(positions, dtype=float)
    mean = CellMean(shape.printed, shape.weights, shape.layout.lattice_vectors)(positions)
    normals = vertex_normals(mean, shape.triangles)
    bumps = np.sum(normals * (positions - mean), axis=1, keepdims=True)
    return _sheet_part(replace(shape, positions=positions - normals * bumps))


def _sheet_part(shape: Shape) -> SheetPart:
    """Places, arms and needles of a shape as they are."""
    layout, positions = shape.layout, shape.positions
    if layout is None:
        arms, arm_normals = _rod_ribbons(shape)
        needles = np.empty((0, 2, 3))
    else:
        marks = SheetMarks(shape.printed, shape.triangles)
        arms, arm_normals = marks.ribbons(layout, positions, vertex_normals(positions, shape.triangles))
        needles = marks.needles(layout, positions)
    return SheetPart(*(part.astype(np.float32) for part in (positions, arms, arm_normals, needles)))


def _rod_ribbons(shape: Shape) -> tuple[Floats, Floats]:
    """(R, 2, 3, 3) left and right upper edges and the middle on the fabric at both ends of each rod edge, normals."""
    points, normals, triangles = ribbons(shape)
    begin = triangles[: len(triangles) // 2, 0]
    ends = np.stack([begin, begin + 1], axis=1)
    left, right, normal = points[ends], points[ends + len(points) // 2], normals[ends]
    # shapes without a layout do not say how thick their arms are: these are drawn 1 mm thick
    return np.stack([left + normal, right + normal, (left + right) / 2], axis=2), normal


def _area_strain(shape: Shape) -> Floats:
    """(V,) area of the sheet, without the bumps of a preview, over that of the released sheet, minus 1."""
    stretch_x, stretch_y = np.broadcast_to(shape.summary["design"]["fabric"]["stretch"], 2).tolist()
    surface = shape.positions - shape.point_fields.get("bump_mm", 0.0)
    count = len(surface)
    areas = [
        sum_at_vertices(shape.triangles, np.repeat(surface_triangle_areas(points, shape.triangles), 3), count)
        for points in (surface, shape.printed)
    ]
    return np.asarray(areas[0] / areas[1] * stretch_x * stretch_y - 1.0)


def _without_gaps(values: Floats, triangles: Ints) -> Floats:
    """(V,) values; vertices without one, which are those on the border, have the mean of their neighbours."""
    if len(values) == 0:
        return values
    i, j = triangles[:, [0, 1, 2, 1, 2, 0]].ravel(), triangles[:, [1, 2, 0, 0, 1, 2]].ravel()
    is_known = np.isfinite(values)
    near = coo_array((np.ones(len(i)), (i, j)), shape=(len(values), len(values))).tocsr()
    total, count = near @ np.where(is_known, values, 0.0), near @ is_known.astype(float)
    return np.where(is_known, values, np.divide(total, count, out=np.zeros(len(values)), where=count > 0))
