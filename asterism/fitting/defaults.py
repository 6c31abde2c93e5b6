"""Defaults and limits of a fit that its command states too; loading them takes no time."""

from __future__ import annotations

# % of the diameter, distance of the mean surface within which a target counts as reached
REACHED_PERCENT = 1.0
# corrections by the exact model: largest number for all sizes, and largest number that can be asked for
MAX_CORRECTIONS, MAX_ASKED_CORRECTIONS = 5, 20
# largest number of needles
MAX_FITTED_NEEDLES = 1000
