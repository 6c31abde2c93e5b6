"""The graph of a drawing: lines and copies of motifs, cut at the outline and where they meet."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.border import Border
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.rods import DrawnLine, Rods
from asterism.pattern.design.sizing.profiles import Profile, SizingField, sample
from asterism.pattern.design.stars import MIN_ARM_MM, THICKNESS_RANGE_MM, WIDTH_RANGE_MM
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.rods.curves import check_holes, hole_rings, polyline, shown_place
from asterism.pattern.rods.graph import Rod, RodGraph, apart_by_face, close_rods, place_between
from asterism.pattern.rods.planar_lines import Piece, cut_lines, is_closed

MAX_COPIES = 20_000
# mm: sections that vary over the sheet are evaluated at points this close along a rod
SECTION_STEP_MM = 1.0
# 1: distance of two nodes over the least width of a line, below which they print as one
MERGED_WIDTHS = 0.5
MAX_RODS = 20_000
# rods that meet at a smaller angle print as one, and the mesh has no good triangles between them
MIN_ROD_ANGLE_DEG = 20.0


@dataclass(frozen=True)
class DrawnPattern:
    """The rods of a drawing and its outline."""

    graph: RodGraph  # the rods
    outline: Floats  # (B, 2) mm, counterclockwise
    # rods that are the outline, in their order around it, all counterclockwise; empty if no rod is on the outline.
    rim: tuple[int, ...]
    holes: tuple[Floats, ...] = ()  # (n, 2) mm each, edges of the holes, in the order of `border.holes`
    # for each hole the rods that are its edge, in their order; empty for a hole without a printed rim.
    hole_rims: tuple[tuple[int, ...], ...] = ()


@dataclass(frozen=True)
class PlacedLine:
    """A line at its place on the sheet, before it is cut; of a motif, with the number of its copy."""

    line: DrawnLine
    points: Floats
    name: str
    group: int = -1


def drawn_pattern(rods: Rods, border: Border, lattice: Lattice, corners: Floats | None) -> DrawnPattern:
    """The graph and the outline of a design with drawn rods.

    Parameters
    ----------
    corners : (B, 2) mm, the outline; None if a line is the outline (`border.rods`).

    Raises
    ------
    DesignError
        The drawing cannot be printed. The message names the lines and the place.

    Examples
    --------
    >>> ring = Rods.model_validate({"draw": [{"name": "rim", "circle_mm": {"radius": 20.0}}]})
    >>> sheet = drawn_pattern(ring, Border(rods="rim"), Lattice(), None)
    >>> len(sheet.graph.rods), sheet.rim, sheet.graph.joints, round(sheet.graph.total_length, 1)
    (1, (0,), (), 125.7)
    """
    drawn = [
        PlacedLine(line, polyline(line, rods.curve_mm), line.name or f"draw[{k}]")
        for k, line in enumerate(rods.on_sheet)
    ]
    rim = None if corners is not None else _rim(drawn, border.rods or "", "border.rods")
    if rim is not None:
        points = drawn[rim].points
        points = points if polygon_area(points[:-1]) > 0 else points[::-1].copy()
        corners = points[:-1]
        drawn[rim] = PlacedLine(drawn[rim].line, points, drawn[rim].name)
    assert corners is not None
    edges = [(f"border.holes[{k}]", hole.rods) for k, hole in enumerate(border.holes) if hole.rods is not None]
    hole_lines = [_rim(drawn, line, f"{name}.rods") for name, line in edges]
    holes = hole_rings(border, rods.curve_mm)
    printed_holes = [(name, drawn[k].points[:-1]) for (name, _), k in zip(edges, hole_lines, strict=True)]
    check_holes([*holes, *printed_holes], corners, border.tip_margin_mm)
    drawn += _copies(rods, lattice, corners)
    rims = {rim, *hole_lines}
    room = _room(border, corners, [ring for _, ring in holes], [ring for _, ring in printed_holes])
    whole = shapely.covers(room.buffer(1e-9), [shapely.LineString(each.points) for each in drawn])
    kept = [
        part
        for k, each in enumerate(drawn)
        for part in ([each] if k in rims or whole[k] else _on_sheet(each, border, room))
    ]
    if not kept:
        raise DesignError("rods", "must have at least one line on the sheet")
    graph, pieces = graph_of_lines(kept, rods)
    made = graph.rods
    on_rim = [k for k, piece in enumerate(pieces) if rim is not None and kept[piece.line] is drawn[rim]]
    if on_rim:
        corners = np.concatenate([made[k].points[:-1] for k in on_rim])
    hole_rims = [tuple(k for k, piece in enumerate(pieces) if kept[piece.line] is drawn[line]) for line in hole_lines]
    edges_of_holes = [np.concatenate([made[k].points[:-1] for k in pieces_of]) for pieces_of in hole_rims]
    printed = zip((name for name, _ in edges), edges_of_holes, hole_rims, strict=True)
    rings = [*((name, ring, ()) for name, ring in holes), *printed]
    order = {f"border.holes[{k}]": k for k in range(len(border.holes))}
    rings.sort(key=lambda each: order[each[0]])
    return DrawnPattern(
        graph, corners, tuple(on_rim), tuple(ring for _, ring, _ in rings), tuple(rods_of for _, _, rods_of in rings)
    )


def graph_of_lines(lines: list[PlacedLine], rods: Rods) -> tuple[RodGraph, list[Piece]]:
    """The graph of lines that are cut where they meet, and the piece of a line that each rod is.

    Raises
    ------
    DesignError
        The lines cannot be printed. The message names them and the place.
    """
    merge = MERGED_WIDTHS * min(float(rod_of_piece(each, each.points, 0, 0, rods).width.min()) for each in lines)
    names = [each.name for each in lines]
    nodes, pieces = cut_lines([each.points for each in lines], rods.join_mm, max(merge, rods.join_mm), names)
    made = (rod_of_piece(lines[piece.line], piece.points, piece.start, piece.end, rods) for piece in pieces)
    met = RodGraph(nodes, tuple(made))
    graph = apart_by_face(met)
    _check_rods(graph)
    _check_angles(met)
    _check_clearance(met)
    return graph, pieces


def _rim(drawn: list[PlacedLine], name: str, field: str) -> int:
    """Number of the line that is the outline, or the edge of a hole."""
    named = [k for k, each in enumerate(drawn) if each.line.name == name]
    if len(named) > 1:
        raise DesignError(field, f"must be the name or layer of one line; {len(named)} lines have it", name)
    if not named:
        names = ", ".join(sorted({each.line.name for each in drawn if each.line.name})) or "no names"
        raise DesignError(field, f"must be the name or layer of one line, of {names}", name)
    points = drawn[named[0]].points
    if not is_closed(points):
        raise DesignError(field, "must be a closed line", name)
    if not shapely.is_valid(shapely.polygons(points)):
        raise DesignError(field, "must be a line that does not cross itself", name)
    return named[0]


def _copies(rods: Rods, lattice: Lattice, corners: Floats) -> list[PlacedLine]:
    """The lines of the motif at all lattice sites whose copies reach the sheet, site by site."""
    if not rods.motif:
        return []
    lines = [polyline(line, rods.curve_mm) for line in rods.motif]
    reach = max(float(np.linalg.norm(points, axis=1).max()) for points in lines)
    low, high = corners.min(axis=0) - reach, corners.max(axis=0) + reach
    if np.prod(high - low) > MAX_COPIES * abs(np.linalg.det(lattice.vectors)):
        problem = f"makes more than {MAX_COPIES} copies of the motif"
        raise DesignError("lattice.spacing_mm", problem, lattice.spacing_mm)
    places = lattice.sites.place(lattice.sites.cells_within(low, high))
    sheet = shapely.polygons(corners)
    is_on_sheet = shapely.distance(sheet, shapely.points(places)) <= reach
    return [
        PlacedLine(line, points + place, line.name or f"motif[{k}]", copy)
        for copy, place in enumerate(places[is_on_sheet])
        for k, (line, points) in enumerate(zip(rods.motif, lines, strict=True))
    ]


def _room(
    border: Border, corners: Floats, holes: list[Floats], printed_holes: list[Floats]
) -> shapely.Polygon | shapely.MultiPolygon:
    """Where lines can be: up to the margin from the outline and from holes, or up to the rims."""
    margin = 0.0 if border.rods is not None else border.tip_margin_mm
    room = shapely.polygons(corners).buffer(-margin, join_style="round", quad_segs=16)
    around = [shapely.Polygon(hole).buffer(border.tip_margin_mm, quad_segs=16) for hole in holes]
    return room.difference(shapely.union_all([*around, *map(shapely.Polygon, printed_holes)]))


def _on_sheet(drawn: PlacedLine, border: Border, inner: shapely.Polygon | shapely.MultiPolygon) -> list[PlacedLine]:
    """The parts, where lines can be, of a line that leaves that room."""
    line = shapely.LineString(drawn.points)
    outside = shapely.get_coordinates(shapely.difference(line, inner))[0]
    if border.overhang == "refuse":
        x, y = outside
        problem = f'{drawn.name} leaves the sheet at [{x:.2f}, {y:.2f}]; overhang = "cut" cuts it there'
        raise DesignError("border.overhang", problem, border.overhang, place_mm=outside)
    parts = shapely.get_parts(shapely.intersection(line, inner))
    lines = parts[shapely.get_type_id(parts) == shapely.GeometryType.LINESTRING]
    merged = shapely.get_parts(shapely.line_merge(shapely.multilinestrings(lines)))
    return [
        PlacedLine(drawn.line, shapely.get_coordinates(part), drawn.name, drawn.group)
        for part in merged
        if shapely.length(part) >= MIN_ARM_MM
    ]


def rod_of_piece(drawn: PlacedLine, points: Floats, start: int, end: int, rods: Rods) -> Rod:
    """A piece of a line as a rod, with its sections."""
    line = drawn.line
    thickness = rods.thickness_mm if line.thickness_mm is None else line.thickness_mm
    width = rods.width_mm if line.width_mm is None else line.width_mm
    if isinstance(thickness, Profile) or isinstance(width, Profile):
        points = shapely.get_coordinates(shapely.segmentize(shapely.LineString(points), SECTION_STEP_MM))
    thicknesses = _sizes(thickness, points, THICKNESS_RANGE_MM, "thickness_mm", drawn, rods)
    widths = _sizes(width, points, WIDTH_RANGE_MM, "width_mm", drawn, rods)
    if (rounding := rods.rounding) is not None:
        thicknesses, widths = rounding.thickness(thicknesses), rounding.width(widths)
    kappa_bar, face = line.kappa_bar_per_mm, rods.face(line)
    return Rod(points, start, end, thicknesses, widths, kappa_bar, drawn.name, drawn.group, face)


def _sizes(
    field: SizingField, points: Floats, limits: tuple[float, float], key: str, drawn: PlacedLine, rods: Rods
) -> Floats:
    """(n,) mm, a size along a rod, within the limits of a printer."""
    values = sample(field, points)
    wrong = ~((values >= limits[0]) & (values <= limits[1]))
    if wrong.any():
        at = int(wrong.argmax())
        x, y = points[at]
        problem = f"must be from {limits[0]:g} to {limits[1]:g} along {drawn.name}, as at [{x:.2f}, {y:.2f}]"
        raise DesignError(_size_field(drawn.line, key, rods), problem, float(values[at]), place_mm=points[at])
    return values


def _size_field(line: DrawnLine, key: str, rods: Rods) -> str:
    """The field of a line's size in the design; that of all lines if the line has none of its own."""
    tables = {f"rods.{part}[{k}]": each for part in ("draw", "motif") for k, each in enumerate(getattr(rods, part))}
    own = [field for field, each in tables.items() if each is line and getattr(line, key) is not None]
    return f"{own[0] if own else 'rods'}.{key}"


