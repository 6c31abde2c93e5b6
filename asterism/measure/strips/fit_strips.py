"""Fit of a material to a table of strips: the functions behind `asterism strips fit`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from asterism.measure.strips import statement
from asterism.measure.strips.curvature_model import KappaBarKind, StripFormula
from asterism.measure.strips.fit_picture import draw_fit
from asterism.measure.strips.material_file import check_ours, material_text
from asterism.measure.strips.strip_fit import FLAT_HEIGHT_MM, StripFit, fit_readings
from asterism.measure.strips.strip_table import read_strips
from asterism.pattern.design.errors import one_line
from asterism.pattern.design.materials import Plastic
from asterism.results.files import OutputError, staged
from asterism.results.record import ABSENT
from asterism.results.records.strips import StripFitRecord, StripOptionsRecord


@dataclass(frozen=True)
class FittedMaterial:
    """A material fitted to a table of strips.

    Attributes
    ----------
    fit : the fit with its estimates, intervals and readings.
    table : name of the table.
    options : options that the table was read with.
    """

    fit: StripFit
    table: str
    options: StripOptionsRecord

    @property
    def plastic(self) -> Plastic:
        """The plastic as a design has it."""
        return self.fit.plastic()

    @cached_property
    def summary(self) -> StripFitRecord:
        """All numbers; the content of the JSON file beside the material."""
        return statement.fit_record(self.fit, self.table, self.options)

    @property
    def rows(self) -> dict[str, str]:
        """The numbers in words, by their labels."""
        return self.summary.table()

    @property
    def sentences(self) -> list[str]:
        """Meaning of the two conventions of E1/E2."""
        return statement.convention_sentences(self.fit)

    @property
    def warnings(self) -> list[str]:
        """One line for each reason to doubt the numbers."""
        return statement.fit_warnings(self.fit)

    @property
    def left_out(self) -> list[str]:
        """One line for each reading that is not used."""
        return [f"left out: {o.reading.name} (row {o.reading.row}): {o.reason}" for o in self.fit.left_out]


def fit_strips(
    table: str | Path,
    *,
    rest_curvature: StripFormula = "paper",
    kappa_bar: KappaBarKind = "constant",
    stretch: float | None = None,
    fabric_thickness_mm: float | None = None,
    outside: bool = False,
    flat_height_mm: float = FLAT_HEIGHT_MM,
    confidence: float = 0.95,
    keep_outliers: bool = False,
) -> FittedMaterial:
    """Fit E1/E2 and kappa_bar to a table of measured strips.

    Parameters
    ----------
    table : CSV file with a row for each strip, as `new_strips` writes it.
    rest_curvature : convention of E1/E2: paper or timoshenko.
    kappa_bar : curvature of peeled plastic: constant, per-thickness or zero.
    stretch, fabric_thickness_mm : values for all strips, if the table gives none.
    outside : the boxes enclose the thickness of the strips.
    flat_height_mm : strips whose arc is lower count as flat.
    confidence : probability with which the intervals contain the true values.
    keep_outliers : use readings that contradict the others, too.

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
    >>> from asterism.measure.strips.fit_strips import fit_strips
    >>> rows = ["strip,thickness_mm,length_mm,curvature_per_mm,peeled_curvature_per_mm"]
    >>> rows += ["1,0.3,60,0.0302,0.003", "2,0.3,60,0.0298,0.0031", "3,0.4,60,0.0170,0.0029", "4,0.4,60,0.0174,0.003"]
    >>> table = Path(tempfile.mkdtemp()) / "strips.csv"
    >>> _ = table.write_text(chr(10).join(rows))
    >>> material = fit_strips(table, stretch=1.35, fabric_thickness_mm=0.8)
    >>> 0.002 < material.plastic.kappa_bar_per_mm < 0.004
    True
    """
    table = Path(table)
    readings = read_strips(table, stretch, fabric_thickness_mm, outside=outside)
    fit = fit_readings(
        readings,
        rest_curvature,
        kappa_bar,
        confidence=confidence,
        flat_height_mm=flat_height_mm,
        keep_outliers=keep_outliers,
    )
    options = StripOptionsRecord(
        outside=outside,
        flat_height_mm=flat_height_mm,
        keep_outliers=keep_outliers,
        stretch=ABSENT if stretch is None else stretch,
        fabric_thickness_mm=ABSENT if fabric_thickness_mm is None else fabric_thickness_mm,
    )
    return FittedMaterial(fit, table.name, options)


def check_material_path(path: str | Path) -> None:
    """Refuse a file name without .toml, and a file that `write_material` did not write.

    Raises
    ------
    OutputError
        The material cannot be written there.
    """
    path = Path(path)
    if path.suffix != ".toml":
        raise OutputError(f"--output: {str(path)!r} must end with .toml")
    check_ours(path)


def write_material(material: FittedMaterial, path: str | Path) -> list[str]:
    """Write a material as TOML, with its picture and its numbers beside it; returns the names of the files.

    Raises
    ------
    OutputError
        The files cannot be written, or the file at `path` was not written by this function.
    """
    path = Path(path)
    check_material_path(path)
    remarks = [f"{name}: {value}" for name, value in material.rows.items()] + material.sentences
    title = one_line(f"{material.table}: {len(material.fit.used)} readings of strips")
    with staged(path.parent) as folder:
        text = material_text(material.fit, one_line(path.stem), remarks, title)
        (folder / path.name).write_text(text, encoding="utf-8")
        draw_fit(material.fit, title, folder / f"{path.stem}.png")
        (folder / f"{path.stem}.json").write_text(material.summary.json_text(), encoding="utf-8")
    return [path.name, f"{path.stem}.png", f"{path.stem}.json"]
