"""Fit of a material to a table of strips: the functions behind `asterism strips fit`."""

from __future__ import annotations

import datetime
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import IO, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from asterism.draw.fonts import write_title
from asterism.draw.style import BLUE, PALE, RED, add_grid, style_axes
from asterism.measure.strip_fit import CONFIDENCE, FLAT_HEIGHT_MM, StripFit, fit_directions
from asterism.measure.strip_table import Reading, read_strips
from asterism.pattern.design.errors import check_type, one_line
from asterism.pattern.design.materials import (
    Fabric,
    Plastic,
    ResidualCurvature,
    bilayer_curvature,
    residual_curvature,
    rest_curvature,
)
from asterism.pattern.design.spread import MAX_FACTOR, MAX_KAPPA_BAR_ERROR_PER_MM, Spread
from asterism.process.settings import StripFitSettings, StripFormula
from asterism.process.version import __version__
from asterism.results.files import OutputError, staged
from asterism.results.record import ABSENT
from asterism.results.records.material import (
    KappaBarRecord,
    LeftOutReadingRecord,
    RatioIntervalRecord,
    StripFitRecord,
    StripOptionsRecord,
)

# a file with this first line was written by the command, which may replace it
MATERIAL_FIRST_LINE = "# Written by asterism strips fit, which writes over this file as long as this line is here."


@dataclass(frozen=True)
class FittedMaterial:
    """A material fitted to a table of strips."""

    # one fit with its estimates, intervals and readings, or those along and across the grain
    fits: tuple[StripFit, ...]
    table: str  # name of the table

    @property
    def plastic(self) -> Plastic:
        """The plastic as a design has it: of two directions E1/E2 is the geometric mean."""
        return self.fits[0].plastic(math.sqrt(math.prod(self._ratios)) if len(self.fits) > 1 else None)

    @property
    def moduli(self) -> tuple[float, float] | None:
        """MPa, moduli of the fabric along and across its grain, in the scale of the default; None for one direction."""
        if len(self.fits) == 1:
            return None
        mean = Fabric().modulus
        along, across = self._ratios
        return mean * math.sqrt(across / along), mean * math.sqrt(along / across)

    @property
    def _ratios(self) -> list[float]:
        """E1/E2 of each direction."""
        return [fit.found.value for fit in self.fits]

    @property
    def spread(self) -> Spread:
        """The intervals as a design has them, without those that the strips leave open."""
        ratios = [fit.found for fit in self.fits]
        factor = max(max(high / value, value / low) for value, low, high in ratios)
        found = {"modulus_ratio_factor": min(factor, MAX_FACTOR)}
        if self.fits[0].kappa_bar:
            widest = max(0.5 * (each.high - each.low) for each in self.fits[0].kappa_bar.values())
            found["kappa_bar_error_per_mm"] = min(widest, MAX_KAPPA_BAR_ERROR_PER_MM)
        return Spread(**found)

    @cached_property
    def summary(self) -> StripFitRecord:
        """All numbers; the content of the JSON file beside the material."""
        fit, *across = self.fits
        settings = fit.settings
        given = {name: getattr(settings, name) for name in ("stretch", "fabric_thickness_mm")}
        return StripFitRecord(
            version=__version__,
            strips=self.table,
            options=StripOptionsRecord(
                outside=settings.outside,
                flat_height_mm=FLAT_HEIGHT_MM,
                **{name: ABSENT if value is None else value for name, value in given.items()},
            ),
            rest_curvature=settings.rest_curvature,
            confidence=CONFIDENCE,
            degrees_of_freedom=fit.freedom,
            modulus_ratio=_intervals(fit),
            modulus_ratio_across=_intervals(across[0]) if across else ABSENT,
            kappa_bar_kind=settings.kappa_bar,
            kappa_bar=[
                KappaBarRecord(thickness_mm=h, value_per_mm=value, low_per_mm=low, high_per_mm=high)
                for h, (value, low, high) in fit.kappa_bar.items()
            ],
            readings_used=len(self.used),
            readings_flat=sum(reading.curvature_per_mm is None for reading in self.used),
            left_out=[
                LeftOutReadingRecord(strip=one.strip, row=one.row, peeled=one.peeled, reason=reason)
                for one, reason in self._all("left_out")
            ],
            warnings=self.warnings,
        )

    @property
    def sentences(self) -> list[str]:
        """Meaning of the two conventions of E1/E2."""
        fit, formula = self.fits[0], self.fits[0].settings.rest_curvature
        other: StripFormula = "timoshenko" if formula == "paper" else "paper"
        mine, theirs = fit.found.value, fit.ratio[other].value
        known = [(r.thickness_mm, r.fabric_thickness_mm, mine, 1 - r.stretch**-2) for r in fit.used if not r.peeled]
        mixed_up = np.mean([bilayer_curvature(*one, other) / bilayer_curvature(*one, formula) for one in known])
        return [
            f'{mine:.4g} goes with rest_curvature = "{formula}", {theirs:.4g} with "{other}": each with its own '
            "formula gives these strips the curvature they have.",
            f'The ratio is also the stiffness of the arms against the fabric: with "{other}" they are '
            f'{theirs / mine:.2f} times as stiff as with "{formula}".',
            f'Mixed up, {mine:.4g} with "{other}", the fabric would curl the strips {mixed_up:.2f} times as much.',
        ]

    @property
    def warnings(self) -> list[str]:
        """One line for each reason to doubt the numbers."""
        left_to = "the material says none; add fabric.{} to it for asterism calibrate"
        fabrics = _fabrics(self.used).items()
        several = [f"strips of {len(v)} {called}: {left_to.format(key)}" for key, (called, v) in fabrics if len(v) > 1]
        return [*self._all("warnings"), *several]

    @property
    def left_out(self) -> list[str]:
        """One line for each reading that is not used."""
        return [f"left out: {one.name} (row {one.row}): {reason}" for one, reason in self._all("left_out")]

    @property
    def used(self) -> list[Reading]:
        """The readings that are used."""
        return self._all("used")

    def _all(self, name: str) -> list[Any]:
        """The items of an attribute of the fits, each once."""
        return list(dict.fromkeys(each for fit in self.fits for each in getattr(fit, name)))


