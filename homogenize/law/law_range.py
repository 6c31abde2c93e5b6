"""The shortest arms that a law covers: shorter ones only if the bare fabric is near."""

from __future__ import annotations

from collections.abc import Iterable

# of the spacing. Up to arms of this length a sheet departs so smoothly from bare fabric that a curve from there to the
# first cell gives all lengths between: the paper's law without its shorter cells keeps contractions within 0.5 % there
# for thicknesses from 0.3 mm. Longer arms begin to curl their sheet.
MAX_BRIDGED_LENGTH_RATIO = 0.2


def min_length(lengths_mm: Iterable[float], spacing_mm: float) -> float:
    """mm, the shortest arms that a law from cells of these lengths covers; 0 if it covers all.

    Examples
    --------
    >>> min_length([0.0, 3.4, 6.0], 17.3), min_length([0.0, 3.6, 6.0], 17.3)
    (0.0, 3.6)
    """
    first = min((float(length) for length in lengths_mm if length > 0), default=0.0)
    return first if first > MAX_BRIDGED_LENGTH_RATIO * spacing_mm else 0.0
