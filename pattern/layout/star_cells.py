"""Which cells of the lattice carry a star, and the sizes of the stars, with their limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.border import MAX_SHEET_MM, Border, DrawnCircle, check_ring
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.section import FACES
from asterism.pattern.design.sizing.profiles import sample
from asterism.pattern.design.stars import MIN_ARM_MM, ROD_SIZES, Override, Site, Stars
from asterism.pattern.geometry.planar import polygon_area, shown_place

_SIGN = {"up": 1, "down": -1, "free": 0}
MAX_STARS_OF_DESIGN = 5000
# a curved outline is at most so far from the straight edges of the sheet
OUTLINE_CURVE_MM = 0.1


def star_margin_mm(border: Border, lattice: Lattice) -> float:
    """Smallest distance (mm) of a star's centre to the outline, unless `rings` gives it."""
    return lattice.spacing_mm / 2 if border.star_margin_mm is None else border.star_margin_mm


def star_cells(border: Border, lattice: Lattice, corners: Floats, holes: Sequence[Floats]) -> Ints:
    """(n, 2) lattice cells with a star, from the origin outwards, counterclockwise at equal distance.

    Raises `DesignError` if the outline has room for more than `MAX_STARS_OF_DESIGN` stars.
    """
    sites = lattice.sites
    if border.rings is not None:
        i, j = sites.cells_within(*_box(corners)).T
        # i + j is the third hexagonal coordinate
        ring = np.max(np.abs([i, j, i + j]), axis=0)
        cells = np.column_stack([i, j])[ring <= border.rings]
    else:
        _check_count(lattice, corners)
        cells = sites.cells_within(*_box(corners))
        margin = star_margin_mm(border, lattice)
        centres = shapely.points(sites.place(cells))
        sheet = shapely.polygons(corners)
        shapely.prepare(sheet)
        inside = shapely.covers(sheet, centres)
        # A star exactly at the margin stays, whatever the rounding error.
        inside[inside] = shapely.distance(sheet.exterior, centres[inside]) >= margin * (1 - 1e-9)
        cells = cells[inside]
    if holes:
        away = shapely.distance(
            shapely.MultiPolygon([shapely.Polygon(hole) for hole in holes]), shapely.points(sites.place(cells))
        )
        cells = cells[away >= star_margin_mm(border, lattice) * (1 - 1e-9)]
    if len(cells) > MAX_STARS_OF_DESIGN:
        raise DesignError("border", f"must hold at most {MAX_STARS_OF_DESIGN} stars, not {len(cells)}")
    x, y = sites.place(cells).T
    distance = np.round(np.hypot(x, y) / lattice.spacing_mm, 6)
    angle = np.round(np.arctan2(y, x), 6) % round(2 * np.pi, 6)  # a star on the x axis comes first, despite rounding
    return np.asarray(cells[np.lexsort((angle, distance))])


def _box(corners: Floats) -> tuple[Floats, Floats]:
    return corners.min(axis=0), corners.max(axis=0)


def _check_count(lattice: Lattice, corners: Floats) -> None:
    """Refuse outlines with far too many cells, before the cells are listed."""
    low, high = _box(corners)
    cell = abs(np.linalg.det(lattice.vectors))
    cells = float(shapely.area(shapely.polygons(corners))) / cell
    # all cells in the box around the sheet are listed before those outside the outline are dropped
    if cells > 20 * MAX_STARS_OF_DESIGN or np.prod(high - low) / cell > 5_000_000:
        raise DesignError("border", f"must hold at most {MAX_STARS_OF_DESIGN} stars, not about {cells:.0f}")


def outline(border: Border, lattice: Lattice) -> Floats:
    """(B, 2) mm, corners of the sheet, counterclockwise.

    Raises `DesignError` if the hexagon of `border.rings` does not fit the lattice, or is too large.

    >>> outline(Border(rectangle_mm=(4.0, 2.0)), Lattice()).tolist()
    [[-2.0, -1.0], [2.0, -1.0], [2.0, 1.0], [-2.0, 1.0]]
    """
    if border.rings is not None:
        return _hexagon(border.rings, lattice)
    if border.rectangle_mm is not None:
        return np.asarray(np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.asarray(border.rectangle_mm) / 2)
    if border.rods is not None:
        raise DesignError("border.rods", "is an outline for asterism simulate alone", border.rods)
    if border.circle_mm is not None:
        return _ellipse(border.circle_mm)
    corners = np.asarray(border.polygon_mm)
    if border.curve_key is not None:
        from asterism.pattern.rods.curves import curved_outline  # slow to import; most outlines have straight edges

        corners, field = curved_outline(border, OUTLINE_CURVE_MM), f"border.{border.curve_key}"
        check_ring(corners, field, getattr(border, border.curve_key))
        if border.bulge_mm and polygon_area(corners) * polygon_area(np.asarray(border.polygon_mm)) <= 0:
            raise DesignError(field, "must not reach beyond the opposite corners", border.bulge_mm)
    return corners if shapely.is_ccw(shapely.linearrings(corners)) else corners[::-1].copy()