def fit_strips(table: str | Path, settings: StripFitSettings | None = None) -> FittedMaterial:
    """Fit E1/E2 and kappa_bar to a table of measured strips.

    Parameters
    ----------
    table : CSV file with a row for each strip, as `new_strips` writes it.

    Raises
    ------
    TableError
        The table is wrong; the message names the row and the column.
    UndeterminedMaterialError
        The strips do not determine a material.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from asterism.measure.fit_strips import StripFitSettings, fit_strips
    >>> rows = ["strip,thickness_mm,length_mm,curvature_per_mm,peeled_curvature_per_mm"]
    >>> rows += ["1,0.3,60,0.0302,0.003", "2,0.3,60,0.0298,0.0031", "3,0.4,60,0.0170,0.0029", "4,0.4,60,0.0174,0.003"]
    >>> table = Path(tempfile.mkdtemp()) / "strips.csv"
    >>> _ = table.write_text(chr(10).join(rows))
    >>> material = fit_strips(table, StripFitSettings(stretch=1.35, fabric_thickness_mm=0.8))
    >>> 0.002 < material.plastic.kappa_bar_per_mm < 0.004
    True
    """
    table, settings = Path(table), StripFitSettings() if settings is None else settings
    check_type(settings, StripFitSettings, "StripFitSettings(outside=True) is an example")
    readings = read_strips(table, settings)
    return FittedMaterial(fit_directions(readings, settings), table.name)


def _intervals(fit: StripFit) -> dict[str, RatioIntervalRecord]:
    return {
        name: RatioIntervalRecord(value=value, low=low, high=high if math.isfinite(high) else None)
        for name, (value, low, high) in fit.ratio.items()
    }


def check_material_path(path: str | Path) -> None:
    """Raise OutputError for a file name without .toml, or a file that `write_material` did not write."""
    path = Path(path)
    if path.suffix != ".toml":
        raise OutputError(f"--output: {str(path)!r} must end with .toml")
    foreign = None
    try:
        with path.open(encoding="utf-8") as stream:
            if stream.readline().strip() != MATERIAL_FIRST_LINE:
                foreign = path
    except FileNotFoundError:
        # a picture or numbers without a material come from something else
        foreign = next((file for file in map(path.with_suffix, (".png", ".json")) if file.exists()), None)
    except (OSError, UnicodeDecodeError):
        foreign = path
    if foreign:
        raise OutputError(f"{foreign} exists and was not written by asterism strips fit; choose another name with -o")


def write_material(material: FittedMaterial, path: str | Path) -> list[str]:
    """Write a material as TOML, with its picture and its numbers beside it; returns the names of the files.

    Raises
    ------
    OutputError
        The files cannot be written, or the file at `path` was not written by this function.
    """
    path = Path(path)
    check_material_path(path)
    title = one_line(f"{material.table}: {material.summary.readings_used} readings of strips")
    with staged(path.parent) as folder:
        (folder / path.name).write_text(_material_text(material, one_line(path.stem), title), encoding="utf-8")
        draw_fit(material.fits, title, folder / f"{path.stem}.png")
        (folder / f"{path.stem}.json").write_text(material.summary.json_text(), encoding="utf-8")
    return [path.name, f"{path.stem}.png", f"{path.stem}.json"]


