"""The public function behind `asterism report`: a design on one page."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.print.job import Job, prepare
from asterism.print.printer import PlasticProfile, Printer, load_plastic, load_printer
from asterism.process.listeners import Say, ignore_line
from asterism.reports.design_page import design_facts, write_design_page
from asterism.results.files import OutputError, check_writable, staged
from asterism.shape.read_shape import SHAPE_FILE, read_shape
from asterism.shape.shape import Shape


@dataclass(frozen=True)
class DesignReport:
    """A written report.

    Attributes
    ----------
    job : the design on the printer's bed.
    shape : the shape in the picture; None if no preview is available.
    source : origin of the shape, or the reason for its absence.
    scale : n of the layout's scale 1:n.
    """

    job: Job
    shape: Shape | None
    source: str
    scale: float


def report(
    design: Design,
    path: str | Path,
    *,
    results: str | Path | Shape | None = None,
    beside: str | Path | None = None,
    printer: str | Printer = "ultimaker2",
    plastic: str | PlasticProfile = "tpu95a",
    law: Law[Any] | None = None,
    say: Say | None = None,
) -> DesignReport:
    """Write one A4 page about a design as PDF: parameters, picture, layout, needles, accuracy and material.

    Parameters
    ----------
    path : file of the page; it ends with `.pdf`.
    results : a shape of this design, the directory of its results, or its shape.vtu; a new preview by default.
    beside : directory whose results are used if they belong to this design; ignored otherwise.
    printer, plastic : a profile, its name, or its file.
    law : law of a new preview; that of the paper's material by default.
    say : called with a line if no picture is available, or if the first run compiles loops.

    Raises
    ------
    DesignError
        The results belong to another design, or a profile is wrong.
    LawError
        A law and results are given together.
    OutputError
        The page cannot be written.
    """
    if law is not None and results is not None:
        raise LawError("--law: is for a new preview, not with --results")
    path = Path(path)
    if path.suffix.lower() != ".pdf":
        raise OutputError(f"--output: {str(path)!r} must end with .pdf")
    check_writable(path.parent, path.name)
    machine = load_printer(printer)
    profile = load_plastic(plastic)
    # before the preview: this finds most mistakes
    prepare(design, machine, profile, any_size=True)
    shape, source = _shape_of(design, results, beside, say or ignore_line, law)
    job = prepare(design, machine, profile, shape=shape, any_size=True)
    summary: Mapping[str, Any] = shape.summary if shape is not None else {}
    facts = design_facts(job, summary, source)
    with staged(path.parent) as folder:
        scale = write_design_page(folder / path.name, job, facts, summary.get("warnings", []), shape)
    return DesignReport(job, shape, source, scale)


def _shape_of(
    design: Design, results: str | Path | Shape | None, beside: str | Path | None, say: Say, law: Law[Any] | None
) -> tuple[Shape | None, str]:
    """A shape of the design and its origin; None and the reason if there is no preview."""
    from asterism.homogenize.law.plan import without_law
    from asterism.previews.session import preview
    from asterism.process.compiling import announce_compiling

    if results is not None:
        shape = results if isinstance(results, Shape) else read_shape(results)
        if not _is_of(shape, design):
            raise DesignError("--results", "must be of this design; compute them again", str(results))
        return shape, shape.made_by
    if beside is not None and Path(beside, SHAPE_FILE).is_file():
        with suppress(DesignError):  # unreadable results beside the design are ignored
            shape = read_shape(beside)
            if _is_of(shape, design) and not (law is not None and shape.is_preview):
                return shape, shape.made_by
    if (refused := without_law(design)) is not None:
        say(f"the page has no picture: {refused} first")
        return None, "not known: this design has no preview"
    try:
        with announce_compiling(say):
            shape = preview(design, law)
    except LawError as error:
        give = "--law or --results" if isinstance(error, ForeignLaw) else "--results"
        say(f"the page has no picture: {error}; give {give}")
        return None, "not known: no law of this material and lattice"
    return shape, shape.made_by


def _is_of(shape: Shape, design: Design) -> bool:
    """Whether a shape belongs to this design; name, mesh and solver may differ."""
    made_from = shape.summary.get("design")
    try:
        other = None if made_from is None else Design.from_dict(made_from)
    except DesignError:
        return False
    aside = {name: getattr(design, name) for name in ("name", "mesh", "solver")}
    return other is not None and other.model_copy(update=aside) == design
