"""From a design to its layout: stars, arms, border and pins in mm."""

from __future__ import annotations

import numpy as np
import shapely

from pattern.design.arguments import check_kind
from pattern.design.border import outline, star_cells, star_margin_mm
from pattern.design.design import Design
from pattern.design.errors import DesignError
from pattern.design.pins import pin_set, taken_to_arms
from pattern.design.stars import SHORTEST_ARM_MM, sizes
from pattern.geometry.arrays import Floats
from pattern.layout.layout import Layout
from pattern.layout.pin_agreement import check_agreement
from pattern.rods.arms import check_clear, cut

MOST_VERTICES = 400_000
_MEETING = 1e-6  # of the spacing: ends of arms that are the same point but for rounding


def layout(design: Design) -> Layout:
    """What the design prints and where it is held; `DesignError` if it cannot be printed.

    Every model begins here, so that what is not a design is refused here: `TypeError`.
    """
    check_kind(design, Design, "load_design reads one from a file, Design.from_dict makes one of a dict")
    lattice = design.lattice
    corners = outline(design.border, lattice)
    _check_mesh(design.mesh.edge_mm, lattice.spacing_mm, corners)

    cells = star_cells(design.border, lattice, corners)
    if len(cells) == 0:
        within = f"border.star_margin_mm = {star_margin_mm(design.border, lattice):.4g} from its outline"
        raise DesignError("border", f"must have room for at least one star, {within}")
    centres = lattice.place(cells)
    _check_tip_margin(design.border.tip_margin_mm, centres, corners)
    directions = lattice.arm_directions
    size = sizes(design.stars, centres, lattice.spacing_mm, directions)

    star, arm = (index.ravel() for index in np.indices((len(cells), lattice.arms)))
    tips = centres[star] + size.length[star, None] * directions[arm]
    printed = size.length[star] >= SHORTEST_ARM_MM
    star, arm, tips = star[printed], arm[printed], tips[printed]
    thickness, width = size.thickness[star, arm], size.width[star, arm]

    full, (tips, too_long) = tips, cut(centres[star], tips, corners, design.border.tip_margin_mm)
    if len(too_long) and design.border.overhang == "refuse":
        x, y = centres[star[too_long[0]]]
        raise DesignError(
            "border.overhang",
            f"lets no arm leave the sheet (keeping {design.border.tip_margin_mm:g} mm), but one of star "
            f"{star[too_long[0]]} at [{x:.2f}, {y:.2f}] does",
            design.border.overhang,
        )
    left = np.linalg.norm(tips - centres[star], axis=1) / np.linalg.norm(full - centres[star], axis=1)
    thickness, width = (_shortened(ends, left) for ends in (thickness, width))
    long_enough = left * size.length[star] >= SHORTEST_ARM_MM
    star, tips, thickness, width = (part[long_enough] for part in (star, tips, thickness, width))
    if (rounding := design.stars.rounding) is not None:
        thickness, width = rounding.thickness(thickness), rounding.width(width)
    if len(star) == 0:
        longest = float(size.length.max(initial=0.0))
        problem = f"must have at least one arm of {SHORTEST_ARM_MM:g} mm on the sheet"
        raise DesignError("stars", f"{problem}; the longest of the design is {longest:.3g} mm")
    check_clear(centres[star], tips, star, width, _MEETING * lattice.spacing_mm)

    sets = [pin_set(pin, corners, f"pins[{k}]") for k, pin in enumerate(design.pins)]
    pins = tuple(taken_to_arms(pin, corners, centres[star], tips) for pin in sets)
    check_agreement(pins, corners)
    kept, star = np.unique(star, return_inverse=True)
    return Layout(
        border=corners,
        centres=centres[kept],
        arm_star=star,
        arm_tip=tips,
        arm_thickness=thickness,
        arm_width=width,
        neighbours=lattice.neighbours(cells[kept]),
        pins=pins,
        lattice_vectors=lattice.vectors,
        lattice_origin=np.asarray(lattice.origin_mm),
        star_branch=size.branch[kept],
        star_number=kept,
    )


def _check_tip_margin(margin: float, centres: Floats, corners: Floats) -> None:
    """Refuse a margin that whole stars lie in: they would vanish."""
    room = float(shapely.distance(shapely.linearrings(corners), shapely.points(centres)).min())
    if margin >= room:
        problem = f"must be below {room:.4g} mm, what the outermost star is from the outline"
        raise DesignError("border.tip_margin_mm", problem, margin)


def check_carried(design: Design, plan: Layout) -> None:
    """Refuse a shape of what would fall: the first pins have to stop it along every axis that weight pulls."""
    if not design.gravity.on:
        return
    if not plan.pins:
        raise DesignError("gravity.on", "needs [[pins]] to hold the sheet: a free one falls", True)
    first = min(pins.step for pins in plan.pins)
    held = np.array([pins.fixed for pins in plan.pins if pins.step == first]).any(axis=0)
    falls = ~held & (np.abs(design.gravity.direction) > 1e-6 * np.linalg.norm(design.gravity.direction))
    if falls.any():
        along = " and ".join(axis for axis, free in zip("xyz", falls, strict=True) if free)
        problem = f"needs [[pins]] that do not slide along {along}, among the first: the sheet falls"
        raise DesignError("gravity.on", problem, True)


def _shortened(ends: Floats, left: Floats) -> Floats:
    """(A, 2) sizes at both ends of arms of which the fraction `left` remains."""
    return np.column_stack([ends[:, 0], ends[:, 0] + left * (ends[:, 1] - ends[:, 0])])


def _check_mesh(edge: float, spacing: float, corners: Floats) -> None:
    if edge > spacing:
        raise DesignError("mesh.edge_mm", f"must be at most the spacing of the stars, {spacing:g}", edge)
    # equilateral triangles of this edge have half a vertex each
    area = float(shapely.area(shapely.polygons(corners)))
    vertices = area / (np.sqrt(0.75) * edge**2)
    if vertices > MOST_VERTICES:
        allowed = np.ceil(100 * edge * np.sqrt(vertices / MOST_VERTICES)) / 100
        raise DesignError(
            "mesh.edge_mm",
            f"makes about {vertices:.0f} vertices, at most {MOST_VERTICES} are allowed: use {allowed:g} or more",
            edge,
        )
