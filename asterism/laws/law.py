"""`asterism calibrate` and `asterism law show`: a law from a campaign of unit cells, in words and as a picture.

The picture shows a law of stars over the length of the arms, with errors, and that of a motif over directions and
sizes.
"""

from __future__ import annotations

import json
import os
import platform
import time
from collections import Counter
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from asterism.draw.fonts import write_title
from asterism.draw.style import BLUE, PALE, add_grid, style_axes
from asterism.equilibrium.arrays import Floats
from asterism.homogenize.campaign.campaign import SolveCell, run_campaign
from asterism.homogenize.campaign.fit_law import fit_law
from asterism.homogenize.campaign.kept_samples import cells_folder, code_version
from asterism.homogenize.cell.point_group import MIN_RESOLVED_CURL, differs_by_direction
from asterism.homogenize.law.anisotropy import predicted_curvatures
from asterism.homogenize.law.law import Law, LawTable
from asterism.homogenize.law.law_file import PAPER_LAW, law_bytes, law_digest, load_law
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.plan import LawPlan, SampleRecord, Size, stretch_text, without_law
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL, QUANTITY_NAMES, StarLaw, StarTable
from asterism.homogenize.law.tensor_forms import TO_VOIGT, SheetTensors, plane_matrix
from asterism.pattern.design.stars import STAR_SIZES
from asterism.previews.model import PREVIEW_MODEL
from asterism.process.progress import CountLine, without_numbers
from asterism.process.version import __version__
from asterism.results.files import OutputError, check_writable, staged_result, write_file
from asterism.results.records.material import LawRecord
from asterism.results.words import table_lines


def calibrate(
    plan: LawPlan,
    output: Path,
    jobs: int = 1,
    dask: str | None = None,
    command: str = "asterism in Python",
    stream: TextIO | None = None,
    respond: SolveCell | None = None,
) -> StarLaw | MotifLaw:
    """Solve the plan's cells, those that are not there yet, fit the law and write it.

    Parameters
    ----------
    plan : of a material or of a design, see `asterism.laws.from_files`.
    jobs : processes of this machine.
    dask : address of a scheduler to use in their place.
    command : that the law's file names as its origin.
    stream : where progress is printed; standard error by default.
    respond : solves a cell, as of `run_campaign`.

    Raises
    ------
    DesignError
        There is no law of such a material.
    AddressError
        No cluster answers at the address.
    CampaignError
        There is no law: too many cells without an answer, or workers that have ended.
    OutputError
        The law or a cell cannot be written.
    """
    if (refused := without_law(plan.design)) is not None:
        raise refused
    check_writable(output.parent, output.name)
    start, folder = time.perf_counter(), cells_folder()
    try:
        with CountLine("cells", stream) as watch:
            records = run_campaign(plan, folder, jobs, dask, watch.report, respond)
    except OSError as error:
        raise OutputError(f"cannot write {folder}: {(error.strerror or str(error)).lower()}") from None
    law = fit_law(plan, records, _origin(command, start, records))
    write_file(output, law_bytes(law))
    return law


def _origin(command: str, start: float, records: Sequence[SampleRecord]) -> dict[str, Any]:
    """What made a law, for its file."""
    return {
        "command": command,
        "code": code_version(),
        "versions": {"asterism": __version__, **{name: version(name) for name in ("numpy", "scipy", "numba")}},
        "machine": {"cores": os.cpu_count(), "machine": platform.machine(), "python": platform.python_version()},
        "cell_seconds": sum(record.seconds for record in records),
        "wall_seconds_of_last_run": time.perf_counter() - start,
    }


def law_record(law: Law[Any]) -> LawRecord:
    """The summary of a law."""
    plan = law.plan.to_dict()
    return LawRecord.from_json(
        {
            "plan": plan,
            "digest": law_digest(law),
            "made": law.made,
            "residuals": law.residuals,
            "stretches": plan["stretches"],
            "edge_mm": law.edge_mm,
            "cells": len(law.samples),
            "cells_without_law": [
                {name: value for name, value in sample.items() if name != "sample"}
                for sample in law.samples
                if sample["problem"] is not None
            ],
        }
    )


