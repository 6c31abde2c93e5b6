"""A picture of a law: its quantities over the length of the arms, and its errors."""

from __future__ import annotations

from pathlib import Path
from typing import IO, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from asterism.draw.fonts import write_title
from asterism.draw.style import INK, PALE, add_grid, style_axes
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_table import QUANTITY_NAMES, LawTable
from asterism.laws.law_text import middle_sizes, table_title

CURVE_LABELS = {
    "lam": "length over printed length, flat",
    "kappa": "natural curvature, 1/mm",
    "bending": "bending stiffness, N mm",
    "a11": "membrane stiffness, N/mm",
}
# curvatures up to this one have a linear scale, larger ones a logarithmic scale
LINEAR_CURVATURE_PER_MM = 2e-3


def draw_law(law: Law, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw a law as PNG.

    Each stretch has a row of charts: curves over the length for all thicknesses, and the errors.
    """
    rows = len(law.tables)
    height = 1.2 + 3.7 * rows
    figure = Figure(figsize=(20, height), dpi=100, facecolor="white")
    FigureCanvasAgg(figure)
    room = {"left": 0.035, "right": 0.99, "bottom": 0.5 / height + 0.02, "top": 1 - 1.2 / height}
    grid = figure.add_gridspec(rows, len(CURVE_LABELS) + 1, wspace=0.24, hspace=0.42, **room)
    for number, table in enumerate(law.tables):
        for column, (name, label) in enumerate(CURVE_LABELS.items()):
            axes = figure.add_subplot(grid[number, column])
            _curves(axes, table, name)
            _tidy(axes, label, "length of the arms, mm")
            if column == 0:
                axes.legend(title="thickness", fontsize=7, title_fontsize=7, frameon=False)
        axes = figure.add_subplot(grid[number, len(CURVE_LABELS)])
        _errors(axes, law.residuals[f"{table.stretch:g}"])
        _tidy(axes, "error of single cells, %", "")
        figure.text(0.012, 1 - (0.9 + 3.72 * number) / height, table_title(table), fontsize=10, color=INK)
    title = f"{law.material.name}: law of the star pattern"
    write_title(figure, 0.012, 1 - 0.35 / height, title, 14)
    note = f"{len(law.samples)} cells, mesh edges of {law.edge_mm:g} mm"
    note += "; dots: cells; curves: the law; dotted curves: outside its range, or stars that are not scale-separated"
    figure.text(0.012, 1 - 0.6 / height, note, fontsize=9, color=PALE)
    figure.savefig(path_or_file, format="png", dpi=100)


def _curves(axes: Axes, table: LawTable, name: str) -> None:
    lengths, thicknesses = table.axis_nodes[:2]
    middle = tuple(len(nodes) // 2 for nodes in table.axis_nodes[2:])
    column = QUANTITY_NAMES.index(name)
    many = np.linspace(lengths[0], lengths[-1], 300)
    for j, thickness in enumerate(thicknesses):
        colour = colormaps["viridis"](0.9 * j / max(len(thicknesses) - 1, 1))
        row = table(many, thickness, *middle_sizes(table))
        value = row.value[name]
        stated = row.inside & ~row.not_scale_separated
        label = f"{thickness:g} mm"
        axes.plot(many, np.where(stated, value, np.nan), color=colour, linewidth=1.3, label=label)
        axes.plot(many, np.where(stated, np.nan, value), color=colour, linewidth=0.8, linestyle=":")
        line: tuple[Any, ...] = (slice(None), j, *middle)
        solved = table.solved[line]
        nodes = table.node_values[(*line, column)]
        axes.plot(lengths[solved], nodes[solved], "o", color=colour, markersize=3)
    if name == "kappa":
        if np.abs(table.node_values[..., column]).max() > LINEAR_CURVATURE_PER_MM:
            # curvatures of thin and of thick stars differ by a factor of 20
            axes.set_yscale("symlog", linthresh=LINEAR_CURVATURE_PER_MM, linscale=0.4)
        else:
            axes.set_ylim(-LINEAR_CURVATURE_PER_MM, LINEAR_CURVATURE_PER_MM)


def _errors(axes: Axes, residuals: dict[str, Any]) -> None:
    """Errors of held-out cells as dots; median and rms of left-out cells as bars."""
    entry = residuals["held_out"]
    cells = [cell for cell in entry["cells"] if cell["inside"] and not cell["tight"]]
    for x, name in enumerate(QUANTITY_NAMES):
        errors = [max(abs(cell["error_percent"][name]), 1e-3) for cell in cells]
        axes.plot([x - 0.2] * len(errors), errors, "o", color="#2a6f97", markersize=3, alpha=0.6)
        if "leave_one_out" in residuals and (loo := residuals["leave_one_out"]["errors"].get(name)):
            y = [max(loo[f"{kind}_percent"], 1e-3) for kind in ("median", "rms")]
            axes.plot([x + 0.2] * 2, y, "_-", color="#c8553d", markersize=8, linewidth=1)
    axes.set_yscale("log")
    axes.set_ylim(1e-3, 300)
    axes.set_xticks(range(len(QUANTITY_NAMES)), QUANTITY_NAMES, rotation=30, fontsize=7)
    axes.plot([], [], "o", color="#2a6f97", markersize=3, label="held out")
    axes.plot([], [], "_-", color="#c8553d", markersize=8, label="left out one by one: median to rms")
    axes.legend(fontsize=7, frameon=False, loc="upper left")


def _tidy(axes: Axes, title: str, below: str) -> None:
    style_axes(axes, title, below, size=9, side="right")
    add_grid(axes)
    for side in ("left", "bottom"):
        axes.spines[side].set_color("#c4c4cc")