def corner_numbers(border: Border, ring: Floats) -> Ints:
    """(k,) numbers of the points of an outline (B, 2) that the design gives; between them may be points of curves."""
    if border.curve_key is None:
        return np.arange(len(ring))
    given = np.asarray(border.spline_mm or border.polygon_mm)
    return np.flatnonzero(np.isin(ring @ [1, 1j], given @ [1, 1j]))


def _ellipse(circle: DrawnCircle) -> Floats:
    """(B, 2) mm, corners on a circle or an ellipse; a multiple of 12, for the symmetries of lattices."""
    step = 2 * np.arccos(1 - OUTLINE_CURVE_MM / max(circle.half_axes))
    angle = np.linspace(0, 2 * np.pi, 12 * int(np.ceil(2 * np.pi / (12 * step))), endpoint=False)
    return circle.at(angle)


def _hexagon(rings: int, lattice: Lattice) -> Floats:
    """(6, 2) mm, the hexagon around some rings of stars."""
    if lattice.kind != "triangular":
        raise DesignError("border.rings", 'needs lattice.kind = "triangular"', rings)
    if lattice.origin_mm != (0.0, 0.0):
        raise DesignError("lattice.origin_mm", "must be [0, 0] with border.rings", lattice.origin_mm)
    # 15 mm beyond the outermost star's centre for the paper's spacing of 10 sqrt(3) mm
    radius = lattice.spacing_mm * (rings + 1.5 / np.sqrt(3.0))
    if radius > MAX_SHEET_MM:
        raise DesignError("border.rings", f"must make a sheet of at most {MAX_SHEET_MM:g} mm", rings)
    angle = np.radians(30 + 60 * np.arange(6))
    return np.asarray(radius * np.column_stack([np.cos(angle), np.sin(angle)]))


@dataclass(frozen=True)
class StarSizes:
    """Sizes at the stars of a lattice, before they are rounded for a printer. Removed stars have length 0."""

    length: Floats  # (S,) mm
    sections: Floats  # (S, arms, 2, K) `ROD_SIZES` at the centre and at the tip of each arm
    branch: Ints  # (S,) 1 for stars that start up, -1 for those that start down, 0 for those that start flat
    side: Ints  # (S,) 1 for stars above the fabric, -1 for those below
    ignored_sites: Ints  # (k, 2) sites of overrides that are off the sheet

    @property
    def at_centres(self) -> Floats:
        """(S, K + 1) `STAR_SIZES`: length of the arms, and their sections at the star's centre."""
        return np.column_stack([self.length, self.sections[:, 0, 0]])


def star_sizes(stars: Stars, sites: Ints, lattice: Lattice) -> StarSizes:
    """The sizes of all stars; an arm is at most as long as the spacing.

    Raises `DesignError` if a size is out of its range, or an entry of `stars.override` fits no star. The message names
    the first such star.
    """
    centres, spacing, arm_directions = lattice.sites.place(sites), lattice.spacing_mm, lattice.arm_directions
    field = "stars.length_mm" if stars.length_fraction is None else "stars.length_fraction"
    if stars.length_mm is not None:
        length = sample(stars.length_mm, centres)
    else:
        assert stars.length_fraction is not None  # a section has one of both
        length = spacing * sample(stars.length_fraction, centres)
    changes, ignored = _changes(stars, sites, centres, lattice)
    _set_own(length, changes, "length_mm", (0.0, spacing), centres)
    tips = centres[:, None, :] + np.clip(np.nan_to_num(length), 0, spacing)[:, None, None] * arm_directions
    both = np.stack([np.broadcast_to(centres[:, None, :], tips.shape), tips], axis=2)
    at = both if stars.vary_along_arms else np.broadcast_to(both[:, :, :1], both.shape)
    fields = [sample(getattr(stars, size.key), at.reshape(-1, 2)).reshape(at.shape[:-1]) for size in ROD_SIZES]
    sections = np.stack(fields, axis=-1)
    for k, size in enumerate(ROD_SIZES):
        _set_own(sections[..., k], changes, size.key, size.limits, centres)
    branch = np.full(len(centres), _SIGN[stars.branch], dtype=np.int64)
    side = np.full(len(centres), FACES[stars.side], dtype=np.int64)
    for star, (_, entry) in changes.items():
        if entry.branch is not None:
            branch[star] = _SIGN[entry.branch]
        if entry.side is not None:
            side[star] = FACES[entry.side]
        if entry.remove:
            length[star] = 0.0

    unit = 1.0 if stars.length_fraction is None else spacing
    _check(field, length / unit, (0.0, spacing / unit), centres)
    printed = np.flatnonzero(length >= MIN_ARM_MM)
    for k, size in enumerate(ROD_SIZES):
        _check(f"stars.{size.key}", sections[printed, ..., k], size.limits, centres[printed], printed)
    sections = np.minimum(sections, [size.limits[1] for size in ROD_SIZES])
    return StarSizes(np.minimum(length, spacing), sections, branch, side, ignored)


