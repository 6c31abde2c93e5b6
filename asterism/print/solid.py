"""The plastic of arms and drawn rods: pieces of one height, their terraces, and watertight solids on z = 0."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.layout.layout import Layout
from asterism.pattern.rods.graph import Rod

# corners lie on this grid, which single precision (as in STL) resolves
GRID_MM = 1e-3


@dataclass(frozen=True)
class Solid:
    """A closed surface."""

    name: str  # name in slicers
    points: Floats  # (n, 3) mm
    triangles: Ints  # (m, 3), counterclockwise from outside

    @property
    def volume_mm3(self) -> float:
        """Enclosed volume, by the divergence theorem."""
        a, b, c = (self.points[self.triangles[:, k]] for k in range(3))
        return float(np.einsum("ni,ni->", a, np.cross(b, c))) / 6

    @property
    def box(self) -> Floats:
        """(2, 3) mm, lowest and highest corner."""
        return np.array([self.points.min(axis=0), self.points.max(axis=0)])


@dataclass(frozen=True)
class Terrace:
    """A region of the plane, filled from z = 0 to a height."""

    height_mm: float  # height of the top
    region: BaseGeometry  # polygons, mm

    def stretched(self, factors: tuple[float, float]) -> Terrace:
        """The terrace with its coordinates times factors along x and y."""
        return Terrace(self.height_mm, shapely.transform(self.region, lambda points: points * factors))


def nested_terraces(regions: Sequence[tuple[float, BaseGeometry]]) -> tuple[Terrace, ...]:
    """One terrace for each height from regions (height, polygon) that may overlap; the lowest and widest first.

    A terrace covers all regions that are at least as high, so that terraces are nested. All terraces are unions of the
    faces of one subdivision of the plane: terraces that share a wall share its corners. A square of a few micrometres
    joins parts that touch in a point, because each edge of a solid has two faces.
    """
    heights = np.array([round(height, 6) for height, _ in regions])
    shapes = shapely.set_precision([region for _, region in regions], GRID_MM)
    # rounds of joining parts, which may bring other corners together
    for _ in range(5):
        steps = _subdivided(heights, shapes)
        touching = [(step.height_mm, _touching_points(step.region)) for step in steps]
        if not any(len(points) for _, points in touching):
            break
        for height, points in touching:
            bridges = shapely.box(*(points - 2 * GRID_MM).T, *(points + 2 * GRID_MM).T)
            heights = np.concatenate([heights, np.full(len(points), height)])
            shapes = np.concatenate([shapes, shapely.set_precision(bridges, GRID_MM)])
    return steps


def _subdivided(heights: Floats, shapes: np.ndarray) -> tuple[Terrace, ...]:
    faces, top = _faces(shapely.union_all(shapely.boundary(shapes), grid_size=GRID_MM), heights, shapes)
    levels = np.unique(top)
    return tuple(Terrace(float(level), shapely.coverage_union_all(faces[top >= level])) for level in levels)


def _faces(lines: BaseGeometry, heights: Floats, shapes: np.ndarray) -> tuple[np.ndarray, Floats]:
    """Faces of the subdivision by all boundaries that lie in a region, and the largest height over each."""
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(lines)))
    face, shape = shapely.STRtree(shapes).query(shapely.point_on_surface(faces), predicate="intersects")
    top = np.zeros(len(faces))
    np.maximum.at(top, face, heights[shape])
    return faces[top > 0], top[top > 0]


def _touching_points(region: BaseGeometry) -> Floats:
    """(n, 2) mm, corners at which parts of a region, or its holes, touch."""
    rings = shapely.get_rings(shapely.get_parts(region))
    corners = [shapely.get_coordinates(ring)[:-1] for ring in rings]
    points, count = np.unique(np.concatenate([np.empty((0, 2)), *corners]), axis=0, return_counts=True)
    return np.asarray(points[count > 1])


def terraced_solid(name: str, steps: Sequence[Terrace]) -> Solid:
    """The solid under nested terraces.

    Each corner of the plane has points at the heights of all its faces. Walls and roofs use these points only, so that
    they fit together.

    Raises ValueError: the regions are empty.
    """
    heights = np.array([step.height_mm for step in steps])
    # terraces may have been turned off the grid; their common corners must stay equal
    regions = np.array([step.region for step in steps], dtype=object)
    faces, top = _faces(shapely.union_all(shapely.boundary(regions)), heights, regions)
    if not len(faces):
        raise ValueError(f"{name} has no area")
    pieces, face = shapely.get_parts(shapely.constrained_delaunay_triangles(faces), return_index=True)
    plane = shapely.get_coordinates(shapely.orient_polygons(pieces)).reshape(-1, 4, 2)[:, :3]
    roofs = np.dstack([plane, np.broadcast_to(top[face][:, None], plane.shape[:2])])
    ground = np.dstack([plane, np.zeros(plane.shape[:2])])[:, ::-1]
    corners = np.concatenate([roofs, ground, _walls(shapely.orient_polygons(faces), top)])
    points, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return Solid(name, points, index.reshape(-1, 3))


def _walls(faces: np.ndarray, top: Floats) -> Floats:
    """(n, 3, 3) mm, triangles of the walls between faces of different heights, and of the outer walls."""
    rings, face = shapely.get_rings(faces, return_index=True)
    coordinates, ring = shapely.get_coordinates(rings, return_index=True)
    corners, corner = np.unique(coordinates, axis=0, return_inverse=True)
    along = ring[:-1] == ring[1:]
    begin, end = corner.reshape(-1)[:-1][along], corner.reshape(-1)[1:][along]
    height = top[face[ring[:-1][along]]]
    # a face lies to the left of its edges; beyond an edge without an opposite edge the height is 0
    other = dict(zip(zip(end.tolist(), begin.tolist(), strict=True), height.tolist(), strict=True))
    walls, levels = [], [{0.0} for _ in corners]
    for a, b, high in zip(begin.tolist(), end.tolist(), height.tolist(), strict=True):
        levels[a].add(high)
        low = other.get((a, b), 0.0)
        if low < high:
            walls.append((a, b, low, high))
    triangles = []
    for a, b, low, high in walls:
        left, right = (sorted(z for z in levels[k] if low <= z <= high) for k in (a, b))
        i = j = 0
        while i + 1 < len(left) or j + 1 < len(right):
            triangle = [(*corners[a], left[i]), (*corners[b], right[j])]
            if i + 1 < len(left) and (j + 1 == len(right) or left[i + 1] <= right[j + 1]):
                i += 1
                triangle.append((*corners[a], left[i]))
            else:
                j += 1
                triangle.append((*corners[b], right[j]))
            triangles.append(triangle)
    return np.array(triangles)


@dataclass(frozen=True)
class Piece:
    """A part of a rod with one height: an arm, from the centre of its star outwards, or a drawn rod."""

    number: int  # of the rod in the layout's graph
    points: Floats  # (n, 2) mm, polyline of the middle line
    width: Floats  # (n,) mm at the points, linear between them
    height_mm: float  # printed height
    round_ends: tuple[bool, bool]  # whether the beginning and the end are round, because the rod meets others there
    side: int = 1  # face of the fabric that carries it: 1 above, -1 below

    @property
    def region(self) -> BaseGeometry:
        """The printed area in printed coordinates, mm: a strip of this width with round corners."""
        return shapely.union_all(self.parts)

    @property
    def parts(self) -> list[BaseGeometry]:
        """A quadrilateral for each straight part of the middle line, then the discs at its round points."""
        along = np.diff(self.points, axis=0)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        aside = np.column_stack([-along[:, 1], along[:, 0]])
        begin, end = (0.5 * width[:, None] * aside for width in (self.width[:-1], self.width[1:]))
        a, b = self.points[:-1], self.points[1:]
        corners = np.stack([a - begin, b - end, b + end, a + begin], axis=1)
        is_round = np.ones(len(self.points), dtype=bool)
        is_round[[0, -1]] = self.round_ends
        discs = shapely.buffer(shapely.points(self.points[is_round]), self.width[is_round] / 2, quad_segs=8)
        return [*shapely.polygons(corners), *discs]


def pieces(plan: Layout, rounding: Rounding) -> tuple[list[Piece], list[Piece]]:
    """The pieces of all arms and of all drawn rods, rod by rod from start to end.

    A rod of varying thickness is printed in steps of one layer. An arm is round at the centre of its star, where arms
    that the border cuts away leave a gap, and has a straight end.
    """
    degree = [len(ends) for ends in plan.graph.ends_at]
    arms, drawn = list[Piece](), list[Piece]()
    for number, rod in enumerate(plan.graph.rods):
        if number < len(plan.arm_star):
            arms += _pieces(number, rod, rounding, (True, False))
        else:
            drawn += _pieces(number, rod, rounding, (degree[rod.start] > 1, degree[rod.end] > 1))
    return arms, drawn


def height_steps(thickness: Floats, rounding: Rounding) -> tuple[Floats, Floats]:
    """Heights along a straight part of a rod, each with its begin and end as fractions of its length."""
    first, last = (float(h) for h in thickness)
    if first == last:
        return np.array([first]), np.array([0.0, 1.0])
    low, high = np.sort(rounding.layers(thickness))
    # a layer begins halfway between two heights; the height of a cut tip may lie between layers
    layers = np.arange(np.floor(low), np.ceil(high)) + 0.5
    changes = (rounding.height(layers) - first) / (last - first)
    ends = np.unique(np.clip([0.0, *changes, 1.0], 0.0, 1.0))
    middles = (ends[:-1] + ends[1:]) / 2
    return rounding.thickness(first + middles * (last - first)), ends


def _pieces(number: int, rod: Rod, rounding: Rounding, round_ends: tuple[bool, bool]) -> Iterator[Piece]:
    heights: list[float] = []
    runs: list[list[float]] = []
    known = rod.arc_lengths / rod.length
    for k in range(len(known) - 1):
        step_heights, ends = height_steps(rod.thickness[k : k + 2], rounding)
        places = known[k] + ends * (known[k + 1] - known[k])
        for height, begin, end in zip(step_heights, places, places[1:], strict=False):
            if heights and heights[-1] == height:
                runs[-1].append(float(end))
            else:
                heights.append(float(height))
                runs.append([float(begin), float(end)])
    for k, (height, run) in enumerate(zip(heights, runs, strict=True)):
        points, width = (rod.at(values, np.array(run)) for values in (rod.points, rod.width))
        ends_here = round_ends[0] and k == 0, round_ends[1] and k == len(runs) - 1
        yield Piece(number, points, width, height, ends_here, rod.side)


def plastic_terraces(arms: Sequence[Piece], drawn: Sequence[Piece]) -> tuple[Terrace, ...]:
    """Terraces of all arms and drawn rods in printed coordinates; overlapping pieces are united."""
    regions = [(piece.height_mm, piece.region) for piece in drawn]
    regions += [(piece.height_mm, part) for piece in arms for part in piece.parts]
    return nested_terraces(regions) if regions else ()


def cutting_lines(plan: Layout, drawn: Sequence[Piece]) -> tuple[Floats, ...]:
    """Closed lines (n, 2) mm to cut along, the outline first: the far edges of printed rims, or border and holes."""
    sheet = shapely.Polygon(plan.outline, plan.holes)
    rims = {rod for rim in (plan.rim, *plan.hole_rims) for rod in rim}
    if not rims:
        return (plan.outline, *plan.holes)
    with_rims = shapely.union_all([sheet, *(piece.region for piece in drawn if piece.number in rims)])
    return tuple(shapely.get_coordinates(ring)[:-1] for ring in shapely.get_rings(with_rims))


def border_terrace(plan: Layout, plastic: Sequence[Terrace], rounding: Rounding) -> Terrace:
    """A printed line to cut along: one line wide, one layer high, outside the border and in holes.

    It is left out beside printed rims.
    """
    sheet = shapely.Polygon(plan.outline, plan.holes)
    around = sheet.buffer(rounding.line_mm, join_style="mitre", mitre_limit=5).difference(sheet)
    # plastic beyond the border must not touch the line
    clear = around.difference(plastic[0].region.buffer(rounding.line_mm))
    # slivers cannot be printed, and would touch the other parts in a point
    # half width below which a piece of the cut line is removed, over the width of a line
    thin = 0.1 * rounding.line_mm
    wide = clear.buffer(-thin, join_style="mitre").buffer(thin, join_style="mitre", mitre_limit=5)
    return Terrace(rounding.first_layer_mm, shapely.set_precision(wide, GRID_MM))
