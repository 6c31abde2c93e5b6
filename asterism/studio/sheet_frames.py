"""A sheet as the page draws it: its mesh, ribbons along arms and rods, needles, and the frame of a shape."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from asterism.draw.scene import ribbons
from asterism.equilibrium.arrays import Array, Floats, Ints
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.normals import sum_at_vertices, vertex_normals
from asterism.pattern.geometry.point_location import TriangleFinder, clipped
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.shape.measures import CellMean
from asterism.shape.shape import Shape, blank_sheet
from asterism.shape.surface import border_edges, surface_triangle_areas
from asterism.studio.messages import Frame

STATIONS = 5  # along each ribbon
# length of a ribbon along a drawn rod, so that curves look smooth; longer where there would be too many ribbons
RIBBON_MM = 5.0
# thickness of the fabric as the page draws it below the sheet's places: plastic below hangs at its lower face
FABRIC_MM = 0.8
NO_SITE = 2**32 - 1  # in place of the row of a star, for ribbons of drawn rods


class SheetMarks:
    """Ribbons and needles of a sheet on a mesh of points (V, 2) mm and triangles (T, 3).

    Places on the mesh are kept until ribbons or needles change.
    """

    def __init__(self, printed: Floats, triangles: Ints) -> None:
        self.printed, self.triangles = printed, triangles
        self._ribbons_of: Layout | None = None
        self._ribbon_points = np.empty((0, STATIONS, 2))
        self._station_triangles: Ints = np.empty(0, dtype=np.int64)
        self._needle_points = np.empty((0, 2))

    def arrays(self, layout: Layout, positions: Floats, name: str = "") -> dict[str, Array]:
        """The arrays of a `Frame` for the sheet at positions (V, 3) mm; see `sheet_arrays`."""
        ribbons = self.ribbons(layout, positions, vertex_normals(positions, self.triangles))
        return sheet_arrays(name, positions, *ribbons, self.needles(layout, positions))

    def mesh_arrays(self, layout: Layout) -> dict[str, Array]:
        """The arrays of this mesh for a `Frame` of a layout."""
        return mesh_arrays(self.printed, self.triangles, self.stations(layout).site)

    def stations(self, layout: Layout) -> RibbonStations:
        """The stations of a layout."""
        if layout is not self._ribbons_of:
            self._ribbons_of, self._ribbons = layout, ribbon_stations(layout)
        return self._ribbons

    def ribbons(self, layout: Layout, positions: Floats, normals: Floats) -> tuple[Floats, Floats]:
        """(A, K, 3, 3) left and right outer edges of the ribbons and their middle on the fabric, (A, K, 3) normals."""
        ribbons = self.stations(layout)
        if not np.array_equal(ribbons.points, self._ribbon_points) or not len(ribbons.points):
            points = ribbons.points.reshape(-1, 2)
            known = self._station_triangles if len(self._station_triangles) == len(points) else None
            self._stations, self._station_triangles = self._interpolation(points, known)
            self._ribbon_points = ribbons.points
        shape = *ribbons.width.shape, 3
        middle = (self._stations @ positions).reshape(shape)
        normal = ribbons.side[:, None, None] * _unit((self._stations @ normals).reshape(shape))
        middle += (ribbons.side < 0)[:, None, None] * FABRIC_MM * normal
        across = _unit(np.cross(normal, np.gradient(middle, axis=1)))
        top, half = middle + ribbons.thickness[..., None] * normal, 0.5 * ribbons.width[..., None] * across
        return np.stack([top + half, top - half, middle], axis=2), normal

    def needles(self, layout: Layout, positions: Floats) -> Floats:
        """(N, 2, 3) needles: foot on the ground and tip in the sheet, along supported edges one in each spacing.

        A tube holds edges shorter than the spacing, such as the pieces of a curve: after the needles come both ends of
        each.
        """
        start, end = (ends[layout.supported_edges] for ends in (layout.edges.start, layout.edges.end))
        counts = (np.linalg.norm(end - start, axis=1) / layout.spacing_mm).astype(int)
        printed = [layout.pin_points]
        for a, b, count in zip(start, end, counts.tolist(), strict=True):
            printed.append(a + np.arange(count)[:, None] / max(count, 1) * (b - a))
        count, is_piece = sum(map(len, printed)), counts == 0
        points = np.concatenate([*printed, start[is_piece], end[is_piece]])
        if not len(points):
            return np.empty((0, 2, 3))
        if not np.array_equal(points, self._needle_points):
            self._needle_points, (self._in_needles, _) = points, self._interpolation(points)
        tips = self._in_needles @ positions
        feet = tips[:count].copy()
        feet[:, 2] = min(0.0, float(tips[:, 2].min()))
        pieces = tips[count:].reshape(2, -1, 3).swapaxes(0, 1)
        return np.concatenate([np.stack([feet, tips[:count]], axis=1), pieces])

    def _interpolation(self, points: Floats, known: Ints | None = None) -> tuple[sp.csr_matrix, Ints]:
        """(n, V) linear interpolation from the vertices to printed points (n, 2), and their triangles (n,).

        The points are in the triangles `known` (n,), if these are given, but for a few.
        """
        tried = 8  # triangles for a point: those of a shown mesh are well shaped
        if known is None:
            triangle, weights = self._finder.nearest(points, tried)
        else:
            triangle, weights = self._finder.near_before(points, known, tried)
        corners, ends = self.triangles[triangle], np.arange(0, 3 * len(points) + 1, 3)
        shape = len(points), len(self.printed)
        return sp.csr_matrix((clipped(weights).ravel(), corners.ravel(), ends), shape), triangle

    @cached_property
    def _finder(self) -> TriangleFinder:
        return TriangleFinder(self.printed, self.triangles)


def sheet_arrays(name: str, positions: Floats, arms: Floats, arm_normals: Floats, needles: Floats) -> dict[str, Array]:
    """The arrays of a `Frame` for one sheet, in numbers of 4 bytes.

    Parameters
    ----------
    name : empty for the sheet itself; `smooth` or `before` for another one beside it.
    """
    arrays = {"positions": positions, "arms": arms, "arm_normals": arm_normals, "needles": needles}
    if name:
        arrays = {name if key == "positions" else f"{name}_{key}": values for key, values in arrays.items()}
    return {key: values.astype(np.float32) for key, values in arrays.items()}


def smooth_arrays(curvature: Floats, strain: Floats) -> dict[str, Array]:
    """The arrays of a `Frame` for values (V,) of the smooth surface."""
    return {"curvature": curvature.astype(np.float32), "strain": strain.astype(np.float32)}


def _unit(vectors: Floats) -> Floats:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(length == 0.0, 1.0, length))


@dataclass(frozen=True)
class RibbonStations:
    """Stations along all ribbons, in printed coordinates.

    Attributes
    ----------
    points : (A, K, 2) mm, of the middle lines.
    width, thickness : (A, K) mm.
    site : (A,) row of the star's site in the plan; `NO_SITE` for drawn rods.
    side : (A,) 1 above the fabric, -1 below.
    """

    points: Floats
    width: Floats
    thickness: Floats
    site: Ints
    side: Ints


def ribbon_stations(layout: Layout) -> RibbonStations:
    """The stations of a layout: arms from the centre to the tip, then drawn rods in pieces of about `RIBBON_MM`."""
    share = np.linspace(0.0, 1.0, STATIONS)
    start = layout.centres[layout.arm_star][:, None]
    points = [start + share[:, None] * (layout.arm_tip[:, None] - start)]
    width, thickness = ([ends[:, :1] + share * np.diff(ends)] for ends in (layout.arm_width, layout.arm_thickness))
    longest = max(RIBBON_MM, sum(rod.length for rod in layout.drawn_rods) / 6000)
    for rod in layout.drawn_rods:
        count = int(np.ceil(rod.length / longest))
        part = ((np.arange(count)[:, None] + share) / count).ravel()
        points.append(rod.at(rod.points, part).reshape(count, STATIONS, 2))
        width.append(rod.at(rod.width, part).reshape(count, STATIONS))
        thickness.append(rod.at(rod.thickness, part).reshape(count, STATIONS))
    site = np.full(sum(len(part) for part in points), NO_SITE)
    site[: len(layout.arm_star)] = layout.star_number[layout.arm_star]
    side = np.repeat(layout.rod_side, [1] * len(layout.arm_star) + [len(part) for part in points[1:]])
    return RibbonStations(np.concatenate(points), np.concatenate(width), np.concatenate(thickness), site, side)


def mesh_arrays(printed: Floats, triangles: Ints, arm_site: Ints) -> dict[str, Array]:
    """The arrays of a mesh: points (V, 2) mm, triangles (T, 3), and the row of the site of each ribbon (A,)."""
    whole = {"triangles": triangles, "outline": border_edges(triangles), "arm_site": arm_site}
    return {"printed": printed.astype(np.float32), **{name: part.astype(np.uint32) for name, part in whole.items()}}


def shape_frame(shape: Shape, stage: str = "equilibrium") -> Frame:
    """A shape on its mesh; a free sheet stands as its `aligned()` copy, on the ground.

    Shapes from files without a design have no needles and no strains.
    """
    if not shape.held:
        shape = shape.aligned()
        shape = replace(shape, positions=shape.positions - [0.0, 0.0, shape.positions[:, 2].min()])
    arrays, strain = _shape_arrays(shape), np.empty(0)
    arm_site: Ints = np.zeros(len(arrays["arms"]), dtype=np.int64)
    if shape.layout is not None:
        arm_site = ribbon_stations(shape.layout).site
        strain = _area_strain(shape)
    curvature = np.asarray(shape.point_fields.get("mean_curvature_per_mm", np.empty(0)), dtype=float)
    return Frame(
        0,
        stage,
        arrays | smooth_arrays(_without_gaps(curvature, shape.triangles), strain),
        mesh_arrays(shape.printed, shape.triangles, arm_site),
        is_minimum=bool(shape.summary.get("is_minimum", False)),
        height_mm=float(np.ptp(shape.positions[:, 2])),
    )


def exact_frame(exact: Shape, near: Shape | None, pose: tuple[Floats, Floats] | None, smooth: bool = False) -> Frame:
    """The same of an exact shape beside the preview from which it was computed, in the pose of the sheet on the page.

    Parameters
    ----------
    pose : printed (V, 2) and shown (V, 3) places of that sheet, mm; by default that of `shape_frame`.
    smooth : with the sheet without its bumps.
    """
    frame = shape_frame(exact, "exact")
    positions, arrays = np.asarray(frame.arrays["positions"], dtype=float), dict(frame.arrays)
    if near is not None:
        before, positions = near.at_edges(exact.printed), exact.positions
        if pose is not None:
            rotation, shift = rigid_fit(near.at_edges(pose[0]), np.asarray(pose[1], dtype=float))
            before = before @ rotation.T + shift
        if not exact.held:
            rotation, shift = rigid_fit(positions, before, exact.weights)
            positions = positions @ rotation.T + shift
        for name, places in (("", positions), ("before", before)):
            arrays |= _shape_arrays(replace(exact, positions=places), name)
    if smooth and exact.layout is not None:
        arrays |= _shape_arrays(_without_bumps(exact, exact.layout, positions), "smooth")
    return replace(frame, arrays=arrays)


def _without_bumps(shape: Shape, layout: Layout, positions: Floats) -> Shape:
    """The sheet at positions (V, 3), moved along its normal to the means over a cell of the lattice."""
    mean = CellMean(shape.printed, shape.weights, layout.lattice_vectors)(positions)
    normals = vertex_normals(mean, shape.triangles)
    bumps = np.sum(normals * (positions - mean), axis=1, keepdims=True)
    return replace(shape, positions=positions - normals * bumps)


def _shape_arrays(shape: Shape, name: str = "") -> dict[str, Array]:
    """Places, arms and needles of a shape as they are."""
    if shape.layout is None:
        return sheet_arrays(name, shape.positions, *_rod_ribbons(shape), np.empty((0, 2, 3)))
    return SheetMarks(shape.printed, shape.triangles).arrays(shape.layout, shape.positions, name)


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
    near = sp.coo_array((np.ones(len(i)), (i, j)), shape=(len(values), len(values))).tocsr()
    total, count = near @ np.where(is_known, values, 0.0), near @ is_known.astype(float)
    return np.where(is_known, values, np.divide(total, count, out=np.zeros(len(values)), where=count > 0))


def blank_frame(design: Design, seq: int) -> Frame:
    """The flat, released sheet of a design without stars."""
    shape = blank_sheet(design)
    zero, none = np.zeros(len(shape.positions)), np.empty((0, STATIONS, 3, 3))
    arrays = sheet_arrays("", shape.positions, none, none[:, :, 0], np.empty((0, 2, 3))) | smooth_arrays(zero, zero)
    mesh = mesh_arrays(shape.printed, shape.triangles, np.empty(0, dtype=np.int64))
    return Frame(seq, "exact", arrays, mesh, is_minimum=True)


def printed_frame(design: Design, seq: int) -> Frame:
    """The flat sheet as it is printed, with its rods and without needles."""
    plan = layout(design)
    edge = 0.05 * plan.diameter_mm  # of the triangles
    mesh = mesh_layout(plan, edge, design.mesh.kind, design.mesh.seed, draft=True)
    marks, zero = SheetMarks(mesh.points, mesh.triangles), np.zeros(len(mesh.points))
    arrays = marks.arrays(plan, np.pad(mesh.points, ((0, 0), (0, 1)))) | smooth_arrays(zero, zero)
    arrays["needles"] = arrays["needles"][:0]
    return Frame(seq, "printed", arrays, marks.mesh_arrays(plan), is_minimum=True)
