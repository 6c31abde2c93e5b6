"""The numbers of a comparison of two shapes, and whether they have the same form."""

from __future__ import annotations

from typing import Any

from asterism.results.record import keys_of
from asterism.results.records.verification import DifferenceRecord
from asterism.shape.comparison import Comparison

# two shapes have different forms if one of these limits is exceeded: the rms distance, in % of the diameter
MAX_LIKE_DISTANCE_PERCENT = 10.0
# the angle between their roll axes
MAX_LIKE_AXIS_DEG = 20.0
# the rms angle between their normals. In 236 previews it is below 22 deg, or the form is another one
MAX_LIKE_NORMALS_DEG = 30.0
# two exact minima have the same form if their rms distance, in % of the diameter, is below this
MAX_FORM_DISTANCE_PERCENT = 2.5


def numbers(comparison: Comparison) -> DifferenceRecord:
    """The record of a comparison: errors of the other shape relative to the reference; None if undefined."""
    pairs = {
        "height_error_percent": comparison.heights_mm,
        "mean_height_error_percent": comparison.mean_heights_mm,
        "rise_error_percent": comparison.rises_mm,
        "volume_error_percent": comparison.volumes_mm3,
        "roll_radius_error_percent": comparison.roll_radii_mm,
    }
    known: dict[str, Any] = {name: pair and _relative(*pair) for name, pair in pairs.items()}
    known["mirrored"] = comparison.symmetry.mirrors
    others = {name: getattr(comparison, name) for name in keys_of(DifferenceRecord) if name not in known}
    return DifferenceRecord.from_json(known | others)


def alike(comparison: Comparison) -> bool:
    """Whether two shapes have the same form: small distance, similar normals, and the same roll axis if rolled.

    The normals distinguish a pleated sheet from a smooth one, which may be near to it.
    """
    one, other = comparison.roll_axes_deg
    if (one is None) != (other is None) or comparison.rms_percent > MAX_LIKE_DISTANCE_PERCENT:
        return False
    if comparison.normals_rms_deg > MAX_LIKE_NORMALS_DEG:
        return False
    if one is None or other is None:
        return True
    apart = abs(one - other) % 180.0
    return min(apart, 180.0 - apart) < MAX_LIKE_AXIS_DEG


def same_branch(comparison: Comparison, with_other: Comparison | None, apart_percent: float = 0.0) -> bool:
    """Whether a shape has the form of the exact result, and not that of another exact minimum.

    The minima are `apart_percent` of the diameter apart; without a second one, `with_other` is None.
    """
    nearer = with_other is None or comparison.rms_percent <= with_other.rms_percent
    return bool((nearer or apart_percent < MAX_FORM_DISTANCE_PERCENT) and alike(comparison))


def _relative(right: float, other: float) -> float | None:
    """Relative error in %; None if the reference value is zero."""
    return None if abs(right) < 1e-9 else 100.0 * (other - right) / right
