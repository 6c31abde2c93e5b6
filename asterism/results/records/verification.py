"""The summary of a verification: the preview compared with the exact model."""

from __future__ import annotations

from typing import Any, ClassVar

from asterism.results.record import ABSENT, Record, key
from asterism.results.records.exact import ExactRecord, mesh_error_in_words
from asterism.results.records.shape import ExpectedErrorRecord, PreviewRecord
from asterism.results.words import distance_error, height_error, times


def _same_form(record: VerificationRecord) -> str:
    if record.same_branch is None:
        return "not known: no certified exact shape"
    return "yes" if record.same_branch else "no"


def _expected(record: VerificationRecord) -> str:
    rms, height = record.expected_rms_percent, record.expected_height_percent
    distance = "not known" if rms is None else distance_error(rms, record.get("diameter_mm"))
    return f"{distance}, height {'not known' if height is None else height_error(height, record.heights_mm[1])}"


def _exact_model(record: VerificationRecord) -> str:
    release, near = record.starts["release"], record.starts["preview"]
    if not record.exact.is_minimum:
        agreement = "no minimum"
    elif record.starts_agree:
        agreement = "both starts in one minimum"
    elif release.is_minimum and near.is_minimum:
        distances = f"{release.rms_percent:.2g} % from the released one, {near.rms_percent:.2g} % from the other one"
        agreement = f"two minima, {record.starts_distance_percent:.2g} % apart; the preview is {distances}"
    else:
        agreement = "one start in a minimum"
    return f"{agreement}; {release.iterations} iterations, {near.iterations} from the preview"


def _distance(record: DifferenceRecord) -> str:
    rms, largest = f"{record.rms_percent:.2f} % of the diameter rms", f"{record.max_percent:.1f} % at most"
    if "rms_mm" not in record:
        return f"{rms}, {largest}"
    return f"{rms} ({record.rms_mm:.2g} mm), {largest} ({record.max_mm:.2g} mm)"


def _without_swing(record: DifferenceRecord) -> str | None:
    """The row of a supported sheet."""
    if record.free_motions == 6:
        return None
    return f"{record.rms_after_motion_percent:.2f} % of the diameter rms, after the best rigid motion"


def _at_points(record: DifferenceRecord) -> dict[str, str]:
    """The row of star centres, or of the sites of a motif."""
    preview = record.get("preview")
    label = "star centres" if preview is None or preview.get("stars", 1) else "lattice sites"
    return {label: f"{record.rms_stars_percent:.2f} % rms, {record.max_stars_percent:.1f} % at most"}


class DifferenceRecord(Record):
    """Differences of a shape from a reference shape, both as their supports hold them.

    Only rigid motions that the supports leave free are taken out: all six for a free sheet. Pairs hold the value of the
    reference first. Distances in percent are of the reference's diameter.
    """

    rms_mm: float = key("Rms distance of the surfaces, without the corrugation, over the printed area.")
    max_mm: float = key("Largest distance of the surfaces, without the corrugation.")
    rms_percent: float = key("The rms distance in percent of the diameter.")
    max_percent: float = key("The largest distance in percent of the diameter.")
    rms_after_motion_percent: float = key(
        "The rms distance after the best of all rigid motions, also of those that the supports do not leave free, in "
        "percent of the diameter. It is far below `rms_percent` if both shapes are of one form and one of them has "
        "swung on its supports."
    )
    free_motions: int = key("Rigid motions that the supports leave free and that are taken out, from 0 to 6.")
    rms_stars_percent: float = key("Rms distance of the star centres, or of the sites of the lattice of a motif.")
    max_stars_percent: float = key("Largest distance of two star centres or sites.")
    diameter_mm: float = key("Largest distance of two points of the reference.")
    height_error_percent: float | None = key("Error of the height, in percent of the reference's.")
    mean_height_error_percent: float | None = key("The same without the corrugation.")
    heights_mm: list[float] = key("Extents of both shapes along z, with the corrugation.")
    relief_error_percent: float | None = key("Rms distance of the corrugations, in percent of the reference's.")
    rise_error_percent: float | None = key("Error of the rise, in percent of the reference's.")
    rises_mm: list[float] | None = key(
        "Rises of both shapes from the mean level of the supports to the furthest point on the reference's higher "
        "side; null with fewer than two supported points."
    )
    volume_error_percent: float | None = key("Error of the volume, in percent of the reference's.")
    volumes_mm3: list[float] | None = key("Volumes from the surfaces to the level of their outlines; null if rolled.")
    roll_radius_error_percent: float | None = key("Error of the roll's radius, in percent.")
    roll_radii_mm: list[float] | None = key("Radii of both rolls; null unless both sheets are rolled.")
    roll_axes_deg: list[float | None] = key("Axes about which both are rolled, on the print; null if not rolled.")
    normals_rms_deg: float = key("Rms angle between the normals of the surfaces.")
    mirrored: bool = key("The nearest image of the shape under the design's symmetries is a mirror image.")


