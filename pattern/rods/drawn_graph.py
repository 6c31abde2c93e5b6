"""The graph of a drawing: lines and copies of motifs, cut at the outline and where they meet.

Ends are moved onto lines beside them, crossings become nodes, and nodes that are near each other become one.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.border import Border
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.rods import DrawnLine, Rods
from asterism.pattern.design.sizing.profiles import Profile, SizingField, sample
from asterism.pattern.design.stars import MIN_ARM_MM, ROD_SIZES, StarSize, rounded_sections
from asterism.pattern.geometry.planar import clusters, nearest_segment, polygon_area, shown_place, turning_angles
from asterism.pattern.rods.arms import parts_within
from asterism.pattern.rods.curves import check_holes, hole_rings, polyline
from asterism.pattern.rods.graph import CORNER_DEG, Rod, RodGraph, apart_by_face, close_rods, place_between

MAX_COPIES = 20_000
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

    Raises `DesignError` if the drawing cannot be printed. The message names the lines and the place.

    `corners`: (B, 2) mm, the outline; None if a line is the outline (`border.rods`).

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

    Raises `DesignError` if the lines cannot be printed. The message names them and the place.
    """
    # distance of two nodes over the least width of a line, below which they print as one
    merge = 0.5 * min(float(rod_of_piece(each, each.points, 0, 0, rods).width.min()) for each in lines)
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
        problem = f'{drawn.name} leaves the sheet at {shown_place(outside)}; overhang = "cut" cuts it there'
        raise DesignError("border.overhang", problem, border.overhang, place_mm=outside)
    return [
        PlacedLine(drawn.line, shapely.get_coordinates(part), drawn.name, drawn.group)
        for part in parts_within(line, inner)
        if shapely.length(part) >= MIN_ARM_MM
    ]


def rod_of_piece(drawn: PlacedLine, points: Floats, start: int, end: int, rods: Rods) -> Rod:
    """A piece of a line as a rod, with its sections."""
    line = drawn.line
    fields = {size: rods.size_of(line, size.key) for size in ROD_SIZES}
    if any(isinstance(field, Profile) for field in fields.values()):
        # mm: sections that vary over the sheet are evaluated at points this close along a rod
        points = shapely.get_coordinates(shapely.segmentize(shapely.LineString(points), 1.0))
    sections = np.column_stack([_sizes(field, points, size, drawn, rods) for size, field in fields.items()])
    kappa_bar, face = line.kappa_bar_per_mm, rods.face(line)
    sections = rounded_sections(rods.rounding, sections)
    return Rod(points, start, end, sections, kappa_bar, drawn.name, drawn.group, face)


def _sizes(field: SizingField, points: Floats, size: StarSize, drawn: PlacedLine, rods: Rods) -> Floats:
    """(n,) a size along a rod, within the limits of a printer."""
    values, limits = sample(field, points), size.limits
    wrong = ~((values >= limits[0]) & (values <= limits[1]))
    if wrong.any():
        at = int(wrong.argmax())
        problem = f"must be from {limits[0]:g} to {limits[1]:g} along {drawn.name}, as at {shown_place(points[at])}"
        raise DesignError(_size_field(drawn.line, size.key, rods), problem, float(values[at]), place_mm=points[at])
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


# mm: places closer than this are one, but for rounding
SAME_PLACE_MM = 1e-6
# more have no room on a sheet, and take minutes
MAX_MEETINGS = 100_000
_SHAPES_AT_ONCE = 100


@dataclass(frozen=True)
class Piece:
    """A part of a line between two nodes."""

    line: int  # number of the line
    points: Floats  # (n, 2) mm, from node to node
    # start, end: numbers of the nodes.
    start: int
    end: int


