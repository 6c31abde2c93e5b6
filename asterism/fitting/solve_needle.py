"""`asterism.solve_for_point`: where a needle must stand so that the sheet comes to a wanted point."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from asterism.equilibrium.arrays import Floats
from asterism.fitting.errors import ReachError, place_text
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import with_entries
from asterism.pattern.design.section import is_whole
from asterism.pattern.geometry.planar import inside
from asterism.previews.law_choice import serving_law
from asterism.previews.session import Preview, preview
from asterism.process.listeners import Say, ignore_line

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