def _material_text(material: FittedMaterial, name: str, source: str) -> str:
    """TOML of the material: thickness and stretch of the fabric, E1/E2, its convention, kappa_bar, and intervals."""
    plastic = material.plastic
    kappa_bar = plastic.kappa_bar_per_mm
    if isinstance(kappa_bar, ResidualCurvature):
        thicknesses = ", ".join(map(repr, kappa_bar.thickness_mm))  # keeps apart what is nearly equal
        values = ", ".join(f"{value:.4g}" for value in kappa_bar.per_mm)
        kept = f"{{ thickness_mm = [{thicknesses}], per_mm = [{values}] }}"
    else:
        kept = f"{kappa_bar:.4g}"
    moduli = []
    if material.moduli:
        moduli.append("# along and across the grain: strips give their ratio; with a weight's, multiply both")
        moduli.append("modulus_mpa = [{:.4g}, {:.4g}]".format(*material.moduli))
    remarks = [f"{label}: {text}" for label, text in material.summary.table().items()] + material.sentences
    lines = [
        MATERIAL_FIRST_LINE,
        *(f"# {remark}" for remark in remarks),
        f"name = {json.dumps(name, ensure_ascii=False)}",
        "",
        "[measured]",
        f"source = {json.dumps(source, ensure_ascii=False)}",
        f'date = "{datetime.date.today().isoformat()}"',
        "",
        "[fabric]",
        # with several values the key is left out, and commands use the design's value
        *(f"{key} = {values.pop():g}" for key, (_, values) in _fabrics(material.used).items() if len(values) == 1),
        *moduli,
        "",
        "[plastic]",
        f"modulus_ratio = {plastic.modulus_ratio:.5g}",
        f'rest_curvature = "{plastic.rest_curvature}"',
        f"kappa_bar_per_mm = {kept}",
        "",
        "[spread]",
        *(f"{key} = {value:.4g}" for key, value in material.spread.model_dump(exclude_unset=True).items()),
    ]
    return "\n".join(lines) + "\n"


def _fabrics(used: list[Reading]) -> dict[str, tuple[str, set[float]]]:
    """Values of the fabrics with their name, by the keys of a design's fabric; most tables have one value each."""
    return {
        "stretch": ("stretches", {reading.stretch for reading in used}),
        "thickness_mm": ("thicknesses of the fabric", {reading.fabric_thickness_mm for reading in used}),
    }


def draw_fit(fits: Sequence[StripFit], title: str, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw one fit, or those along and across the grain, as PNG."""
    figure = Figure(figsize=(9, 5.4), dpi=150, facecolor="white")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    figure.subplots_adjust(left=0.08, right=0.98, bottom=0.12, top=0.79)
    one = fits[0]
    thicknesses = [reading.thickness_mm for reading in one.used]
    h = np.linspace(min(thicknesses) - 0.01, max(thicknesses) + 0.01, 200)
    peeled, doubtful = RED, "#9d1f1f"
    for fit, colour in zip(fits, (BLUE, "#5d8a3a"), strict=False):
        covered = [reading for reading in fit.used if not reading.peeled]
        for stretch, fabric_mm in {(r.stretch, r.fabric_thickness_mm) for r in covered}:
            fabric, ends = Fabric(stretch=stretch, thickness_mm=fabric_mm), fit.found
            middle, low, high = (rest_curvature(h, fabric, fit.plastic(min(max(end, 1.0), 1e7))) for end in ends)
            axes.fill_between(h, low, high, color=colour, alpha=0.2, linewidth=0)
            axes.plot(h, middle, color=colour, linewidth=1.2)
        lie = f" {covered[0].direction}" if len(fits) > 1 else ""
        _draw_readings(axes, covered, colour, f"with fabric{lie}")
    if one.kappa_bar:
        axes.plot(h, residual_curvature(h, one.plastic().kappa_bar_per_mm), color=peeled, linewidth=1.2)
    _draw_readings(axes, [reading for reading in one.used if reading.peeled], peeled, "peeled")
    for reading, _ in {each for fit in fits for each in (*fit.left_out, *fit.outliers)}:
        place = (reading.thickness_mm, reading.curvature_per_mm or 0.0)
        axes.plot(*place, "x", color=doubtful, markersize=8)
        axes.annotate(f"  {reading.strip}", place, fontsize=8, color=doubtful, va="center", parse_math=False)
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    style_axes(axes, "curvature of the strips, 1/mm", "thickness of the plastic, mm")
    add_grid(axes)
    axes.legend(fontsize=8, frameon=False)
    write_title(figure, 0.012, 0.93, title, 14)
    ratios = " and ".join(
        f"{ratio.value:.0f}, {ratio.low:.0f} to {'no bound' if np.isinf(ratio.high) else f'{ratio.high:.0f}'}"
        for ratio in (fit.found for fit in fits)
    )
    lie = " along and across" if len(fits) > 1 else ""
    text = f"E1/E2{lie} = {ratios} ({100 * CONFIDENCE:g} %, shaded)"
    text += f', rest_curvature = "{one.settings.rest_curvature}"; crosses: left out or doubtful'
    figure.text(0.012, 0.88, text, fontsize=10, color=PALE, parse_math=False)
    figure.savefig(path_or_file, format="png", dpi=150)


def _draw_readings(axes: Axes, readings: list[Reading], colour: str, label: str) -> None:
    bent = [(r.thickness_mm, r.curvature_per_mm) for r in readings if r.curvature_per_mm]
    flat = [(r.thickness_mm, 8 * FLAT_HEIGHT_MM / r.length_mm**2) for r in readings if r.curvature_per_mm is None]
    if bent:
        axes.plot(*zip(*bent, strict=True), "o", color=colour, markersize=4, alpha=0.6, label=label)
    if flat:
        label += ", flat: below"
        axes.plot(*zip(*flat, strict=True), "v", color=colour, markersize=6, fillstyle="none", label=label)