def cut_lines(lines: list[Floats], join_mm: float, merge_mm: float, names: list[str]) -> tuple[Floats, list[Piece]]:
    """Nodes (N, 2) mm of lines, and the pieces between them, line by line along the line.

    Raises `DesignError` if two lines lie on each other.

    Parameters
    ----------
    lines : polylines (n, 2) mm; a closed one ends with its first point.
    join_mm : an open end nearer than this to an end or corner is moved there, else onto a line that is as near.
    merge_mm : nodes nearer than this to each other become one, and loose ends shorter than this are dropped.
    names : of the lines, for messages.

    Two lines that cross, one of which ends just beside a third:

    >>> cross = [np.array([[-5.0, 0.0], [5.0, 0.0]]), np.array([[0.0, -5.0], [0.0, 4.95]])]
    >>> nodes, pieces = cut_lines([*cross, np.array([[-5.0, 5.0], [5.0, 5.0]])], 0.1, 0.6, ["", "", ""])
    >>> len(nodes), [(piece.line, piece.start, piece.end) for piece in pieces]
    (7, [(0, 0, 6), (0, 6, 1), (1, 2, 6), (1, 6, 3), (2, 4, 3), (2, 3, 5)])
    """
    lines = _joined(lines, join_mm)
    places, owners, parts = _meetings(lines, names)
    meetings = len(places)
    for number, line in enumerate(lines):
        at = _key_points(line)
        places.extend(line[at])
        owners.extend([number] * len(at))
        parts.extend(at.astype(float))
    place, owner, part = np.array(places).reshape(-1, 2), np.array(owners, dtype=np.int64), np.array(parts)
    # ends and corners first: merged nodes are there
    order = np.concatenate([np.arange(meetings, len(place)), np.arange(meetings)])
    place, owner, part = place[order], owner[order], part[order]
    node, nodes = clusters(place, merge_mm)
    pieces = []
    of_lines = np.split(np.argsort(owner, kind="stable"), np.cumsum(np.bincount(owner, minlength=len(lines)))[:-1])
    for number, (line, of_line) in enumerate(zip(lines, of_lines, strict=True)):
        pieces += _split(number, line, part[of_line], node[of_line], nodes, merge_mm)
    degree = np.bincount([end for piece in pieces for end in (piece.start, piece.end)], minlength=len(nodes))
    kept = [
        piece for piece in pieces if min(degree[piece.start], degree[piece.end]) > 1 or _length(piece.points) > merge_mm
    ]
    if not kept:
        problem = f"all lines are shorter than {max(join_mm, merge_mm):g} mm: is the drawing in mm?"
        raise DesignError("rods", problem)
    used, index = np.unique([[piece.start, piece.end] for piece in kept], return_inverse=True)
    ends = index.reshape(-1, 2)
    return nodes[used], [Piece(p.line, p.points, int(a), int(b)) for p, (a, b) in zip(kept, ends, strict=True)]


def is_closed(line: Floats) -> bool:
    """Whether a polyline returns to its first point."""
    return len(line) > 3 and bool(np.linalg.norm(line[0] - line[-1]) <= SAME_PLACE_MM)


def _key_points(line: Floats) -> Ints:
    """Numbers of the points of a line that are nodes by themselves: both ends, and corners."""
    if len(line) == 2:
        return np.array([0, 1])
    # a ring without a corner has its seam at its first point; both of its ends are this node
    turns = turning_angles(line[:-1] if is_closed(line) else line)
    return np.unique(np.concatenate([[0], np.flatnonzero(np.abs(turns) > np.radians(CORNER_DEG)), [len(line) - 1]]))


def _joined(lines: list[Floats], join_mm: float) -> list[Floats]:
    """The lines with their open ends moved: to an end or corner nearby, else onto a line nearby."""
    lines = [line.copy() for line in lines]
    ends = [(number, at) for number, line in enumerate(lines) if not is_closed(line) for at in (0, -1)]
    key = [(number, at) for number, line in enumerate(lines) for at in _key_points(line)]
    places = np.array([lines[number][at] for number, at in key]).reshape(-1, 2)
    node, merged = clusters(places, join_mm)
    size = np.bincount(node, minlength=len(merged))
    open_ends = {(number, at % len(lines[number])) for number, at in ends}
    fixed = {int(node[i]): places[i] for i, (number, at) in enumerate(key) if (number, int(at)) not in open_ends}
    target = {k: fixed.get(k, merged[k]) for k in range(len(merged))}
    cluster_of = {(number, int(at)): int(node[i]) for i, (number, at) in enumerate(key)}
    loose = []
    for number, at in ends:
        cluster = cluster_of[number, at % len(lines[number])]
        if size[cluster] > 1:
            lines[number][at] = target[cluster]
        else:
            loose.append((number, at))
    shapes = [shapely.LineString(line) for line in lines]
    tree = shapely.STRtree(shapes)
    feet: list[tuple[int, int, int, Floats]] = []
    for number, at in loose:
        point = shapely.Point(lines[number][at])
        nearby = [int(k) for k in tree.query(point, predicate="dwithin", distance=join_mm) if k != number]
        if nearby:
            nearest = min(nearby, key=lambda k: (shapes[k].distance(point), k))
            foot = shapes[nearest].interpolate(shapes[nearest].project(point))
            feet.append((number, at, nearest, np.array(foot.coords[0])))
    for number, at, nearest, foot_place in feet:
        lines[number][at] = foot_place
        lines[nearest] = _with_point(lines[nearest], foot_place)
    return lines


