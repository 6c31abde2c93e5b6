"""Warnings that a design deserves before any model: its supports, its entries for sites, its sizing profiles."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from asterism.pattern.design.design import Design
from asterism.pattern.design.sizing.profiles import GradientProfile
from asterism.pattern.design.stars import SIZE_KEYS
from asterism.pattern.layout.free_motions import count_free_tilts
from asterism.pattern.layout.layout import Layout


def pin_warnings(layout: Layout, weighs: bool) -> Iterator[str]:
    """Yield one line for each warning; weight determines how a sheet hangs."""
    yield from held_wide(layout)
    if layout.pins and not weighs and (axes := count_free_tilts(layout)):
        about = "a point" if axes > 1 else "a line"
        yield f"the pins let the sheet turn about {about}: its orientation, and with it its height, is arbitrary"


def held_wide(layout: Layout) -> Iterator[str]:
    """Yield a line if the pins pull the sheet wider than it was printed, often by a scale given in percent."""
    printed, places, _ = layout.support_samples
    held = ~np.isnan(places[:, :2]).any(axis=1)
    if not held.any():
        return
    places = np.nan_to_num(places)  # points that slide along z count with height 0
    in_print, in_space = (np.linalg.norm(points[held] - points[held].mean(axis=0)) for points in (printed, places))
    # size of the supports in space over their size in print, above which a warning appears
    if in_space > 1.05 * in_print > 0.0:
        wide = f"{in_space / in_print:.3g} times as wide as it was printed"
        yield f"the pins hold the sheet {wide}: its fabric is stretched further than on the printer"


# a warning lists at most this many sites
MAX_NAMED_SITES = 5


def site_warnings(layout: Layout) -> Iterator[str]:
    """Yield a line if entries of `stars.override` are for sites outside of the sheet."""
    if not (count := len(layout.ignored_sites)):
        return
    named = ", ".join(str(site) for site in layout.ignored_sites[:MAX_NAMED_SITES].tolist())
    more = ", ..." if count > MAX_NAMED_SITES else ""
    entries = "1 entry of stars.override is" if count == 1 else f"{count} entries of stars.override are"
    yield f"{entries} for sites outside of the sheet, and ignored: {named}{more}"


# part of the way from `from` to `to` below which a profile counts as constant
MIN_SPANNED_PART = 0.02


def sizing_warnings(design: Design, layout: Layout) -> Iterator[str]:
    """Yield a line for each profile whose stars all have nearly one of its two end values."""
    if len(layout.centres) < 2:
        return
    for name in ("length_fraction", *SIZE_KEYS):
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