def site_of(entry: Override, sites: Ints, lattice: Lattice) -> Site | None:
    """The lattice site of an entry of `stars.override`; None if it names none of the stars at sites (S, 2)."""
    if entry.star is not None:
        return tuple(sites[entry.star].tolist()) if entry.star < len(sites) else None
    return entry.site if entry.at_mm is None else tuple(lattice.sites.nearest(np.array([entry.at_mm]))[0].tolist())


# entries of `stars.override` and their names in messages, by the numbers of their stars
_Changes = dict[int, tuple[str, Override]]


def _changes(stars: Stars, sites: Ints, centres: Floats, lattice: Lattice) -> tuple[_Changes, Ints]:
    """The entries of `stars.override`, at most one a star, and (k, 2) the sites of those that are off the sheet."""
    changes: _Changes = {}
    ignored: dict[Site, None] = {}
    number_at = {(i, j): number for number, (i, j) in enumerate(sites.tolist())}
    for number, entry in enumerate(stars.override):
        name = f"stars.override[{number}]"
        site = site_of(entry, sites, lattice)
        if site is None:
            raise DesignError(f"{name}.star", f"must be at most {len(centres) - 1}, the last star", entry.star)
        star = number_at.get(site)
        if entry.at_mm is not None:
            away = np.linalg.norm(centres - entry.at_mm, axis=1)
            # a star is meant if it is too close to be mistaken for a neighbour
            if star is None or away[star] > 0.1 * lattice.spacing_mm:
                x, y = centres[int(away.argmin())]
                message = f"has no star there, the nearest is at [{x:.3f}, {y:.3f}]"
                raise DesignError(f"{name}.at_mm", message, entry.at_mm, place_mm=entry.at_mm)
        if star is None:
            if site in ignored:
                raise DesignError(name, f"changes site {list(site)} again: write its changes in one entry")
            ignored[site] = None
        elif star in changes:
            again = f"changes star {star} again: write its changes in one entry"
            raise DesignError(name, again, stars=[star], place_mm=centres[star])
        else:
            changes[star] = name, entry
    return changes, np.array(list(ignored), dtype=np.int64).reshape(-1, 2)


def _set_own(values: Floats, changes: _Changes, key: str, limits: tuple[float, float], centres: Floats) -> None:
    """Set the sizes (S, ...) of the stars whose entry has this key, if they are within the limits."""
    own = {star: size for star, (_, entry) in changes.items() if (size := getattr(entry, key)) is not None}
    stars, sizes = list(own), np.array(list(own.values()))
    _check([f"{changes[star][0]}.{key}" for star in stars], sizes, limits, centres[stars], stars)
    values[stars] = sizes.reshape(-1, *[1] * (values.ndim - 1))


def _check(
    field: str | Sequence[str],
    values: Floats,
    limits: tuple[float, float],
    centres: Floats,
    numbers: Sequence[int] | Ints | None = None,
) -> None:
    """Refuse values (S, ...) outside the limits; the message names the first such star, and its field."""
    low, high = limits
    # a size may exceed its upper limit a little, as a spacing written with seven digits does
    allowed = (values >= low) & (values <= high + 1e-6 * high)
    refused = np.flatnonzero(~allowed.all(axis=tuple(range(1, allowed.ndim))))
    if len(refused) == 0:
        return
    star, place = refused[0], centres[refused[0]]
    value = float(values[star][~allowed[star]].flat[0])
    number = star if numbers is None else numbers[star]
    allowed_range = f"must be from {low:g} to {high:.6g} at star {number} at {shown_place(place)}"
    name = field if isinstance(field, str) else field[star]
    raise DesignError(name, allowed_range, value, stars=[number], place_mm=place)