def _with_point(line: Floats, place: Floats) -> Floats:
    """The line with a point on it as one of its points."""
    if np.linalg.norm(line - place, axis=1).min() <= SAME_PLACE_MM:
        return line
    piece = int(nearest_segment(place[None], line[:-1], line[1:])[0])
    return np.insert(line, piece + 1, place, axis=0)


def _meetings(lines: list[Floats], names: list[str]) -> tuple[list[Floats], list[int], list[float]]:
    """Places where segments of lines meet, with the line and its fractional point number of each side."""
    segments = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])
    owner = np.repeat(np.arange(len(lines)), [len(line) - 1 for line in lines])
    number = np.concatenate([np.arange(len(line) - 1) for line in lines])
    shapes = shapely.linestrings(segments)
    first, second = _near_pairs(shapes)
    last = np.array([len(line) - 2 for line in lines])
    ring = np.array([is_closed(line) for line in lines])
    same, gap = owner[first] == owner[second], np.abs(number[first] - number[second])
    beside = same & ((gap <= 1) | (ring[owner[first]] & (gap == last[owner[first]])))
    places: list[Floats] = []
    owners: list[int] = []
    parts: list[float] = []
    for i, j in zip(first[~beside], second[~beside], strict=True):
        place = _meeting(segments[i], segments[j])
        if place is None:
            one, other = sorted(names[owner[k]] or "a line" for k in (i, j))
            both = f"two lines named {one}" if one == other else f"{one} and {other}"
            raise DesignError(
                "rods", f"{both} lie on each other at {shown_place(segments[i].mean(axis=0))}: draw the line once"
            )
        for k in (i, j):
            step = segments[k][1] - segments[k][0]
            part = min(max(float((place - segments[k][0]) @ step / (step @ step)), 0.0), 1.0)
            places.append(place)
            owners.append(int(owner[k]))
            parts.append(float(number[k]) + part)
    return places, owners, parts


def _near_pairs(shapes: np.ndarray) -> tuple[Ints, Ints]:
    """Numbers of two shapes that touch within rounding, the smaller one first."""
    tree, pairs, count = shapely.STRtree(shapes), [np.empty((2, 0), dtype=np.int64)], 0
    for start in range(0, len(shapes), _SHAPES_AT_ONCE):
        found = tree.query(shapes[start : start + _SHAPES_AT_ONCE], predicate="dwithin", distance=SAME_PLACE_MM)
        found[0] += start
        pairs.append(found[:, found[0] < found[1]])
        count += pairs[-1].shape[1]
        if count > MAX_MEETINGS + 2 * len(shapes):
            raise DesignError("rods", f"lines must meet at most {MAX_MEETINGS} times: draw fewer, or shorter ones")
    first, second = np.concatenate(pairs, axis=1)
    return first, second


def _meeting(first: Floats, second: Floats) -> Floats | None:
    """(2,) mm, where two segments (2, 2) that touch within rounding meet; None if they lie on each other."""
    (a, b), (c, d) = first, second
    u, v, w = b - a, d - c, c - a
    cross = u[0] * v[1] - u[1] * v[0]
    if abs(cross) <= 1e-9 * np.linalg.norm(u) * np.linalg.norm(v):
        along = np.sort(np.array([w @ u, (d - a) @ u]) / (u @ u))
        shared = (min(along[1], 1.0) - max(along[0], 0.0)) * float(np.linalg.norm(u))
        if shared > SAME_PLACE_MM:
            return None
        return np.asarray(a + np.clip(0.5 * (max(along[0], 0.0) + min(along[1], 1.0)), 0.0, 1.0) * u)
    return np.asarray(a + min(max(float((w[0] * v[1] - w[1] * v[0]) / cross), 0.0), 1.0) * u)


def _split(number: int, line: Floats, part: Floats, node: Ints, nodes: Floats, merge_mm: float) -> list[Piece]:
    """The pieces of a line between nodes at fractional point numbers `part`."""
    order = np.argsort(part, kind="stable")
    part, node = part[order], node[order]
    pieces = []
    for k in range(len(part) - 1):
        inner = line[int(np.floor(part[k])) + 1 : int(np.ceil(part[k + 1]))]
        ends = nodes[node[[k, k + 1]]]
        if len(inner):
            is_clear = np.linalg.norm(inner[:, None] - ends, axis=2) > merge_mm
            inner = inner[is_clear.all(axis=1)]
        points = np.concatenate([ends[:1], inner, ends[1:]])
        if node[k] == node[k + 1] and _length(points) <= 4.0 * merge_mm:
            continue  # the same node twice
        pieces.append(Piece(number, points, int(node[k]), int(node[k + 1])))
    return pieces


def _length(points: Floats) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