def law_lines(law: Law[Any]) -> list[str]:
    """The law as lines of text."""
    lines = table_lines(law_record(law).table(), 11)
    for table in law.tables:
        lines += _errors(law, table)
    said = [f"  {line}" for line in (directions_warning(law), held_out_warning(law)) if line]
    return [*lines, *([""] if said else []), *said, *_problems(law)]


def _errors(law: Law[Any], table: LawTable) -> list[str]:
    stretch = stretch_text(table.stretch)
    entry = law.residuals.get(stretch, {}).get("held_out", {})
    errors = entry.get("errors")
    if not errors:
        return []
    title = f"  stretch {stretch}: held out, {entry['count']} cells; error in % of the cell's value"
    if entry["tight"]["count"]:
        title += f"; {entry['tight']['count']} more are not scale-separated"
    lines = ["", title, f"  {'':11} median    rms  largest"]
    for name in table.error_names:
        e = errors[name]
        lines.append(f"    {name:<10} {e['median_percent']:5.2f} {e['rms_percent']:6.2f} {e['largest_percent']:8.2f}")
    return lines


def held_out_warning(law: Law[Any]) -> str | None:
    """A large error at the held-out cells, at the worst stretch, in one line; None without one."""
    checked = {"kappa": "curvature", "curvature": "curvature", "bending": "bending stiffness"}
    largest: list[tuple[float, str]] = []
    for stretch, kinds in law.residuals.items():
        errors = kinds["held_out"]["errors"]
        rms = {words: errors[name]["rms_percent"] for name, words in checked.items() if name in errors}
        worst = max(rms.values(), default=0.0)
        # rms over the held-out cells, above which a law warns
        if worst > 5.0:
            words = " and ".join(f"{percent:.0f} % in {what}" for what, percent in rms.items())
            largest.append((worst, f"at stretch {stretch} the law's error at its held-out cells is {words} (rms)"))
    return f"{max(largest)[1]}: a plan with more sizes makes it smaller" if largest else None


def directions_warning(law: Law[Any]) -> str | None:
    """How much previews misjudge natural curvatures that differ between directions, in one line; None if they do not.

    The numbers are those of the worst direction of each cell that curls and is scale-separated.
    """
    if not isinstance(law, StarLaw) or not differs_by_direction(law.plan.design):
        return None
    missing = "the stars curl and bend differently in each direction, which previews model in part"
    percent = []
    for cell in law.samples:
        if cell["problem"] is not None or cell["length_mm"] == 0.0:
            continue
        kappa = np.array(cell["sample"]["natural_curvature"])
        largest = float(np.abs(kappa).max())
        if MIN_RESOLVED_CURL < largest * cell["sample"]["spacing_mm"] < MAX_SEPARATED_CURL:
            off = predicted_curvatures(cell["sample"], PREVIEW_MODEL.anisotropy_share) - kappa
            percent.append(100.0 * float(np.abs(off).max()) / largest)
    if not percent:
        return missing
    return (
        f"{missing}: the natural curvature of the worst direction differs by {np.median(percent):.0f} % in the "
        f"median of {len(percent)} cells, by {max(percent):.0f} % at most"
    )


def _problems(law: Law[Any]) -> list[str]:
    """The reasons why cells have no law, without their numbers, and how often each occurs."""
    reasons = Counter(without_numbers(s["problem"]) for s in law.samples if s["problem"] is not None)
    lines = [f"    {count:4d}  {reason}" for reason, count in reasons.most_common()]
    return ["", "  cells without a law", *lines] if lines else []


def show_law(path: Path | None, output: Path | None) -> list[str]:
    """Write law.png and summary.json; the lines to print.

    Parameters
    ----------
    path : of the law; None for the paper's.
    output : the folder; by default beside the law.

    Raises
    ------
    LawError
        The file is not a law, or has another format.
    """
    law = load_law(path or PAPER_LAW)
    # the folder of a design's results has the design's name
    own = "paper-law" if path is None else path.stem if path.stem.endswith("law") else f"{path.stem}-law"
    directory = output or (path or Path("paper.npz")).with_name(own)
    check_writable(directory)
    with staged_result(directory) as folder:
        law_figure(law).savefig(folder / "law.png", dpi=100)
        text = json.dumps(law_record(law).to_json(), indent=1, allow_nan=False) + "\n"
        (folder / "summary.json").write_text(text, encoding="utf-8")
    return [*law_lines(law), f"{directory}: law.png, summary.json"]


