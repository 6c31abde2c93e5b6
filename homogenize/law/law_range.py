"""From which length on a law speaks of stars: shorter ones are joined to the bare fabric only if it is near."""

from __future__ import annotations

from collections.abc import Iterable

# part of the spacing. Up to arms of this length a sheet departs from bare fabric so smoothly that a curve from there to
# the first cell says what is between: paper.npz without its shorter cells gives contractions within .5 % there at
# thicknesses from .3 mm; longer arms begin to make their sheet curl
MAX_BRIDGED_LENGTH_RATIO = 0.2


def min_length(lengths_mm: Iterable[float], spacing_mm: float) -> float:
    """mm, the shortest arms that cells of these lengths answer for; 0 if all are."""
    first = min((float(length) for length in lengths_mm if length > 0), default=0.0)
    return first if first > MAX_BRIDGED_LENGTH_RATIO * spacing_mm else 0.0
