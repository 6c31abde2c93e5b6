"""The summary of an export: what is printed, how it differs from the design, and what the print takes."""

from __future__ import annotations

from typing import Any, ClassVar

from asterism.results.record import ABSENT, Record, key
from asterism.results.records.exact import MinimumRecord
from asterism.results.words import VISIBLE_SAG_MM, needle_names, sag_in_words


class SizeChangeRecord(Record):
    """What rounding does to the thicknesses or the widths of the arms."""

    values_mm: list[float] = key("The sizes that are printed.")
    stars_changed: int = key("Stars with another size than in the design.")
    rods_changed: int = key("Drawn rods between two nodes with another size than in the design.", default=0)
    largest_change_mm: float = key("The largest change of an arm's size, with its sign.")
    mean_change_percent: float = key("Mean of the relative changes of all arms.")


class LayersRecord(Record):
    """Sizes that the printer makes: whole layers and whole lines."""

    first_layer_mm: float = key("Height of the first layer.")
    layer_mm: float = key("Height of each other layer.")
    line_mm: float = key("Width of a line: that of the nozzle.")


class RoundingRecord(LayersRecord):
    """The layers and lines of the print, and what they change."""

    thickness: SizeChangeRecord = key("Changes of the thicknesses.")
    width: SizeChangeRecord = key("Changes of the widths.")
    better_layers: LayersRecord | None = key("Layers that are much nearer to the design; null if there are none.")


class GivenShapeRecord(Record):
    """The shape in space whose files are written."""

    is_certain: bool | None = key("The shape is certified as a minimum; null if its summary is missing.")
    warnings: list[str] = key("Warnings from the shape's summary.")


class ShapeChangeRecord(Record):
    """The shape of the printed, rounded design compared with that of the design as drawn. Pairs: drawn, printed."""

    model: str | None = key("`exact` or `preview`; null if there is no preview of the fabric or the pattern.")
    why: str = key("Why there is no comparison; only if `model` is null.", default=ABSENT)
    height_mm: list[float] = key("Extents of both shapes along z.", default=ABSENT)
    extent_mm: list[list[float]] = key("Sizes of the boxes around both shapes.", default=ABSENT)
    star_distance_mm: float = key(
        "Rms distance of the star centres, or of points on drawn rods, as held, up to free motions and symmetries of "
        "the design.",
        default=ABSENT,
    )
    star_distance_percent: float = key("The same in percent of the drawn shape's diameter.", default=ABSENT)
    are_minima: list[bool] = key("Each shape is certified as a minimum.")
    stars_outside_law: int = key("Stars outside the range of the preview's law.", default=ABSENT)
    warnings: list[str] = key("Warnings about the printed shape.", default=ABSENT)
    minima: list[MinimumRecord] = key("Minima of the printed shape, which is the first one.", default=ABSENT)


class TinyStarRecord(Record):
    """A star, or an island of drawn rods, so small that it may jump off the fabric."""

    at_mm: list[float] = key("Centre in printed coordinates.")
    arm_mm: float = key("Length of the longest arm, or of all rods of the island.")


class SolidRecord(Record):
    """A solid in the printer's coordinates."""

    volume_mm3: float = key("Volume.")
    box_mm: list[list[float]] = key("Lowest and highest coordinates.")


class CheckSquareRecord(Record):
    """The square on the fabric that shows whether the stretch is right."""

    before: list[float] = key("Sides before stretching, in mm.")
    after: list[float] = key("Sides after stretching, in mm.")


class PrintCostRecord(Record):
    """Estimate of the plastic and the time that a print takes."""

    volume_mm3: float = key("Volume of the plastic.")
    mass_g: float = key("Mass of the plastic.")
    filament_m: float = key("Length of the filament.")
    layers: int = key("Number of layers.")
    lines_m: float = key("Length of all printed lines.")
    minutes: float = key("Printing time in minutes, with heating; acceleration is not modelled.")


def _sizes(size: SizeChangeRecord, stars: int, rods: int) -> str:
    values = ", ".join(f"{value:g}" for value in size.values_mm)
    changed = [f"{size.stars_changed} of {stars} stars"] if size.stars_changed else []
    changed += [f"{size.rods_changed} of {rods} rods"] if size.rods_changed else []
    if not changed:
        return f"{values} mm, as drawn"
    return f"{values} mm; {' and '.join(changed)} rounded, by {size.largest_change_mm:+.3f} mm at most"


def _rounding(record: ExportRecord) -> dict[str, str]:
    layers = record.rounding
    sizes = {"thickness": layers.thickness, "width": layers.width}
    rows = {name: _sizes(size, record.stars, record.rods) for name, size in sizes.items()}
    rows["layers"] = f"first {layers.first_layer_mm:g} mm, then {layers.layer_mm:g} mm"
    if better := layers.better_layers:
        options = f"--first-layer {better.first_layer_mm:g} --layer {better.layer_mm:g}"
        rows["better layers"] = f"{options} is nearer to the design"
    return rows


