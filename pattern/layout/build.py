"""From a design to its layout: stars, arms, outline and supports in printed coordinates."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.border import Border
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import NEEDS_STARS_ALONE, BlankSheetError, DesignError
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.pins import Pins
from asterism.pattern.design.stars import MIN_ARM_MM
from asterism.pattern.geometry.planar import inside
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.pin_conflicts import check_conflicts, check_reach
from asterism.pattern.layout.pin_placement import pin_set, snapped_to_arms
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.layout.star_cells import outline, star_cells, star_margin_mm
from asterism.pattern.layout.star_sizes import star_sizes
from asterism.pattern.layout.supports import PinSet
from asterism.pattern.rods.arms import check_clear, cut

KEPT_OUTLINES = 8
# largest distance of the curved edge of a hole from its straight pieces, on sheets of stars; drawings have their own
HOLE_CURVE_MM = 0.005
# vertices of the exact model's mesh
MAX_VERTICES = 400_000
# places closer than this to the edge of a hole are on it, but for rounding
ON_EDGE_MM = 1e-6
# ends of arms closer than this part of the spacing are one point, but for rounding
MEETING_TOLERANCE_SPACINGS = 1e-6


def layout(design: Design) -> Layout:
    """The layout of a design: all that is printed, and where the sheet is supported.

    Every model begins here. So arguments that are not designs are refused here.

    Raises
    ------
    DesignError
        The sheet cannot be printed. The message names the field, its value and the allowed range.
    TypeError
        `design` is not a `Design`.

    Examples
    --------
    >>> design = Design.from_dict({"stars": {"length_mm": 10}, "border": {"rings": 1}})
    >>> sheet = layout(design)
    >>> len(sheet.centres), len(sheet.arm_tip), round(sheet.spacing_mm, 2)
    (7, 21, 17.32)
    """
    check_type(design, Design, "load_design reads one from a file, Design.from_dict makes one of a dict")
    lattice, stars = design.lattice, design.required_stars
    if design.rods is not None:
        raise DesignError("rods", NEEDS_STARS_ALONE)
    corners = _kept_outline(design.border, lattice).copy()  # layouts own their arrays
    holes = tuple(hole.copy() for hole in _kept_holes(design.border, lattice))
    # first the stars: a sheet with too many of them also has too many vertices
    cells = _kept_cells(design.border, lattice).copy()
    _check_mesh(design.usual_edge_mm, design.border, lattice)
    if len(cells) == 0:
        margin = f"border.star_margin_mm = {star_margin_mm(design.border, lattice):.4g} from its outline"
        raise BlankSheetError("border", f"must have room for at least one star, {margin}")
    centres = lattice.sites.place(cells)
    _check_tip_margin(design.border, lattice)
    directions = lattice.arm_directions
    sizes = star_sizes(stars, cells, lattice)

    star, arm = (index.ravel() for index in np.indices((len(cells), lattice.arms)))
    tips = centres[star] + sizes.length[star, None] * directions[arm]
    printed = sizes.length[star] >= MIN_ARM_MM
    star, arm, tips = star[printed], arm[printed], tips[printed]
    thickness, width = sizes.thickness[star, arm], sizes.width[star, arm]

    full, (tips, too_long) = tips, cut(centres[star], tips, corners, design.border.tip_margin_mm, holes)
    if len(too_long) and design.border.overhang == "refuse":
        x, y = centres[star[too_long[0]]]
        raise DesignError(
            "border.overhang",
            f"lets no arm leave the sheet (keeping {design.border.tip_margin_mm:g} mm), but one of star "
            f"{star[too_long[0]]} at [{x:.2f}, {y:.2f}] does",
            design.border.overhang,
            stars=[star[too_long[0]]],
            place_mm=(x, y),
        )
    part = np.linalg.norm(tips - centres[star], axis=1) / np.linalg.norm(full - centres[star], axis=1)
    thickness, width = (_shortened(ends, part) for ends in (thickness, width))
    long_enough = part * sizes.length[star] >= MIN_ARM_MM
    star, tips, thickness, width = (values[long_enough] for values in (star, tips, thickness, width))
    if (rounding := stars.rounding) is not None:
        thickness, width = rounding.thickness(thickness), rounding.width(width)
    if len(star) == 0:
        longest = float(sizes.length.max(initial=0.0))
        problem = f"must have at least one arm of {MIN_ARM_MM:g} mm on the sheet"
        raise BlankSheetError("stars", f"{problem}; the longest of the design is {longest:.3g} mm")
    meeting = MEETING_TOLERANCE_SPACINGS * lattice.spacing_mm
    check_clear(centres[star], tips, star, width, meeting)

    placed = _placed_pins(design.pins, design.border, lattice)
    pins = tuple(snapped_to_arms(pin, corners, centres[star], tips) for pin in placed)
    if all(pin is place for pin, place in zip(pins, placed, strict=True)):
        _check_placed_pins(design.pins, design.border, lattice)
    else:
        check_pins(pins, corners, holes)
    pins = tuple(replace(pin, points=pin.points.copy()) for pin in pins)
    kept, star = np.unique(star, return_inverse=True)
    return Layout(
        outline=corners,
        centres=centres[kept],
        arm_star=star,
        arm_tip=tips,
        arm_thickness=thickness,
        arm_width=width,
        neighbours=lattice.sites.neighbours(cells[kept]),
        pins=pins,
        lattice_vectors=lattice.vectors,
        lattice_origin=np.asarray(lattice.origin_mm),
        star_branch=sizes.branch[kept],
        star_number=kept,
        sheet_sites=cells,
        site_sizes_mm=sizes.at_centres,
        ignored_sites=sizes.ignored_sites,
        meeting_mm=meeting,
        holes=holes,
    )


def sheet_outline(design: Design) -> Floats:
    """(B, 2) mm, the outline of the sheet, also if the design has no layout.

    Raises
    ------
    DesignError
        The outline does not fit the lattice, or is too large.
    """
    return _kept_outline(design.border, design.lattice).copy()


def sheet_sites(design: Design) -> Ints:
    """(P, 2) all lattice sites of the sheet in the order of the stars' numbers, also if the design has no layout.

    Raises
    ------
    DesignError
        The outline does not fit the lattice, or is too large.
    """
    return _kept_cells(design.border, design.lattice).copy()


@lru_cache(maxsize=KEPT_OUTLINES)
def _kept_outline(border: Border, lattice: Lattice) -> Floats:
    """`outline`, kept for edits, which change stars far more often than outlines."""
    return outline(border, lattice)


@lru_cache(maxsize=KEPT_OUTLINES)
def _kept_cells(border: Border, lattice: Lattice) -> Ints:
    """`star_cells`, kept for edits."""
    return star_cells(border, lattice, _kept_outline(border, lattice), _kept_holes(border, lattice))


@lru_cache(maxsize=KEPT_OUTLINES)
def _kept_holes(border: Border, lattice: Lattice) -> tuple[Floats, ...]:
    """The edges of the holes, kept for edits."""
    if not border.holes:
        return ()
    from asterism.pattern.rods.hole_rings import check_holes, hole_rings  # slow to import; most designs do without it

    rings = hole_rings(border, HOLE_CURVE_MM)
    check_holes(rings, _kept_outline(border, lattice), border.tip_margin_mm)
    return tuple(ring for _, ring in rings)


@lru_cache(maxsize=KEPT_OUTLINES)
def _placed_pins(pins: tuple[Pins, ...], border: Border, lattice: Lattice) -> tuple[PinSet, ...]:
    """The pins where the design places them, kept for edits."""
    corners, holes = _kept_outline(border, lattice), _kept_holes(border, lattice)
    return tuple(pin_set(pin, corners, f"pins[{k}]", holes) for k, pin in enumerate(pins))


@lru_cache(maxsize=KEPT_OUTLINES)
def _check_placed_pins(pins: tuple[Pins, ...], border: Border, lattice: Lattice) -> None:
    """The checks of pins that are not moved onto arms."""
    check_pins(_placed_pins(pins, border, lattice), _kept_outline(border, lattice), _kept_holes(border, lattice))


def check_pins(pins: tuple[PinSet, ...], corners: Floats, holes: tuple[Floats, ...] = ()) -> None:
    """Refuse pins in holes, that contradict each other or pull too far, on a sheet with the outline (B, 2) mm."""
    for number, pin in enumerate(pins):
        in_hole = [point for point in pin.points if any(_in_hole(point, hole) for hole in holes)]
        if in_hole:
            problem = "must be on the sheet, not in a hole"
            raise DesignError(f"pins[{number}]", problem, in_hole[0].round(4).tolist(), place_mm=in_hole[0])
    edges = SheetEdges.of(corners, holes)
    check_conflicts(pins, edges)
    check_reach(pins, edges)


def _in_hole(point: Floats, hole: Floats) -> bool:
    """Whether a point (2,) mm is in a hole (n, 2) and not on its edge."""
    on_edge = shapely.distance(shapely.linearrings(hole), shapely.points(point)) < ON_EDGE_MM
    return bool(inside(point[None], hole)[0]) and not on_edge


@lru_cache(maxsize=KEPT_OUTLINES)
def _check_tip_margin(border: Border, lattice: Lattice) -> None:
    """Refuse a margin in which whole stars would disappear."""
    corners, margin = _kept_outline(border, lattice), border.tip_margin_mm
    centres = lattice.sites.place(_kept_cells(border, lattice))
    distance = shapely.distance(shapely.linearrings(corners), shapely.points(centres))
    room = float(distance.min())
    if margin >= room:
        problem = f"must be below {room:.4g} mm, the distance of the outermost star from the outline"
        star = int(distance.argmin())
        raise DesignError("border.tip_margin_mm", problem, margin, stars=[star], place_mm=centres[star])


def _shortened(ends: Floats, part: Floats) -> Floats:
    """(A, 2) sizes at both ends of arms of which a part (A,) remains; `ends` (A, 2) are those of the whole arms."""
    return np.column_stack([ends[:, 0], ends[:, 0] + part * (ends[:, 1] - ends[:, 0])])


@lru_cache(maxsize=KEPT_OUTLINES)
def _check_mesh(edge: float, border: Border, lattice: Lattice) -> None:
    """Refuse mesh edges longer than the spacing, or too short for the memory of a computer."""
    corners, spacing = _kept_outline(border, lattice), lattice.spacing_mm
    if edge > spacing:
        raise DesignError("mesh.edge_mm", f"must be at most the spacing of the stars, {spacing:g}", edge)
    check_mesh_size(edge, corners)


def mesh_vertices(edge: float, corners: Floats) -> float:
    """About how many vertices a mesh of equilateral triangles has, with edges in mm, in the outline (B, 2) mm."""
    # half a vertex a triangle
    return float(shapely.area(shapely.polygons(corners)) / (np.sqrt(0.75) * edge**2))


def check_mesh_size(edge: float, corners: Floats) -> None:
    """Refuse mesh edges (mm) too short for the memory of a computer, on a sheet with the outline (B, 2) mm."""
    vertices = mesh_vertices(edge, corners)
    if vertices > MAX_VERTICES:
        allowed = np.ceil(100 * edge * np.sqrt(vertices / MAX_VERTICES)) / 100
        raise DesignError(
            "mesh.edge_mm",
            f"makes about {vertices:.0f} vertices, at most {MAX_VERTICES} are allowed: use {allowed:g} or more",
            edge,
        )
