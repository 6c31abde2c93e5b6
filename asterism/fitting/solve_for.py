"""`asterism.solve_for` and `solve_for_point`: a design whose preview has a wanted size, or comes to a wanted point."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from typing import Any, Literal, get_args

import numpy as np
from scipy.optimize import brentq, least_squares

from asterism.equilibrium.arrays import Floats
from asterism.fitting.errors import ReachError, place_text
from asterism.fitting.star_menu import MIN_FITTED_ARM_MM
from asterism.homogenize.law.axes import AXES
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import with_entries
from asterism.pattern.design.section import is_whole
from asterism.pattern.geometry.planar import inside
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import SIZE_KEYS, with_painted_stars
from asterism.previews.law_choice import serving_law
from asterism.previews.session import Preview, preview
from asterism.previews.star_sensitivity import SizeName
from asterism.process.listeners import Say, ignore_line

Wanted = Literal["height_mm", "roll_radius_mm"]
# factors of the sizes that are tried to enclose the value, over the whole range of the law
TRIED_FACTORS = 9
# relative precision of the wanted value, and of the factor
WANTED_TOLERANCE, FACTOR_TOLERANCE = 2e-3, 1e-5
# decimals of mm of the sizes
SOLVED_DECIMALS = 4


def solve_for(
    design: Design,
    wanted: Wanted,
    value: float,
    change: SizeName = "length_mm",
    law: StarLaw | None = None,
    say: Say | None = None,
) -> Design:
    """Scale one size of all stars so that the preview has a wanted height or radius.

    Every trial is a fresh preview. Of several solutions, the one with the smallest change of the sizes is returned.
    `solve_for_point` moves a needle instead, so that the sheet comes to a wanted point.

    Parameters
    ----------
    design : from `load_design`, `new` or `Design.from_dict`.
    wanted : `height_mm`, the extent along z (of a free sheet: across its mean plane), or `roll_radius_mm`, the radius
        of a sheet that rolls up.
    value : of the wanted quantity, in mm.
    change : the size that is scaled; within the range of the law.
    law : of the material; by default the one that the design names, or else that of the paper's material.
    say : called with a line of text for each trial.

    Returns
    -------
    The design, with one `stars.override` a star.

    Raises
    ------
    ReachError
        No scale of the sizes gives the value; the message names the values that occur.
    DesignError, MeshError, LawError
        As for `Preview`.
    ValueError
        `wanted`, `value` or `change` is not one of those named above.

    Examples
    --------
    >>> from asterism.previews.session import preview
    >>> from asterism.pattern import gallery
    >>> tube = solve_for(gallery.load("tube"), "roll_radius_mm", 25.0)
    >>> round(preview(tube).summary.roll_radius_mm)
    25
    """
    check_type(design, Design, "load_design reads one from a file")
    for name, given, allowed in (("wanted", wanted, get_args(Wanted)), ("change", change, SIZE_KEYS)):
        if given not in allowed:
            raise ValueError(f"{name} = {given!r}: must be {' or '.join(allowed)}")
    if not (isinstance(value, int | float) and np.isfinite(value) and value > 0.0):
        raise ValueError(f"value = {value!r}: must be a number of mm above 0")
    law, tell, plan = law or serving_law(design), say or ignore_line, layout(design)
    column = SIZE_KEYS.index(change)
    sizes = plan.star_sizes_mm[:, column]
    low, high = law.size_ranges(law.check(design).stretch)[AXES[column].key]
    low = max(low, MIN_FITTED_ARM_MM) if change == "length_mm" else low

    def scaled(factor: float) -> Design:
        """The design with sizes scaled, within the law's range."""
        changed: Floats = np.full((len(sizes), len(SIZE_KEYS)), np.nan)
        changed[:, column] = np.clip(factor * sizes, low, high).round(SOLVED_DECIMALS)
        return with_painted_stars(design, plan.sites, changed)

    @cache
    def measured(factor: float) -> float:
        """The wanted quantity of a fresh preview; nan for a sheet that is not rolled."""
        shape = preview(scaled(factor), law)
        found: Any = shape.height_mm if wanted == "height_mm" else shape.summary["roll_radius_mm"]
        found = np.nan if found is None else float(found)
        tell(f"{change} times {factor:.4f}: {wanted} = {found:.3f}")
        return float(found)

    def miss(factor: float) -> float:
        if not np.isfinite(measured(factor)):
            raise ValueError("not rolled")
        return measured(factor) - value

    ends = min(low / sizes.max(), 1.0), max(high / sizes.min(), 1.0)
    tried = sorted({1.0, *np.geomspace(*ends, TRIED_FACTORS).tolist()})
    values = [measured(factor) for factor in tried]
    pairs = zip(pairwise(tried), pairwise(values), strict=True)
    enclosing = [ends for ends, (first, last) in pairs if (first - value) * (last - value) <= 0.0]
    # of several solutions the one whose factor is nearest to 1
    for a, b in sorted(enclosing, key=lambda ends: min(abs(np.log(ends[0])), abs(np.log(ends[1])))):
        try:
            factor = float(brentq(miss, a, b, xtol=FACTOR_TOLERANCE, rtol=FACTOR_TOLERANCE))
        except ValueError:  # a trial between is not rolled
            continue
        if abs(miss(factor)) <= WANTED_TOLERANCE * value:
            return scaled(factor)
    known = [found for found in values if np.isfinite(found)]
    if not known:
        raise ReachError(f"{wanted} = {value:g}: the sheet does not roll up for any {change}")
    jumps = ", where the sheet jumps from one form to another" if enclosing else ""
    raise ReachError(
        f"{wanted} = {value:g}: is not reached by scaling {change}{jumps}; "
        f"it is {min(known):.3g} to {max(known):.3g} mm over the range of the law"
    )


