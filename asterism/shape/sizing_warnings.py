"""Warning of sizing profiles that change nothing over the sheet, such as a distance in another unit."""

from __future__ import annotations

from collections.abc import Iterator

from asterism.pattern.design.design import Design
from asterism.pattern.design.sizing.profile import GradientProfile
from asterism.pattern.layout.layout import Layout

# part of the way from `from` to `to` below which a profile counts as constant
MIN_SPANNED_PART = 0.02


def sizing_warnings(design: Design, layout: Layout) -> Iterator[str]:
    """Yield a line for each profile whose stars all have nearly one of its two end values."""
    if len(layout.centres) < 2:
        return
    for name in ("length_mm", "length_fraction", "thickness_mm", "width_mm"):
        profile = getattr(design.stars, name)
        if not isinstance(profile, GradientProfile) or profile.start == profile.end:
            continue
        part = profile.fraction(layout.centres).clip(0.0, 1.0)
        if part.max() < MIN_SPANNED_PART or part.min() > 1.0 - MIN_SPANNED_PART:
            key, value = ("from", profile.start) if part.max() < MIN_SPANNED_PART else ("to", profile.end)
            yield (
                f"stars.{name} varies from {profile.start:g} to {profile.end:g}, but all stars have nearly the value "
                f"of {key}, {value:g}: are the places and distances of the profile in mm?"
            )
