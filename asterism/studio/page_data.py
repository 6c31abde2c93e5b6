"""Document and problems as plain data for the page."""

from __future__ import annotations

import logging
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.errors import Error
from asterism.pattern.design.design import WEIGHT_RANGE
from asterism.pattern.design.errors import BlankSheetError, DesignError
from asterism.pattern.design.material_files import with_material_file
from asterism.pattern.design.stars import MIN_ARM_MM, THICKNESS_RANGE_MM, WIDTH_RANGE_MM
from asterism.pattern.layout.layout import Layout
from asterism.studio.disk_file import FileChangedError, OtherFileError
from asterism.studio.document import Document
from asterism.studio.local_files import shown_path
from asterism.studio.messages import Limits, StudioProblem, mistake_parts
from asterism.studio.painted import entries_by_site
from asterism.studio.plan import plan_data
from asterism.studio.printers import plastic_names, printer_entries
from asterism.studio.weights import weights_by_site

REFUSAL_KINDS: dict[type[Exception], str] = {
    DesignError: "design",
    FileChangedError: "file changed",
    OtherFileError: "file exists",
}
# Previews, exact shapes and prints need stars; the engine shows a sheet without them while the pointer is down.
LAST_STAR = f"A sheet needs at least one star with an arm of {MIN_ARM_MM:g} mm; the design stays as it is."

SERVER_MISTAKE = "the studio has made a mistake, see its terminal; the design is as it was"

_log = logging.getLogger("asterism.studio")


def document_data(document: Document, printer: str, limits: Limits | None) -> dict[str, Any]:
    """The message `document`: the design as in its file, its plan, and what may be done with it."""
    layout = document.layout
    printers = printer_entries()
    chosen = next((entry for entry in printers if entry["name"] == printer), printers[0])
    table = document.table
    painted_sites = {site for site, entry in entries_by_site(table, layout).items() if not entry.get("remove")}
    history = document.history
    return {
        "type": "document",
        "number": document.number,
        "revision": document.revision,
        "name": document.path.stem,
        "path": shown_path(document.path),
        "saved": document.is_saved,
        "has_file": document.path.exists(),
        "can_undo": history.can_undo,
        "can_redo": history.can_redo,
        "history": {"position": history.position, "labels": history.labels[-50:]},
        "kept_work": document.autosave.kept_work is not None,
        "design": _shown_design(document),
        "plan": {
            **plan_data(layout, painted_sites, weights_by_site(table)),
            "printer": {key: chosen[key] for key in ("name", "area_mm", "frame_mm")},
        },
        "printers": list(printers),
        "plastics": plastic_names(),
        "limits": limits_data(layout, limits, chosen["rounding"]),
    }


def _shown_design(document: Document) -> dict[str, Any]:
    """The table of the design file with the values of the material that it names, without the lines of drawings."""
    try:
        table = dict(with_material_file(document.table, document.path.parent))
    except DesignError:  # the file of the material has gone since it was read
        table = dict(document.table)
    if drawings := table.get("rods", {}).get("import"):
        without = [{key: value for key, value in drawing.items() if key != "lines"} for drawing in drawings]
        table["rods"] = {**table["rods"], "import": without}
    return table


def limits_data(layout: Layout, limits: Limits | None, rounding: dict[str, float]) -> dict[str, Any]:
    """Ranges of sizes (mm): those that can be printed, and those that the law covers (null until it is loaded)."""
    return {
        "design": {
            "length_mm": [MIN_ARM_MM, layout.spacing_mm],
            "thickness_mm": list(THICKNESS_RANGE_MM),
            "width_mm": list(WIDTH_RANGE_MM),
            "weight": list(WEIGHT_RANGE),
        },
        "law": None if limits is None else {key: list(ends) for key, ends in limits.law.items()},
        "stretches": [] if limits is None else list(limits.stretches),
        "statement": None if limits is None else limits.statement,
        "rounding": rounding,
    }


def problem_data(error: Exception, layout: Layout | None, seq: int | None = None) -> dict[str, Any]:
    """The message `problem` of a refused change: one line, and the field, stars and place that it is about.

    Parameters
    ----------
    layout : of the design, for the sites of the stars.
    seq : number of the page's message that is refused.
    """
    if isinstance(error, BlankSheetError):
        return {"type": "problem", "kind": "no star", "seq": seq, "text": LAST_STAR}
    rows = np.empty((0, 2)) if layout is None else layout.sheet_sites
    return {
        "type": "problem",
        "kind": next((kind for of, kind in REFUSAL_KINDS.items() if isinstance(error, of)), "request"),
        "seq": seq,
        "text": " ".join(str(error).split()),
        **mistake_parts(error, rows),
    }


def failure_data(error: Exception, layout: Layout | None, work: str, seq: int | None = None) -> dict[str, Any]:
    """The message `problem` of whatever has gone wrong; the terminal shows where, if nobody has foreseen it.

    Parameters
    ----------
    layout, seq : as for `problem_data`.
    work : that went wrong, for the terminal.
    """
    if isinstance(error, Error | OSError):
        return problem_data(error, layout, seq)
    _log.error(work, exc_info=error)
    return problem_data(RuntimeError(f"{SERVER_MISTAKE}: {type(error).__name__}"), None, seq)


def opening_problem_data(error: Exception, path: Path | None, seq: int | None) -> dict[str, Any]:
    """The message `problem` of a design that does not open.

    Its field, stars and place are not those of the design that stays open, so the message has none.

    Parameters
    ----------
    path : of its file, named in the text; None without one.
    seq : as for `problem_data`.
    """
    problem = failure_data(error, None, "a request of a page", seq)
    text = problem["text"]
    if path is not None:
        text = f"{path.name}: {text.removeprefix(f'{path}: ')}"
    return {**problem, "text": text, "field": "", "stars": (), "at_mm": None}


def engine_problem_data(problem: StudioProblem) -> dict[str, Any]:
    """The message `problem` of an edit or a job that has no answer."""
    return {"type": "problem", **{name: value for name, value in asdict(problem).items() if name != "seq"}}