# mm, distance from the wanted point within which the sheet has come to it
POINT_TOLERANCE_MM = 0.02
# mm, move of the needle that gives the derivatives: the sheet's response is linear over much more
NEEDLE_STEP_MM = 0.2
# most trials of the search; each takes a derivative of four previews
MAX_NEEDLE_TRIALS = 25
# decimals of mm of the needle's place
NEEDLE_DECIMALS = 4


def solve_for_point(
    design: Design,
    at_mm: Sequence[float],
    point_mm: Sequence[float],
    needle: int = 0,
    law: StarLaw | None = None,
    say: Say | None = None,
) -> Design:
    """Move one needle so that a printed point of the sheet comes to a wanted point in space.

    Parameters
    ----------
    design : from `load_design`, `new` or `Design.from_dict`; needles hold it at places `target_mm`.
    at_mm : (x, y) of the point on the print.
    point_mm : (x, y, z) where the preview should have it, with the bumps of the stars.
    needle : number of the needle, counted from 0 over all `target_mm` of points and corners in the design file.
    law : of the material; by default the one that the design names, or else that of the paper's material.
    say : called with a line of text for each trial.

    Returns
    -------
    The design with another `target_mm` of this needle; a fresh preview confirms it.

    Raises
    ------
    ReachError
        No place of the needle brings the sheet there; the message names the nearest point that it reaches.
    DesignError, MeshError, LawError
        As for `Preview`.
    ValueError
        There is no such needle, or the places are not finite numbers on the sheet and in space.

    Examples
    --------
    >>> corners, middle = {"corners": [0, 2, 4], "scale": 0.75}, {"points_mm": [[0, 0]], "target_mm": [[0, 0, 16]]}
    >>> canopy = Design.from_dict({"stars": {"length_mm": 7.0}, "border": {"rings": 2}, "pins": [corners, middle]})
    >>> raised = solve_for_point(canopy, (12.0, 0.0), (9.0, 0.0, 20.0))
    >>> bool(np.abs(preview(raised).at(np.array([[12.0, 0.0]]))[0] - [9.0, 0.0, 20.0]).max() < 0.02)
    True
    """
    check_type(design, Design, "load_design reads one from a file")
    at, point = _place("at_mm", at_mm, 2), _place("point_mm", point_mm, 3)
    places = _needles(design)
    if not places:
        raise ValueError("design: needles with target_mm are needed")
    if not (is_whole(needle) and 0 <= needle < len(places)):
        raise ValueError(f"needle = {needle!r}: must be a whole number from 0 to {len(places) - 1}")
    table, row, start = places[needle]
    law, tell = law or serving_law(design), say or ignore_line
    session = Preview(design, law)
    if not inside(at[None], session.sheet.layout.outline)[0]:
        raise ValueError(f"at_mm = {at.tolist()}: must be on the sheet")

    def moved(place: Floats) -> Design:
        return Design.from_dict(with_entries(design.to_dict(), {f"pins.{table}.target_mm.{row}": place.tolist()}))

    def miss(place: Floats) -> Floats:
        return np.asarray(session.update(moved(place)).at(at[None])[0] - point)

    def derivatives(place: Floats) -> Floats:
        here = miss(place)
        tell(f"needle {needle} at {place_text(place)}: {np.linalg.norm(here):.3f} mm from the point")
        steps = NEEDLE_STEP_MM * np.eye(3)
        return np.column_stack([(miss(place + step) - here) / NEEDLE_STEP_MM for step in steps])

    found = least_squares(miss, start, derivatives, gtol=0.1 * POINT_TOLERANCE_MM, max_nfev=MAX_NEEDLE_TRIALS)
    result = moved(found.x.round(NEEDLE_DECIMALS))
    reached = preview(result, law).at(at[None])[0]
    if np.linalg.norm(reached - point) > POINT_TOLERANCE_MM:
        raise ReachError(
            f"point_mm = {place_text(point)}: needle {needle} cannot bring the sheet there; "
            f"it comes to {place_text(reached)}, {np.linalg.norm(reached - point):.2g} mm away"
        )
    return result


def _place(name: str, value: Any, count: int) -> Floats:
    try:
        place = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        place = np.empty(0)
    if place.shape != (count,) or not np.isfinite(place).all():
        raise ValueError(f"{name} = {value!r}: must be {count} numbers of mm")
    return place


def _needles(design: Design) -> list[tuple[int, int, Floats]]:
    """Number of the entry of pins, number within it, and place (3,) of each needle."""
    return [
        (table, row, np.asarray(place, dtype=float))
        for table, pins in enumerate(design.pins)
        if pins.edges is None and pins.where is None
        for row, place in enumerate(pins.target_mm or ())
    ]