def _shape_change(record: ExportRecord) -> dict[str, str]:
    """A row, and a second one for another minimum of the exact model."""
    change = record.shape_change
    others = change.minima[1:] if change is not None and "minima" in change else []
    rows = {"change of shape": _change_in_words(record)}
    return rows | {f"minimum {number}": each.in_words(record.stars > 0) for number, each in enumerate(others, 2)}


def _change_in_words(record: ExportRecord) -> str:
    rounding, change = record.rounding, record.shape_change
    if not any(size.stars_changed or size.rods_changed for size in (rounding.thickness, rounding.width)):
        return "none"
    if change is None:
        return "not computed"
    if change.model is None:
        return f"not computed ({change.why}); use --simulate"
    before, after = change.height_mm
    distance = f"{change.star_distance_mm:.2f} mm ({change.star_distance_percent:.1f} % of the diameter)"
    by = "exact model" if change.model == "exact" else "preview; --simulate is exact"
    if change.stars_outside_law:
        outside = f"{change.stars_outside_law} of the stars {'is' if change.stars_outside_law == 1 else 'are'}"
        by = f"not reliable: {outside} outside the preview's law; --simulate is exact"
    return f"{distance}, height {before:.2f} -> {after:.2f} mm ({by})"


def _tiny_stars(record: ExportRecord) -> str | None:
    if not (tiny := record.tiny_stars):
        return None
    places = ", ".join("[{:g}, {:g}]".format(*star.at_mm) for star in tiny[:4])
    return f"{len(tiny)}, may jump off: at {places}" + (", ..." if len(tiny) > 4 else "")


def _z_offset(record: ExportRecord) -> str:
    fabric = "stretched fabric" if record.fabric_given else "released fabric; measure it stretched: --fabric"
    return f"{record.z_offset_mm:.2f} mm (plate and {fabric}), in start.gcode"


def _needles_in_plastic(record: ExportRecord) -> str | None:
    through = record.needles_in_plastic
    return f"{needle_names(through)}: drill the plastic there, or move the pin" if through else None


def _hangs(record: ExportRecord) -> str | None:
    below = record.hangs_below_base_mm
    if below is None:
        why = "the fabric has no law" if record.stars else "drawn rods have no preview"
        return f"not known: {why}; use --simulate"
    if below <= VISIBLE_SAG_MM:
        return None
    return f"{sag_in_words(below, record.hangs_doubt_mm)}: set needles higher, or cut it out"


class ExportRecord(Record):
    """The summary of an export."""

    rows: ClassVar = {
        "printer": ("printer", "{printer[name]}, {plastic[name]}"),
        "rounding": ("rounding", _rounding),
        "shape_change": ("change of shape", _shape_change),
        "tiny_stars": ("tiny pieces", _tiny_stars),
        "printed_border": ("cut line", lambda record: None if record.printed_border else "not printed, in layout.pdf"),
        "z_offset_mm": ("z offset", _z_offset),
        "check_square_mm": (
            "check square",
            "{check_square_mm[before][0]:g} mm before stretching, "
            "{check_square_mm[after][0]:.1f} x {check_square_mm[after][1]:.1f} mm after",
        ),
        "needles": ("needles", "{needles}"),
        "needles_in_plastic": ("in plastic", _needles_in_plastic),
        "hangs_below_base_mm": ("hangs", _hangs),
        "estimate": ("estimate", "{estimate[minutes]:.0f} min, {estimate[mass_g]:.2f} g, {estimate[filament_m]:.2f} m"),
    }

    design: dict[str, Any] = key("The rounded design with all defaults, as in `rounded.toml`.")
    printer: dict[str, Any] = key("The printer's profile with all defaults.")
    plastic: dict[str, Any] = key("The plastic's profile with all defaults.")
    stars: int = key("Number of stars.")
    rods: int = key("Number of drawn rods between two nodes.", default=0)
    rounding: RoundingRecord = key("Layers and lines of the print.")
    shape: GivenShapeRecord | None = key("The shape whose files are written; null without one.")
    shape_change: ShapeChangeRecord | None = key("What rounding does to the shape; null if it was not computed.")
    tiny_stars: list[TinyStarRecord] = key("Stars and islands of rods that may jump off the fabric.")
    solids: dict[str, SolidRecord] = key("Solids by their files: `stars` or `rods`, and `border` if printed.")
    printed_border: bool = key("The line to cut along is printed.")
    turn_deg: float = key("Turn of the print on the bed, counterclockwise.")
    origin_on_bed_mm: list[float] = key("Place of the design's origin in the printer's coordinates.")
    z_offset_mm: float = key("Height of the fabric's surface above the bed: plate and fabric.")
    fabric_given: bool = key("The thickness of the stretched fabric was given; else it is that of the released fabric.")
    check_square_mm: CheckSquareRecord = key("The square that shows whether the stretch is right.")
    needles: int = key("Number of needles.")
    needles_in_plastic: list[int] = key("Numbers of the needles that meet an arm or a drawn rod.")
    hangs_below_base_mm: float | None = key("How far the sheet hangs below the base of its needles; null if not known.")
    hangs_doubt_mm: float | None = key("Estimated error of that; null if the shape is not a preview.")
    estimate: PrintCostRecord = key("Plastic and time.")
    files: list[str] = key("Names of all files of the export.")
