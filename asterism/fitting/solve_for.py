"""`solve_for`, `solve_for_point` and `sensitivity`: what sizes and needles do to a preview, and which are needed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq, least_squares

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fitting.disk import place_text
from asterism.fitting.reach import MIN_FITTED_ARM_MM, ReachError
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import with_entries
from asterism.pattern.design.errors import DesignError, check_type
from asterism.pattern.design.section import is_whole
from asterism.pattern.design.stars import SIZE_KEYS, SIZE_OF, SizeName
from asterism.pattern.geometry.planar import inside
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import size_rows, with_painted_stars
from asterism.previews.law_choice import law_around, law_of, serving_law
from asterism.previews.session import Preview, preview
from asterism.previews.star_sensitivity import size_steps
from asterism.process.progress import Say, ignore_line
from asterism.shape.shape import Shape

Wanted = Literal["height_mm", "roll_radius_mm"]


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
    change : the size that is scaled; within the range of the law, or to between half and twice where cells are solved
        for each trial.
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
    tell, plan = say or ignore_line, layout(design)
    sizes = plan.star_sizes_mm[:, SIZE_KEYS.index(change)]
    serving: Law[Any] = law or serving_law(design)
    of_trials: Law[Any] | None = serving
    low, high = serving.size_ranges(serving.check(design).stretch)[change]
    if law is None and serving is not law_of(design):  # cells are solved for each trial
        of_trials = None
        least, most = SIZE_OF[change].limits_at(plan.spacing_mm)
        low, high = max(least, 0.5 * float(sizes.min())), min(most, 2.0 * float(sizes.max()))
    low = max(low, MIN_FITTED_ARM_MM) if change == "length_mm" else low

    def scaled(factor: float) -> Design:
        """The design with sizes scaled, within their range."""
        changed = np.clip(factor * sizes, low, high).round(4)
        return with_painted_stars(design, plan.sites, size_rows({change: changed}))

    @cache
    def measured(factor: float) -> float:
        """The wanted quantity of a fresh preview; nan for a sheet that is not rolled, or whose arms meet."""
        try:
            shape = preview(scaled(factor), of_trials)
        except DesignError:
            return float(np.nan)
        found: Any = shape.height_mm if wanted == "height_mm" else shape.summary["roll_radius_mm"]
        found = np.nan if found is None else float(found)
        tell(f"{change} times {factor:.4f}: {wanted} = {found:.3f}")
        return float(found)

    def miss(factor: float) -> float:
        if not np.isfinite(measured(factor)):
            raise ValueError("not rolled")
        return measured(factor) - value

    ends = min(low / sizes.max(), 1.0), max(high / sizes.min(), 1.0)
    # factors over the whole range of the law, to enclose the value
    tried = sorted({1.0, *np.geomspace(*ends, 9).tolist()})
    values = [measured(factor) for factor in tried]
    pairs = zip(pairwise(tried), pairwise(values), strict=True)
    enclosing = [ends for ends, (first, last) in pairs if (first - value) * (last - value) <= 0.0]
    # of several solutions the one whose factor is nearest to 1
    for a, b in sorted(enclosing, key=lambda ends: min(abs(np.log(ends[0])), abs(np.log(ends[1])))):
        try:
            factor = float(brentq(miss, a, b, xtol=1e-5, rtol=1e-5))
        except ValueError:  # a trial between is not rolled
            continue
        if abs(miss(factor)) <= 2e-3 * value:
            return scaled(factor)
    known = [found for found in values if np.isfinite(found)]
    if not known:
        raise ReachError(f"{wanted} = {value:g}: the sheet does not roll up for any {change}")
    jumps = ", where the sheet jumps from one form to another" if enclosing else ""
    raise ReachError(
        f"{wanted} = {value:g}: is not reached by scaling {change}{jumps}; "
        f"it is {min(known):.3g} to {max(known):.3g} mm for sizes of {low:g} to {high:g} mm"
    )


# mm, distance from the wanted point within which the sheet has come to it
POINT_TOLERANCE_MM = 0.02


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
        length = 0.2  # mm, the sheet's response is linear over much more
        return np.column_stack([(miss(place + step) - here) / length for step in length * np.eye(3)])

    # each trial takes a derivative of four previews
    found = least_squares(miss, start, derivatives, gtol=0.1 * POINT_TOLERANCE_MM, max_nfev=25)
    result = moved(found.x.round(4))
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


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """Derivatives of a quantity by one size of each star."""

    value: Floats  # (...) the quantity
    # (S, ...) its change per mm by which the size of each star grows. Where the quantity has a kink, as the height of a
    # symmetric sheet with several highest places, it may change differently when the size shrinks.
    derivatives: Floats
    stars: Ints  # (S,) numbers of the stars
    centres: Floats  # (S, 2) mm, their places on the print


def sensitivity(
    design: Design,
    of: Literal["height_mm"] | Callable[[Shape], ArrayLike] = "height_mm",
    by: SizeName = "length_mm",
    law: Law | None = None,
) -> Sensitivity:
    """Compute how a quantity of the preview changes with one size of each star.

    The sheet follows a small change of one star after the other by its linear response, with the bumps of the stars.
    Thicknesses and widths are those before a rounding of the design.

    Parameters
    ----------
    design : with stars; from `load_design`, `new` or `Design.from_dict`.
    of : `height_mm`, or a function of a `Shape` that gives a number or an array. The function may use all of the shape
        but its summary and its fields.
    by : `length_mm`, `thickness_mm` or `width_mm`. A size at the upper end of the law's range is changed downwards.
    law : as for `Preview`.

    Raises
    ------
    DesignError, MeshError, LawError
        As for `Preview`; or the law has cells of one such size only.
    ValueError
        `of` or `by` is not one of these, or the search finds no minimum.

    Examples
    --------
    >>> from asterism.pattern import gallery
    >>> found = sensitivity(gallery.load("star"), of=lambda shape: shape.at([[0.0, 0.0]])[0])
    >>> found.derivatives.shape
    (1, 3)
    """
    check_type(design, Design, "load_design reads one from a file")
    if not (of == "height_mm" or callable(of)):
        raise ValueError(f"of = {of!r}: must be 'height_mm' or a function of a shape")
    if by not in SIZE_KEYS:
        raise ValueError(f"by = {by!r}: must be {' or '.join(SIZE_KEYS)}")
    stars = design.required_stars.model_copy(update={"rounding": None})
    design = design.model_copy(update={"stars": stars})
    preview = Preview(design, law or _law_beside(design, by))
    low, high = preview.law.size_ranges(design.fabric.stretch_xy)[by]
    if low == high:
        raise LawError(f"the law is of one {by} only, {low:g}: it does not say how sheets change with it")
    if not preview.equilibrium.is_minimum:
        raise ValueError("the search finds no minimum, and only a minimum has derivatives")
    shown, plan = preview.shape(), preview.state.layout

    def quantity(x: Any) -> Floats:
        moved = replace(shown, positions=preview.at(shown.printed, x).bumpy)
        moved = moved if moved.held else moved.aligned()
        return np.asarray(moved.height_mm if of == "height_mm" else of(moved), dtype=float)  # type: ignore[operator]

    value, sizes = quantity(None), plan.star_sizes_mm[:, SIZE_KEYS.index(by)]
    changes = []
    for site, size, step in zip(plan.sites, sizes, size_steps(preview.state, by, sizes), strict=True):
        response = next(preview.edit(with_painted_stars(design, site[None], size_rows({by: size + step}))))
        changes.append((quantity(response.x) - value) / step)
    return Sensitivity(value, np.array(changes), plan.star_number, plan.centres)


def _law_beside(design: Design, by: SizeName) -> Any:
    """The law that serves a design, also beside the sizes that its stars have, so that it has derivatives by them."""
    law = serving_law(design)
    if law is law_of(design):
        return law
    # cells of other fabrics are solved where stars have their sizes; of smaller stars there is room for all
    plan = layout(design)
    sizes = plan.star_sizes_mm[:, SIZE_KEYS.index(by)]
    near = np.where(0.98 * sizes >= SIZE_OF[by].limits[0], 0.98, 1.02) * sizes
    return law_around(design, with_painted_stars(design, plan.sites, size_rows({by: near})))
