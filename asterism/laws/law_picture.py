"""A picture of a law: its curves over the length of the arms, and its errors."""

from __future__ import annotations

from pathlib import Path
from typing import IO, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from asterism.draw.chart_axes import add_grid, style_axes
from asterism.draw.colours import INK, PALE
from homogenize.law.law import Law
from homogenize.law.law_table import QUANTITY_NAMES, LawTable

CURVE_LABELS = {
    "lam": "length over printed length, flat",
    "kappa": "natural curvature, 1/mm",
    "bending": "bending stiffness, N mm",
    "a11": "membrane stiffness, N/mm",
}
# 1/mm, up to which curvatures are drawn to a linear scale
LINEAR_CURVATURE_PER_MM = 2e-3


def draw_law(law: Law, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw a law as PNG: a row of curves for each stretch, several thicknesses in each, and its errors."""
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
        width = table.axes[2][len(table.axes[2]) // 2]
        text = f"stretch {table.stretch:g}, width {width:g} mm"
        figure.text(0.012, 1 - (0.9 + 3.72 * number) / height, text, fontsize=10, color=INK)
    title = f"{law.material.name}: the law of the sheet"
    figure.text(0.012, 1 - 0.35 / height, title, fontsize=14, weight="bold", color=INK, parse_math=False)
    note = f"{len(law.samples)} cells, mesh edges of {law.edge_mm:g} mm"
    note += "; dots are cells, curves the law, dotted where a sheet curls too tightly for it, or no cell is near"
    figure.text(0.012, 1 - 0.6 / height, note, fontsize=9, color=PALE)
    figure.savefig(path_or_file, format="png", dpi=100)


def _curves(axes: Axes, table: LawTable, name: str) -> None:
    lengths, thicknesses, widths = table.axes
    middle = len(widths) // 2
    many = np.linspace(lengths[0], lengths[-1], 300)
    for j in range(len(thicknesses)):
        h = float(thicknesses[j])
        colour = colormaps["viridis"](0.9 * j / max(len(thicknesses) - 1, 1))
        found = table(many, h, widths[middle])
        value = found.value[name]
        stated = found.inside & ~found.tight
        axes.plot(many, np.where(stated, value, np.nan), color=colour, linewidth=1.3, label=f"{h:g} mm")
        axes.plot(many, np.where(stated, np.nan, value), color=colour, linewidth=0.8, linestyle=":")
        good = table.good[:, j, middle]
        nodes = table.nodes[good, j, middle, QUANTITY_NAMES.index(name)]
        axes.plot(lengths[good], nodes, "o", color=colour, markersize=3)
    if name == "kappa":
        if np.abs(table.nodes[..., QUANTITY_NAMES.index(name)]).max() > LINEAR_CURVATURE_PER_MM:
            # curvature differs by a factor of twenty between thin and thick stars
            axes.set_yscale("symlog", linthresh=LINEAR_CURVATURE_PER_MM, linscale=0.4)
        else:
            axes.set_ylim(-LINEAR_CURVATURE_PER_MM, LINEAR_CURVATURE_PER_MM)


def _errors(axes: Axes, residuals: dict[str, Any]) -> None:
    """Every held-out cell as a dot, the median and the root mean square as bars."""
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
    axes.plot([], [], "_-", color="#c8553d", markersize=8, label="left out on its line: median to rms")
    axes.legend(fontsize=7, frameon=False, loc="upper left")


def _tidy(axes: Axes, title: str, below: str) -> None:
    style_axes(axes, title, below, size=9, side="right")
    add_grid(axes)
    for side in ("left", "bottom"):
        axes.spines[side].set_color("#c4c4cc")
