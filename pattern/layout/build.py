"""From a design to its layout: stars, arms, outline and supports in printed coordinates."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.border import OUTLINES, Border, Hole
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import BlankSheetError, DesignError, check_type
from asterism.pattern.design.files import read_table
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.pins import Pins
from asterism.pattern.design.stars import MIN_ARM_MM, rounded_sections
from asterism.pattern.geometry.planar import distance_to_outline, polygon_area, shown_place
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.pin_placement import check_pins, pin_set, snapped_to_lines
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.layout.star_cells import corner_numbers, outline, star_cells, star_margin_mm, star_sizes
from asterism.pattern.layout.supports import PinSet
from asterism.pattern.rods.arms import check_clear, cut
from asterism.pattern.rods.graph import RodGraph, close_rods, place_between

if TYPE_CHECKING:
    from asterism.pattern.rods.drawn_graph import DrawnPattern

# vertices of the exact model's mesh
MAX_VERTICES = 400_000


def layout(design: Design) -> Layout:
    """The layout of a design with stars, with drawn rods, or with both: all that is printed, and where it is supported.

    Every model begins here. So arguments that are not designs are refused here. Raises `DesignError` if the sheet
    cannot be printed. The message names the field, its value and the allowed range. Raises `TypeError` if `design` is
    not a `Design`.

    >>> design = Design.from_dict({"stars": {"length_mm": 10}, "border": {"rings": 1}})
    >>> sheet = layout(design)
    >>> len(sheet.centres), len(sheet.arm_tip), round(sheet.spacing_mm, 2)
    (7, 21, 17.32)
    >>> lines = [{"line_mm": [(-30, y), (30, y)]} for y in (-10, 0, 10)]
    >>> sheet = layout(Design.from_dict({"rods": {"draw": lines}, "border": {"rectangle_mm": (62, 30)}}))
    >>> len(sheet.graph.rods), len(sheet.centres), round(sheet.spacing_mm, 2)
    (3, 0, 10.33)
    """
    check_type(design, Design, "load_design reads one from a file, Design.from_dict makes one of a dict")
    if design.rods is None:
        return _of_stars(design)
    from asterism.pattern.rods.drawn_graph import drawn_pattern  # slow to import; designs of stars do without it

    corners = None if design.border.rods is not None else sheet_outline(design)
    drawn = drawn_pattern(design.rods, design.border, design.lattice, corners)
    if design.stars is not None:
        return _with_stars(design, drawn)
    scale = float(abs(polygon_area(drawn.outline)) / drawn.graph.total_length)
    check_mesh_size(design.usual_edge_mm, drawn.outline)
    return Layout(
        outline=drawn.outline,
        pins=_pins(design, drawn.outline, drawn.graph, drawn.holes),
        lattice_vectors=design.lattice.vectors if design.rods.motif else scale * np.eye(2),
        lattice_origin=np.asarray(design.lattice.origin_mm, dtype=float),
        drawn=drawn.graph,
        rim=drawn.rim,
        holes=drawn.holes,
        hole_rims=drawn.hole_rims,
    )


def load_design(path: str | Path) -> Design:
    """Read a design from a TOML or JSON file and check its geometry.

    Parameters
    ----------
    path : file ending in .toml or .json. Pictures are looked up in its folder.

    Raises
    ------
    DesignError
        The file cannot be read, a section has a mistake, or the sheet cannot be laid out. The message names the file,
        the field and its value.
    """
    path = Path(path)
    design = Design.from_dict(read_table(path), path.parent, path)
    try:
        layout(design)
    except DesignError as error:
        raise error.within(path) from None
    return design


def _of_stars(design: Design) -> Layout:
    """The layout of the stars alone."""
    lattice, stars = design.lattice, design.required_stars
    corners, holes, cells = _kept_sheet(design.border, lattice)
    if design.usual_edge_mm > lattice.spacing_mm:
        allowed = f"must be at most the spacing of the stars, {lattice.spacing_mm:g}"
        raise DesignError("mesh.edge_mm", allowed, design.usual_edge_mm)
    check_mesh_size(design.usual_edge_mm, corners)
    if len(cells) == 0:
        margin = f"border.star_margin_mm = {star_margin_mm(design.border, lattice):.4g} from its outline"
        raise BlankSheetError("border", f"must have room for at least one star, {margin}")
    centres = lattice.sites.place(cells)
    _check_tip_margin(design.border.tip_margin_mm, corners, centres)
    directions = lattice.arm_directions
    sizes = star_sizes(stars, cells, lattice)

    star, arm = (index.ravel() for index in np.indices((len(cells), lattice.arms)))
    tips = centres[star] + sizes.length[star, None] * directions[arm]
    printed = sizes.length[star] >= MIN_ARM_MM
    star, arm, tips = star[printed], arm[printed], tips[printed]
    sections = sizes.sections[star, arm]

    full, (tips, too_long) = tips, cut(centres[star], tips, corners, design.border.tip_margin_mm, holes)
    if len(too_long) and design.border.overhang == "refuse":
        first, margin = star[too_long[0]], f"(keeping {design.border.tip_margin_mm:g} mm)"
        at = centres[first]
        problem = f"lets no arm leave the sheet {margin}, but one of star {first} at {shown_place(at)} does"
        raise DesignError("border.overhang", problem, design.border.overhang, stars=[first], place_mm=at)
    part = np.linalg.norm(tips - centres[star], axis=1) / np.linalg.norm(full - centres[star], axis=1)
    sections[:, 1] = sections[:, 0] + part[:, None] * (sections[:, 1] - sections[:, 0])
    long_enough = part * sizes.length[star] >= MIN_ARM_MM
    star, tips, sections = (values[long_enough] for values in (star, tips, sections))
    sections = rounded_sections(stars.rounding, sections)
    if len(star) == 0:
        longest = float(sizes.length.max(initial=0.0))
        problem = f"must have at least one arm of {MIN_ARM_MM:g} mm on the sheet"
        raise BlankSheetError("stars", f"{problem}; the longest of the design is {longest:.3g} mm")
    # closer ends of arms are one point, but for rounding
    meeting = 1e-6 * lattice.spacing_mm
    check_clear(centres[star], tips, star, sections[..., 1], meeting)

    lines, ends = shapely.linestrings(np.stack([centres[star], tips], axis=1)), np.concatenate([centres[star], tips])
    kept_pins = _kept_pins(design.pins, design.border, lattice)
    pins = tuple(snapped_to_lines(pin, corners, ends, lines) for pin in kept_pins)
    if any(pin is not place for pin, place in zip(pins, kept_pins, strict=True)):
        check_pins(pins, SheetEdges.of(corners, holes), corner_numbers(design.border, corners))
    kept, star = np.unique(star, return_inverse=True)
    return Layout(
        outline=corners.copy(),  # layouts own their arrays
        centres=centres[kept],
        arm_star=star,
        arm_tip=tips,
        arm_sections=sections,
        pins=tuple(replace(pin, points=pin.points.copy()) for pin in pins),
        lattice_vectors=lattice.vectors,
        lattice_origin=np.asarray(lattice.origin_mm),
        star_branch=sizes.branch[kept],
        star_side=sizes.side[kept],
        star_number=kept,
        sheet_sites=cells.copy(),
        site_sizes_mm=sizes.at_centres,
        ignored_sites=sizes.ignored_sites,
        meeting_mm=meeting,
        holes=tuple(hole.copy() for hole in holes),
        hole_rims=((),) * len(holes),
    )


@lru_cache(maxsize=8)
def _kept_pins(pins: tuple[Pins, ...], border: Border, lattice: Lattice) -> tuple[PinSet, ...]:
    """The pins where the design places them, kept for edits of stars."""
    corners, holes, _ = _kept_sheet(border, lattice)
    starts = corner_numbers(border, corners)
    sets = tuple(pin_set(pin, corners, f"pins[{k}]", holes, starts) for k, pin in enumerate(pins))
    check_pins(sets, SheetEdges.of(corners, holes), starts)
    return sets


def _pins(design: Design, outline: Floats, graph: RodGraph, holes: tuple[Floats, ...]) -> tuple[PinSet, ...]:
    """The pins of a design with drawn rods, moved onto rods beside them."""
    starts = corner_numbers(design.border, outline)
    sets = [pin_set(pin, outline, f"pins[{k}]", holes, starts) for k, pin in enumerate(design.pins)]
    pins = tuple(snapped_to_lines(pin, outline, graph.nodes, graph.lines) for pin in sets)
    check_pins(pins, SheetEdges.of(outline, holes), starts)
    return pins


def _with_stars(design: Design, drawn: DrawnPattern) -> Layout:
    """The layout of stars beside drawn rods. They do not touch each other."""
    changes: dict[str, object] = {"holes": tuple(Hole(polygon_mm=ring.tolist()) for ring in drawn.holes), "rods": None}
    if design.border.rings is None:
        corners = tuple((float(x), float(y)) for x, y in drawn.outline)
        changes |= dict.fromkeys((*OUTLINES, "bulge_mm")) | {"polygon_mm": corners}
    border = design.border.model_copy(update=changes)
    alone = _of_stars(design.model_copy(update={"rods": None, "border": border, "pins": ()}))
    arms = alone.graph
    _check_beside(arms, drawn.graph)
    count = len(arms.nodes)
    moved = tuple(replace(rod, start=rod.start + count, end=rod.end + count) for rod in drawn.graph.rods)
    graph = RodGraph(np.concatenate([arms.nodes, drawn.graph.nodes]), (*arms.rods, *moved), arms.paired)
    first = len(arms.rods)
    return replace(
        alone,
        outline=drawn.outline,
        pins=_pins(design, drawn.outline, graph, drawn.holes),
        drawn=graph,
        rim=tuple(rod + first for rod in drawn.rim),
        holes=drawn.holes,
        hole_rims=tuple(tuple(rod + first for rod in rim) for rim in drawn.hole_rims),
    )


def _check_beside(stars: RodGraph, drawn: RodGraph) -> None:
    """Refuse arms of stars nearer to drawn rods than half the sum of their widths."""
    for arm, rod, gap in close_rods(stars, drawn):
        place = place_between(arm, rod)
        at, centre = shown_place(place), shown_place(arm.points[0])
        what = "crosses" if gap == 0.0 else f"is {gap:.2f} mm from"
        problem = f"an arm of the star at {centre} {what} {rod.name} at {at}: shorten it, remove the star, or move"
        raise DesignError("stars", f"{problem} the line", stars=[arm.group], place_mm=place)


def sheet_outline(design: Design) -> Floats:
    """(B, 2) mm, the outline of the sheet, also if the design has no layout.

    Raises `DesignError` if the outline does not fit the lattice, or is too large.
    """
    return outline(design.border, design.lattice)


def sheet_sites(design: Design) -> Ints:
    """(P, 2) all lattice sites of the sheet in the order of the stars' numbers, also if the design has no layout.

    Raises `DesignError` if the outline does not fit the lattice, or is too large.
    """
    return _kept_sheet(design.border, design.lattice)[2].copy()


@lru_cache(maxsize=8)
def _kept_sheet(border: Border, lattice: Lattice) -> tuple[Floats, tuple[Floats, ...], Ints]:
    """The outline, the holes and the sites of the stars, kept for edits, which rarely change them."""
    corners = outline(border, lattice)
    holes: tuple[Floats, ...] = ()
    if border.holes:
        from asterism.pattern.rods.curves import check_holes, hole_rings  # slow to import; most designs have none

        # mm, from curved edges to their straight pieces, on sheets of stars; drawings have their own
        rings = hole_rings(border, 0.005)
        check_holes(rings, corners, border.tip_margin_mm)
        holes = tuple(ring for _, ring in rings)
    return corners, holes, star_cells(border, lattice, corners, holes)


def _check_tip_margin(margin: float, corners: Floats, centres: Floats) -> None:
    """Refuse a margin in which whole stars would disappear."""
    distance = distance_to_outline(centres, corners)
    star = int(distance.argmin())
    if margin >= distance[star]:
        problem = f"must be below {distance[star]:.4g} mm, the distance of the outermost star from the outline"
        raise DesignError("border.tip_margin_mm", problem, margin, stars=[star], place_mm=centres[star])


def mesh_vertices(edge: float, corners: Floats) -> float:
    """About how many vertices a mesh of equilateral triangles has, with edges in mm, in the outline (B, 2) mm."""
    # half a vertex a triangle
    return float(shapely.area(shapely.polygons(corners)) / (np.sqrt(0.75) * edge**2))


def check_mesh_size(edge: float, corners: Floats) -> None:
    """Refuse mesh edges (mm) too short for the memory of a computer, on a sheet with the outline (B, 2) mm."""
    vertices = mesh_vertices(edge, corners)
    if vertices > MAX_VERTICES:
        allowed = np.ceil(100 * edge * np.sqrt(vertices / MAX_VERTICES)) / 100
        many = f"makes about {vertices:.0f} vertices, at most {MAX_VERTICES} are allowed"
        raise DesignError("mesh.edge_mm", f"{many}: use {allowed:g} or more", edge)