def _check_rods(graph: RodGraph) -> None:
    """Refuse a graph that prints as another one."""
    if len(graph.rods) > MAX_RODS:
        raise DesignError("rods", f"must have at most {MAX_RODS} rods between nodes, has {len(graph.rods)}")
    degree = [len(ends) for ends in graph.ends_at]
    for rod in graph.rods:
        if rod.length < MIN_ARM_MM and min(degree[rod.start], degree[rod.end]) < 2:
            place = rod.at(rod.points, np.array([0.5]))[0]
            raise _error(
                f"{rod.name} has a piece of {rod.length:.2f} mm at {shown_place(place)}: {MIN_ARM_MM:g} or more", place
            )


def _check_angles(graph: RodGraph) -> None:
    for node, ends in enumerate(graph.ends_at):
        for end_1, end_2 in combinations(ends, 2):
            first, second = graph.rods[end_1.rod], graph.rods[end_2.rod]
            cosine = first.direction_at(end_1.end) @ second.direction_at(end_2.end)
            angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
            if angle < MIN_ROD_ANGLE_DEG:
                place = graph.nodes[node]
                meet = f"{first.name} and {second.name} meet at {angle:.0f} deg at {shown_place(place)}"
                other = ", or draw them as one" if first.side == second.side else ", also on two faces of the fabric"
                raise _error(f"{meet}: {MIN_ROD_ANGLE_DEG:g} or more{other}", place)


def _check_clearance(graph: RodGraph) -> None:
    """Refuse rods without a common node that are nearer than half the sum of their widths."""
    for first, second, gap in close_rods(graph, graph):
        if not {first.start, first.end} & {second.start, second.end}:
            place = place_between(first, second)
            become = "print as one" if first.side == second.side else "lie on each other through the fabric"
            raise _error(
                f"{first.name} and {second.name} are {gap:.2f} mm apart at {shown_place(place)} and would {become} "
                f"(widths {first.width.max():g}, {second.width.max():g}): move them apart, or let them meet",
                place,
            )


def _error(problem: str, place: Floats) -> DesignError:
    return DesignError("rods", problem, place_mm=place)
