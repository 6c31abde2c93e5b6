"""What the page shows as plain data: the document with its plan, printers, and problems."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.errors import Error
from asterism.pattern.design.design import WEIGHT_RANGE
from asterism.pattern.design.errors import BlankSheetError, DesignError
from asterism.pattern.design.material_files import with_material_file
from asterism.pattern.design.stars import MIN_ARM_MM, ROD_SIZE_KEYS, STAR_SIZES, Site
from asterism.pattern.layout.layout import Layout
from asterism.print.bed_placement import room_mm
from asterism.print.printer import load_plastic, load_printer, readable_profiles
from asterism.studio.design_file import KeptFileError
from asterism.studio.document import Document
from asterism.studio.file_names import shown_path
from asterism.studio.history import rounded
from asterism.studio.messages import Limits, mistake_parts
from asterism.studio.requests import RequestError
from asterism.studio.star_sizes import PLAIN_WEIGHT, entries_by_site, weights_by_site

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
        "position": history.position,
        "kept_work": [{"name": kept.path.name, "time": kept.time} for kept in document.autosave.kept],
        "design": _shown_design(document),
        "plan": {
            **plan_data(layout, painted_sites, weights_by_site(table)),
            "hole_rings": document.hole_rings,
            "printer": {key: chosen[key] for key in ("name", "area_mm", "frame_mm")},
        },
        "printers": list(printers),
        "plastics": list(plastic_entries()),
        # ranges of sizes (mm): those that can be printed, and those that the law covers (null until it is loaded)
        "limits": {
            "design": {
                **{size.key: list(size.limits_at(layout.spacing_mm)) for size in STAR_SIZES},
                "weight": list(WEIGHT_RANGE),
            },
            "law": None if limits is None else {key: list(ends) for key, ends in limits.law.items()},
            "stretches": [] if limits is None else list(limits.stretches),
            "rounding": chosen["rounding"],
        },
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


def problem_data(
    error: Exception, layout: Layout | None, seq: int | None = None, work: str = "a request of a page"
) -> dict[str, Any]:
    """The message `problem` of whatever has gone wrong: one line, and the field, stars and place that it is about.

    The terminal shows where it is, if nobody has foreseen it.

    Parameters
    ----------
    layout : of the design, for the sites of the stars.
    seq : number of the page's message that is refused.
    work : that went wrong, for the terminal.
    """
    if isinstance(error, BlankSheetError):
        # Previews, exact shapes and prints need stars; the engine shows a sheet without them while the pointer is down.
        text = f"A sheet needs at least one star with an arm of {MIN_ARM_MM:g} mm; the design stays as it is."
        return {"type": "problem", "kind": "no star", "seq": seq, "text": text}
    if not isinstance(error, Error | OSError):
        _log.error(work, exc_info=error)
        error, layout = RuntimeError(f"{SERVER_MISTAKE}: {type(error).__name__}"), None
    rows = np.empty((0, 2)) if layout is None else layout.sheet_sites
    kind = error.kind if isinstance(error, KeptFileError) else "request"
    return {
        "type": "problem",
        "kind": "design" if isinstance(error, DesignError) else kind,
        "seq": seq,
        "text": " ".join(str(error).split()),
        **mistake_parts(error, rows),
    }


def opening_problem_data(error: Exception, path: Path | None, seq: int | None) -> dict[str, Any]:
    """The message `problem` of a design that does not open, with the name of its file; another one stays open."""
    problem = problem_data(error, None, seq)
    text = problem["text"]
    return elsewhere(problem, text if path is None else f"{path.name}: {text.removeprefix(f'{path}: ')}")


def elsewhere(problem: dict[str, Any], text: str) -> dict[str, Any]:
    """The message `problem` of a design that is not open: no field, star or place of the open one is meant."""
    return {**problem, "text": text, "field": "", "stars": (), "at_mm": None}


@cache
def printer_entries() -> tuple[dict[str, Any], ...]:
    """Name, title, printable area and frame (mm), and layer heights of each printer."""
    entries = []
    for name, printer in readable_profiles("printers", load_printer, _warn):
        rounding = printer.roundings()[0]
        entries.append(
            {
                "name": name,
                "title": printer.name,
                "area_mm": [float(side) for side in room_mm(printer)],
                "frame_mm": [float(side) for side in printer.frame.size_mm],
                "rounding": {key: getattr(rounding, key) for key in ("first_layer_mm", "layer_mm", "line_mm")},
            }
        )
    return tuple(entries)


@cache
def plastic_entries() -> tuple[dict[str, str], ...]:
    """Name and title of each plastic."""
    plastics = readable_profiles("plastics", load_plastic, _warn)
    return tuple({"name": name, "title": plastic.name} for name, plastic in plastics)


def _warn(error: DesignError) -> None:
    """The terminal names a file of the user that is left out."""
    _log.warning("left out: %s", " ".join(str(error).split()))


def known_printer(name: str) -> str:
    """The name, if there is a profile of that name.

    Raises
    ------
    RequestError
        There is none.
    """
    if name not in [entry["name"] for entry in printer_entries()]:
        raise RequestError(f"printer: there is no {name!r}")
    return name


def plan_data(layout: Layout, painted_sites: set[Site], weights: Mapping[Site, float]) -> dict[str, Any]:
    """Plain data of a layout; lengths in mm.

    Parameters
    ----------
    painted_sites : sites whose sizes differ from the design's profiles.
    weights : of places in a fit, where they are painted.

    Returns
    -------
    outline_mm, spacing_mm, sites (in the order of the stars' numbers: site, at_mm, sizes_mm, arms, removed,
    painted, weight), rods (without the arms of stars), holes_mm, pins (one entry a table of the design).
    """
    places = layout.lattice.place(layout.sheet_sites)
    sites: list[dict[str, Any]] = [
        {
            "site": site,
            "at_mm": at,
            "sizes_mm": sizes,
            "arms": [],
            "removed": sizes[0] == 0.0,
            "painted": tuple(site) in painted_sites,
            "weight": weights.get(tuple(site), PLAIN_WEIGHT),
        }
        for site, at, sizes in zip(
            layout.sheet_sites.tolist(), rounded(places), rounded(layout.site_sizes_mm), strict=True
        )
    ]
    ends = np.stack([layout.centres[layout.arm_star], layout.arm_tip], axis=1)
    for number, arm in zip(layout.star_number[layout.arm_star].tolist(), rounded(ends), strict=True):
        sites[number]["arms"].append(arm)
    return {
        "outline_mm": rounded(layout.outline),
        "spacing_mm": layout.spacing_mm,
        "sites": sites,
        "rods": [
            {
                "name": rod.name,
                "points_mm": rounded(rod.points),
                **{key: rounded(values) for key, values in zip(ROD_SIZE_KEYS, rod.sections.T, strict=True)},
            }
            for rod in layout.drawn_rods
        ],
        "holes_mm": [rounded(ring) for ring in layout.holes],
        "pins": [
            {
                "points_mm": rounded(pins.points),
                "edges": [rounded(np.array(segment)) for segment in pins.segments(layout.edges)],
                "places_mm": rounded(pins.places(pins.points)),
            }
            for pins in layout.pins
        ],
    }