class VerifiedStartRecord(DifferenceRecord):
    """Differences of the preview from the exact shape of one start, and how that start went."""

    energy_n_mm: float = key("Energy of the exact shape.")
    is_minimum: bool = key("The exact shape is certified.")
    stars_up: int = key("Stars of the exact shape that bump to the plastic side.")
    iterations: int = key("Newton iterations of the start.")
    factorisations: int = key("Factorisations of the Hessian.")
    joined_at_vertices: int = key(
        "Vertices of the coarse mesh on which this start reached the state of the other one and ended; absent if it "
        "went on to the fine mesh.",
        default=ABSENT,
    )


class VerificationRecord(ExpectedErrorRecord, DifferenceRecord):
    """The summary of a verification. Its differences are those of the preview from the exact shape that counts."""

    model_name = "verification"
    last = ("warnings", "version", "preview", "exact", "design", "command")
    rows: ClassVar = {
        "same_branch": ("same form", _same_form),
        "rms_percent": ("distance", _distance),
        "rms_after_motion_percent": ("without a swing", _without_swing),
        "expected_rms_percent": ("estimated error", _expected),
        "rms_stars_percent": ("star centres", _at_points),
        "heights_mm": ("height", "{heights_mm[1]:.1f} mm, exact {heights_mm[0]:.1f} mm"),
        "rises_mm": ("rise over the pins", "{rises_mm[1]:.1f} mm, exact {rises_mm[0]:.1f} mm"),
        "roll_radii_mm": ("radius of the roll", "{roll_radii_mm[1]:.1f} mm, exact {roll_radii_mm[0]:.1f} mm"),
        "mesh_error_percent": ("exact mesh error", lambda record: mesh_error_in_words(record.exact)),
        "starts_agree": ("exact model", _exact_model),
        "preview_s": ("seconds", "preview {preview_s:.2f}; exact {exact_s:.1f}"),
        "speedup": ("speed-up", lambda record: times(record.speedup)),
    }

    model: str = key("Always `verification`.")
    same_branch: bool | None = key("The preview has the form of the exact shape; null without a minimum.")
    speedup: float = key("Time of the exact model over that of the preview.")
    preview_s: float = key("Time of the preview with its layout, without compilation.")
    exact_s: float = key("Time of the exact model from the flat print, with its layout.")
    exact_from_preview_s: float = key("Time of the exact model from the preview, with its layout.")
    mesh_error_percent: float | None = key("Estimated mesh error of the exact shape.")
    mesh_change_percent: float | None = key("Rms distance of the exact shape to that on the next coarser mesh.")
    result_from: str = key("Start of the exact shape that counts: `release` or `preview`.")
    starts_agree: bool = key("Both starts ended in one minimum.")
    starts_distance_percent: float = key("Rms distance of the exact shapes of both starts, in percent of the diameter.")
    starts: dict[str, VerifiedStartRecord] = key("Both starts by name: `release` and `preview`.")
    warnings: list[str] = key("What to know before the numbers are trusted.")
    version: str = key("Version of asterism.")
    preview: PreviewRecord | ExactRecord = key("Summary of the preview.")
    exact: ExactRecord = key("Summary of the exact shape that counts.")
    design: dict[str, Any] = key("The design with all defaults, as in a design file.")
    command: str | None = key("Command line of the verification; null if it ran in Python.", default=ABSENT)
