"""What remains between a fitted shape and its target: its parts, and its places."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Bools
from asterism.fitting.result import Fit
from asterism.pattern.geometry.planar import distance_to_outline

# of the spacing: width of the rim, about the reach of one star
RIM_WIDTH = 0.8
# a part of the sheet has most of the distance if its rms is this many times that of the rest
MAIN_FACTOR = 1.5
# of the range of lengths: sizes nearer to its ends count as at the end
END_SHARE = 1e-3


@dataclass(frozen=True)
class Remainder:
    """Parts of the rms distance in % of the diameter; their squares add up to that of the distance.

    Attributes
    ----------
    parts : by cause: rms distance, and a sentence about it. Parts that vanish are left out.
    places : name of a part of the sheet, and the rms distance there.
    advice : one sentence for each place or limit that has most of the distance.
    """

    parts: dict[str, tuple[float, str]]
    places: dict[str, float]
    advice: tuple[str, ...]


def remainder(fitted: Fit) -> Remainder:
    """What remains of the distance of a fit."""
    places, advice = _places(fitted)
    return Remainder(_parts(fitted), places, tuple(advice))


def _parts(fitted: Fit) -> dict[str, tuple[float, str]]:
    s = fitted.summary
    stars = s.preview if s.unrounded is None else s.unrounded
    cause = "The stars cannot come nearer: features smaller than a cell remain, and so does what supports do not hold."
    if s.needed_ratio > s.available_ratio:
        cause = (
            f"The target needs contractions of a ratio of {s.needed_ratio:.3f}, and stars give {s.available_ratio:.3f} "
            f"at stretch {s.stretch:g}. A larger stretch, a flatter target or a cut helps."
        )
    parts = {"stars": (stars.mean_percent, cause)}
    lost, between = _added(s.preview.mean_percent, stars.mean_percent), 0.0
    if s.exact is not None:
        between = _added(s.exact.mean_percent, s.preview.mean_percent)
        if s.corrections:  # then the loss by rounding is that of the exact shape
            unrounded = s.exact.mean_percent - (s.rounding_loss_percent or 0.0)
            lost, between = _added(s.exact.mean_percent, unrounded), _added(unrounded, stars.mean_percent)
    if lost:
        parts["rounding"] = (lost, "Thicknesses and widths are whole layers and lines of the printer.")
    if between:
        parts["model"] = (
            between,
            "The fit follows the preview, and the exact shape of the same design differs from it.",
        )
    final = s.exact or s.preview
    if bumps := _added(final.surface_percent, final.mean_percent):
        parts["bumps"] = (bumps, "The bumps of the stars, which the mean over a cell leaves out.")
    return parts


def _added(larger: float, smaller: float) -> float:
    """The part that is added to a distance, in quadrature; 0 if the distance does not grow."""
    return float(np.sqrt(max(larger**2 - smaller**2, 0.0)))


def _places(fitted: Fit) -> tuple[dict[str, float], list[str]]:
    shape, plan, s = fitted.shape, fitted.shape.layout, fitted.summary
    assert plan is not None
    rim_mm = RIM_WIDTH * fitted.guess.menu.spacing_mm
    in_rim = distance_to_outline(shape.printed, plan.outline) < rim_mm
    places = {f"within {rim_mm:.0f} mm of the outline": _rms(fitted, in_rim), "further inside": _rms(fitted, ~in_rim)}
    advice: list[str] = []
    rim, inside = places.values()
    if rim > MAIN_FACTOR * inside:
        advice.append("Most of the distance is at the rim." + (" More needles hold it." if s.needles else ""))
    ends = stars_at_ends(fitted)
    if ends.any() and not ends.all():
        nearest = cKDTree(plan.centres).query(shape.printed)[1]
        at_end, elsewhere = _rms(fitted, ends[nearest]), _rms(fitted, ~ends[nearest])
        places |= {"around stars with the shortest or longest arms": at_end, "around other stars": elsewhere}
        if at_end > MAIN_FACTOR * elsewhere:
            advice.append("Most of the distance is at stars whose arms are the shortest or longest of the law.")
    return places, advice


def stars_at_ends(fitted: Fit) -> Bools:
    """(S,) whether a star has the shortest or the longest arms that the law covers."""
    plan, menu = fitted.shape.layout, fitted.guess.menu
    assert plan is not None
    low, high = menu.lengths_mm[0], menu.lengths_mm[-1]
    room = END_SHARE * (high - low)
    lengths = plan.star_sizes_mm[:, 0]
    return np.asarray((lengths < low + room) | (lengths > high - room))


def _rms(fitted: Fit, part: Bools) -> float:
    weights = fitted.shape.weights * part
    mean_square = weights @ fitted.distance.mean_mm**2 / max(weights.sum(), 1e-300)
    return float(100.0 * np.sqrt(mean_square) / fitted.distance.diameter_mm)
