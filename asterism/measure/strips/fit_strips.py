"""`asterism strips fit`: a table of strips in, a material file with its picture and numbers out."""

from __future__ import annotations

import json
from pathlib import Path

from asterism import __version__
from asterism.measure.strips import statement
from asterism.measure.strips.curvature_model import KappaBarKind, StripFormula
from asterism.measure.strips.fit_picture import draw_fit
from asterism.measure.strips.material_file import check_ours, material_text
from asterism.measure.strips.strip_fit import fit_readings
from asterism.measure.strips.strip_table import read_strips
from asterism.results.files import OutputError, staged
from pattern.design.errors import one_line


def fit_strips(
    strips: Path,
    output: Path | None,
    formula: StripFormula,
    kappa_bar: KappaBarKind,
    *,
    stretch: float | None,
    fabric_thickness_mm: float | None,
    outside: bool,
    flat_height_mm: float,
    confidence: float,
    keep_outliers: bool,
) -> tuple[list[str], list[str]]:
    """Write the material, its PNG and its JSON; returns the lines to print, and those to warn with.

    Raises
    ------
    TableError
        The table is wrong.
    UndeterminedMaterialError
        The strips do not determine a material.
    OutputError
        The files cannot be written, or the material's file is the user's own.
    """
    path = output or strips.parent / "material.toml"
    if path.suffix != ".toml":
        raise OutputError(f"--output: {str(path)!r} must end with .toml")
    check_ours(path)
    readings = read_strips(strips, stretch, fabric_thickness_mm, outside=outside)
    found = fit_readings(
        readings,
        formula,
        kappa_bar,
        confidence=confidence,
        flat_height_mm=flat_height_mm,
        keep_outliers=keep_outliers,
    )
    rows, words, worries = (
        statement.fit_rows(found),
        statement.convention_sentences(found),
        statement.fit_warnings(found),
    )
    remarks = [f"{name}: {value}" for name, value in rows.items()] + words
    title = one_line(f"{strips.name}: {len(found.used)} readings of strips")
    with staged(path.parent) as folder:
        (folder / path.name).write_text(material_text(found, one_line(path.stem), remarks), encoding="utf-8")
        draw_fit(found, title, folder / f"{path.stem}.png")
        asked = {"outside": outside, "flat_height_mm": flat_height_mm, "keep_outliers": keep_outliers}
        given = {"stretch": stretch, "fabric_thickness_mm": fabric_thickness_mm}
        numbers = {
            "version": __version__,
            "strips": strips.name,
            "options": asked | {name: value for name, value in given.items() if value is not None},
            **statement.fit_summary(found),
        }
        (folder / f"{path.stem}.json").write_text(json.dumps(numbers, indent=2) + "\n", encoding="utf-8")
    left_out = [f"  left out: {o.reading.name} (row {o.reading.row}): {o.reason}" for o in found.left_out]
    lines = [f"  {name:<20} {value}" for name, value in rows.items()] + left_out
    lines += [f"  {sentence}" for sentence in words]
    lines.append(f"{path}: the material, for --material and asterism calibrate; {path.stem}.png, {path.stem}.json")
    return lines, worries