STAR_CHARTS = {
    "lam": "length over printed length, flat",
    "kappa": "natural curvature, 1/mm",
    "bending": "bending stiffness, N mm",
    "a11": "membrane stiffness, N/mm",
}
MOTIF_CHARTS = {
    "stretch": "length over printed length, flat",
    "rolled": "curvature of a tube, 1/mm",
    "bending": "bending stiffness, N mm",
    "membrane": "membrane stiffness, N/mm",
}
Colour = tuple[float, float, float, float]


def law_figure(law: StarLaw | MotifLaw) -> Figure:
    """The charts of a law.

    Each stretch of stars has a row of charts: curves over the length for all thicknesses, and the errors. The first row
    of a motif has the directions of the print across, the second row the first size that varies, along the principal
    axes of the flat sheet. Motifs of one cell have no second row.
    """
    return _star_figure(law) if isinstance(law, StarLaw) else _motif_figure(law)


def _star_figure(law: StarLaw) -> Figure:
    note = "dots: cells; curves: the law; dotted curves: outside its range, or stars that are not scale-separated"
    figure, charts = _charts(law, "law of the star pattern", len(law.tables), len(STAR_CHARTS) + 1, note)
    for number, table in enumerate(law.tables):
        for column, (name, label) in enumerate(STAR_CHARTS.items()):
            axes = charts[number][column]
            _star_curves(axes, table, name)
            style_axes(axes, label, "length of the arms, mm", size=9, side="right")
            if column == 0:
                sizes = zip(STAR_SIZES[2:], _middle_sizes(table), strict=True)
                others = "".join(f", {axis.name} {size:g} mm" for axis, size in sizes)
                title = f"stretch {stretch_text(table.stretch)}{others}; thickness"
                axes.legend(title=title, fontsize=7, title_fontsize=7, frameon=False)
        errors = charts[number][-1]
        _star_errors(errors, table, law.residuals[stretch_text(table.stretch)]["held_out"])
        style_axes(errors, "error of held-out cells, %", "", size=9, side="right")
    return figure


def _charts(law: StarLaw | MotifLaw, title: str, rows: int, columns: int, note: str) -> tuple[Figure, list[list[Axes]]]:
    """A figure with title, note and empty charts."""
    above = 1.2  # inches
    height = above + 3.7 * rows
    figure = Figure(figsize=(4.2 * columns, height), dpi=100, facecolor="white")
    FigureCanvasAgg(figure)
    room = {"left": 0.035, "right": 0.99, "bottom": 0.5 / height + 0.02, "top": 1 - above / height}
    grid = figure.add_gridspec(rows, columns, wspace=0.24, hspace=0.42, **room)
    charts = [[figure.add_subplot(grid[row, column]) for column in range(columns)] for row in range(rows)]
    for axes in (each for row in charts for each in row):
        add_grid(axes)
    write_title(figure, 0.012, 1 - 0.35 / height, f"{law.plan.design.name}: {title}", 14)
    cells = "1 cell" if len(law.samples) == 1 else f"{len(law.samples)} cells"
    text = f"{cells}, mesh edges of {law.edge_mm:g} mm; {note}"
    figure.text(0.012, 1 - 0.6 / height, text, fontsize=9, color=PALE)
    return figure, charts


