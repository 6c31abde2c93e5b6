"""The numbers of a comparison of two shapes, and whether they are of one form."""

from __future__ import annotations

from asterism.results.records.verification import DifferenceRecord
from asterism.shape.comparison import Comparison

# shapes further apart than this, in % of the diameter, or rolled about axes that differ by more, or with normals that
# differ by more in the rms, are different ones. Normals of 236 previews are within 22 deg, or another form's
LIKE_PERCENT, LIKE_DEG, LIKE_NORMALS_DEG = 10.0, 20.0, 30.0
# exact minima that are nearer to each other, in % of the diameter, are one form
FORM_PERCENT = 2.5


def numbers(comparison: Comparison) -> DifferenceRecord:
    """Keys of summary.json; errors are those of the other shape against the reference, None where not defined."""
    reference, other = comparison.heights_mm
    radii, volumes, rises = comparison.roll_radii_mm, comparison.volumes_mm3, comparison.rises_mm
    return DifferenceRecord(
        rms_mm=comparison.rms_mm,
        max_mm=comparison.max_mm,
        rms_percent=comparison.rms_percent,
        max_percent=comparison.max_percent,
        rms_after_motion_percent=comparison.rms_after_motion_percent,
        free_motions=comparison.free_motions,
        rms_stars_percent=comparison.rms_stars_percent,
        max_stars_percent=comparison.max_stars_percent,
        diameter_mm=comparison.diameter_mm,
        height_error_percent=_relative(reference, other),
        mean_height_error_percent=_relative(*comparison.mean_heights_mm),
        heights_mm=[reference, other],
        relief_error_percent=comparison.relief_error_percent,
        rise_error_percent=None if rises is None else _relative(*rises),
        rises_mm=None if rises is None else list(rises),
        volume_error_percent=None if volumes is None else _relative(*volumes),
        volumes_mm3=None if volumes is None else list(volumes),
        roll_radius_error_percent=None if radii is None else _relative(*radii),
        roll_radii_mm=None if radii is None else list(radii),
        roll_axes_deg=list(comparison.roll_axes_deg),
        normals_rms_deg=comparison.normals_rms_deg,
        mirrored=comparison.symmetry.mirrors,
    )


def alike(comparison: Comparison) -> bool:
    """Whether two shapes are one form: near to each other, facing the same ways, and rolled about one axis if at all.

    A pleated sheet is near to a smooth one, and faces other ways.
    """
    one, other = comparison.roll_axes_deg
    if (one is None) != (other is None) or comparison.rms_percent > LIKE_PERCENT:
        return False
    if comparison.normals_rms_deg > LIKE_NORMALS_DEG:
        return False
    if one is None or other is None:
        return True
    apart = abs(one - other) % 180.0
    return min(apart, 180.0 - apart) < LIKE_DEG


def same_branch(comparison: Comparison, with_other: Comparison | None, apart_percent: float = 0.0) -> bool:
    """Whether a shape is of the form that counts, where the exact model may have found another minimum too.

    Parameters
    ----------
    comparison, with_other : of the shape, with the exact shape that counts and with the other minimum, if there is one.
    apart_percent : of the diameter, distance of the two exact shapes; the near ones are one form.
    """
    nearer = with_other is None or comparison.rms_percent <= with_other.rms_percent
    return bool((nearer or apart_percent < FORM_PERCENT) and alike(comparison))


def _relative(right: float, other: float) -> float | None:
    """% of the right value; None if that is nothing."""
    return None if abs(right) < 1e-9 else 100.0 * (other - right) / right