def _star_curves(axes: Axes, table: StarTable, name: str) -> None:
    lengths, thicknesses = table.plan.axis_nodes[:2]
    middle = tuple(len(nodes) // 2 for nodes in table.plan.axis_nodes[2:])
    column = QUANTITY_NAMES.index(name)
    many = np.linspace(lengths[0], lengths[-1], 300)
    for j, thickness in enumerate(thicknesses):
        colour = _colour(j, len(thicknesses))
        row = table(many, thickness, *_middle_sizes(table))
        value = row.value[name]
        stated = row.inside & ~row.not_scale_separated
        label = f"{thickness:g} mm"
        axes.plot(many, np.where(stated, value, np.nan), color=colour, linewidth=1.3, label=label)
        axes.plot(many, np.where(stated, np.nan, value), color=colour, linewidth=0.8, linestyle=":")
        line: tuple[Any, ...] = (slice(None), j, *middle)
        solved, nodes = table.solved[line], table.node_values[(*line, column)]
        axes.plot(lengths[solved], nodes[solved], "o", color=colour, markersize=3)
    if name == "kappa":
        linear = 2e-3  # 1/mm: larger curvatures, of thin stars, have a logarithmic scale
        if np.abs(table.node_values[..., column]).max() > linear:
            axes.set_yscale("symlog", linthresh=linear, linscale=0.4)
        else:
            axes.set_ylim(-linear, linear)


def _middle_sizes(table: StarTable) -> tuple[float, ...]:
    """The middle node of each axis after the first two, which the charts vary."""
    return tuple(float(nodes[len(nodes) // 2]) for nodes in table.plan.axis_nodes[2:])


def _star_errors(axes: Axes, table: StarTable, held_out: dict[str, Any]) -> None:
    """Errors of held-out cells as dots."""
    cells = [cell for cell in held_out["cells"] if cell["inside"] and not cell["tight"]]
    for x, name in enumerate(table.error_names):
        errors = [max(abs(cell["error_percent"][name]), 1e-3) for cell in cells]
        axes.plot([x] * len(errors), errors, "o", color=BLUE, markersize=3, alpha=0.6)
    axes.set_yscale("log")
    axes.set_ylim(1e-3, 300)
    axes.set_xticks(range(len(table.error_names)), table.error_names, rotation=30, fontsize=7)


def _motif_figure(law: MotifLaw) -> Figure:
    sizes = law.plan.sizes
    varying = [number for number, size in enumerate(sizes) if size.varies]
    rows = [_over_direction, _over_size][: 1 + bool(varying)]
    note = "dots: tubes of the cells, rolled along the direction; curves: the law; dotted curves: sizes without a law"
    if fixed := [f"{_name(law, size)} {_middle(size):g} mm" for n, size in enumerate(sizes) if n not in varying[:2]]:
        note = f"{', '.join(fixed)}; {note}"
    figure, charts = _charts(law, "law of the motif", len(rows), len(MOTIF_CHARTS), note)
    for row, curves in zip(charts, rows, strict=True):
        for axes, (name, title) in zip(row, MOTIF_CHARTS.items(), strict=True):
            below = curves(axes, law, varying, name)
            style_axes(axes, title, below, size=9, side="right")
            if name != "stretch":
                axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
        if handles := row[0].get_legend_handles_labels()[0]:
            row[0].legend(handles=handles, fontsize=7, frameon=False)
    return figure


def _over_direction(axes: Axes, law: MotifLaw, varying: list[int], name: str) -> str:
    degrees = np.linspace(0.0, 180.0, 181)
    turned = np.stack([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))], -1)
    shown = _some(law.plan.sizes[varying[0]].nodes) if varying else (None,)
    for number, value in enumerate(shown):
        colour = _colour(number, len(shown))
        sizes = _sizes(law, {} if value is None else {varying[0]: value})
        found = law.tables[0](sizes)
        values = values_along(found, turned)[name][0]
        label = None if value is None else f"{_name(law, law.plan.sizes[varying[0]])} {value:g} mm"
        axes.plot(degrees, values, color=colour, linewidth=1.3, linestyle="-" if found.inside[0] else ":", label=label)
        if name in ("rolled", "bending"):
            tubes = [tube for cell in _cells(law, sizes[0]) for tube in cell["directions"]]
            key = "curvature" if name == "rolled" else "bending"
            angles = [np.degrees(tube["direction_rad"]) % 180.0 for tube in tubes]
            axes.plot(angles, [tube[key] for tube in tubes], "o", color=colour, markersize=3)
    axes.set_xticks(range(0, 181, 30))
    return "direction, degrees from x"


def _over_size(axes: Axes, law: MotifLaw, varying: list[int], name: str) -> str:
    across = law.plan.sizes[varying[0]]
    many = np.geomspace(across.nodes[0], across.nodes[-1], 200)
    others = _some(law.plan.sizes[varying[1]].nodes) if len(varying) > 1 else (None,)
    for number, value in enumerate(others):
        colour = _colour(number, len(others))
        found = law.tables[0](_sizes(law, {varying[0]: many} | ({} if value is None else {varying[1]: value})))
        values = values_along(found, stretch_axes(found.metric))[name]
        label = "" if value is None else f"{_name(law, law.plan.sizes[varying[1]])} {value:g} mm, "
        # dotted where the law does not cover the sizes
        for of, line, side in zip(values.T, ("-", "--"), ("along the smaller stretch", "across it"), strict=True):
            stated, other = np.where(found.inside, of, np.nan), np.where(found.inside, np.nan, of)
            axes.plot(many, stated, color=colour, linewidth=1.3, linestyle=line, label=f"{label}{side}")
            axes.plot(many, other, color=colour, linewidth=0.8, linestyle=":")
    return f"{_name(law, across)}, mm"


def _sizes(law: MotifLaw, chosen: dict[int, float | Floats]) -> Floats:
    """(n, A) sizes of the law: the middle nodes, but for the chosen ones."""
    columns = [np.asarray(chosen.get(n, _middle(size)), float) for n, size in enumerate(law.plan.sizes)]
    if not columns:
        return np.empty((1, 0))
    return np.stack([np.atleast_1d(column) for column in np.broadcast_arrays(*columns)], -1)


def _cells(law: MotifLaw, sizes: Floats) -> list[dict[str, Any]]:
    """The answers of the cells with these sizes."""
    return [
        each["sample"]
        for each in law.samples
        if each["sample"] is not None
        and np.allclose([each[name] for name in law.plan.names], sizes, rtol=1e-6, atol=0.0)
    ]


def _name(law: MotifLaw, size: Size) -> str:
    """'thickness', or 'thickness of lines 1, 3' if other lines have another one."""
    name = size.key.removesuffix("_mm")
    if len([each for each in law.plan.sizes if each.key == size.key]) == 1:
        return name
    return f"{name} of lines {', '.join(map(str, size.lines or ()))}"


def _middle(size: Size) -> float:
    return size.nodes[len(size.nodes) // 2]


def _some(nodes: tuple[float, ...]) -> tuple[float, ...]:
    """The first and the last node, and up to four others between them."""
    chosen = np.linspace(0, len(nodes) - 1, min(len(nodes), 6)).round().astype(int)
    return tuple(nodes[number] for number in chosen)


def _colour(number: int, count: int) -> Colour:
    return colormaps["viridis"](0.9 * number / max(count - 1, 1))


def values_along(tensors: SheetTensors, axes: Floats) -> dict[str, Floats]:
    """Values (n, m) of n sheets along unit vectors (n, m, 2), or (m, 2) for all sheets.

    - `stretch`: length of the flat sheet over its printed length;
    - `membrane`, `bending`: N/mm and N mm, stiffness against a strain or curvature along the direction alone;
    - `rolled`: 1/mm, curvature of a sheet that rolls into a tube along the direction; positive where edges bend down.

    A tube of the curvature k along the direction with Voigt form f has the bending energy (k f - K) D (k f - K) / 2,
    which is least at k = f D K / f D f.
    """
    x, y = np.moveaxis(axes, -1, 0)
    forms = np.stack([x * x, y * y, 2.0 * x * y], -1)
    forms = np.broadcast_to(forms, (len(tensors.metric), *forms.shape[-2:]))
    blocks = tensors.stiffness[:, :3, :3], tensors.stiffness[:, 3:, 3:]
    membrane, bending = (np.einsum("nma,nab,nmb->nm", forms, block, forms) for block in blocks)
    moments = np.einsum("nab,nb->na", blocks[1], tensors.curvature * TO_VOIGT)
    squares, along = (np.einsum("nma,na->nm", forms, of) for of in (tensors.metric, moments))
    return {"stretch": np.sqrt(squares), "membrane": membrane, "bending": bending, "rolled": -along / bending}


def stretch_axes(metric: Floats) -> Floats:
    """(n, 2, 2) unit vectors along the smaller stretch of metrics (n, 3), and across it; x and y if both are equal."""
    squares, columns = np.linalg.eigh(plane_matrix(metric))
    axes = np.swapaxes(columns, -1, -2)
    axes[np.ptp(squares, axis=-1) < 1e-4] = np.eye(2)
    return axes
