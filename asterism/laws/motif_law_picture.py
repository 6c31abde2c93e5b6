"""A picture of the law of a motif: its quantities over the direction, and over the sizes that vary."""

from __future__ import annotations

from pathlib import Path
from typing import IO, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from asterism.draw.fonts import write_title
from asterism.draw.style import PALE, add_grid, style_axes
from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.motif_plan import MotifSize
from asterism.laws.directional_values import stretch_axes, values_along

CHARTS = {
    "stretch": "length over printed length, flat",
    "rolled": "curvature of a tube, 1/mm",
    "bending": "bending stiffness, N mm",
    "membrane": "membrane stiffness, N/mm",
}
Colour = tuple[float, float, float, float]
# curves of one chart
CURVES = 6
# relative, of a cell's size to a curve's
SAME_SIZE = 1e-6
INCHES_WIDE, INCHES_A_ROW = 18.0, 3.7
INCHES_ABOVE = 1.2


def draw_motif_law(law: MotifLaw, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw the law of a motif as PNG."""
    motif_law_figure(law).savefig(path_or_file, format="png", dpi=100)


def motif_law_figure(law: MotifLaw) -> Figure:
    """The charts of the law of a motif.

    The first row of charts has the directions of the print across, the second row the first size that varies, along the
    principal axes of the flat sheet. Laws of one cell have no second row.
    """
    sizes = law.plan.sizes
    varying = [number for number, size in enumerate(sizes) if size.varies]
    rows = [_over_direction, _over_size][: 1 + bool(varying)]
    height = INCHES_ABOVE + INCHES_A_ROW * len(rows)
    figure = Figure(figsize=(INCHES_WIDE, height), dpi=100, facecolor="white")
    FigureCanvasAgg(figure)
    room = {"left": 0.035, "right": 0.99, "bottom": 0.5 / height + 0.02, "top": 1 - INCHES_ABOVE / height}
    grid = figure.add_gridspec(len(rows), len(CHARTS), wspace=0.2, hspace=0.42, **room)
    for row, curves in enumerate(rows):
        for column, (name, title) in enumerate(CHARTS.items()):
            axes = figure.add_subplot(grid[row, column])
            below = curves(axes, law, varying, name)
            style_axes(axes, title, below, size=9, side="right")
            if name != "stretch":
                axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
            add_grid(axes)
            if column == 0 and (handles := axes.get_legend_handles_labels()[0]):
                axes.legend(handles=handles, fontsize=7, frameon=False)
    write_title(figure, 0.012, 1 - 0.35 / height, f"{law.plan.design.name}: law of the motif", 14)
    cells = "1 cell" if len(law.samples) == 1 else f"{len(law.samples)} cells"
    note = f"{cells}, mesh edges of {law.edge_mm:g} mm"
    if fixed := [f"{_name(law, size)} {_middle(size):g} mm" for n, size in enumerate(sizes) if n not in varying[:2]]:
        note += f"; {', '.join(fixed)}"
    note += (
        "; dots: tubes of the cells, rolled along the direction; curves: the law; dotted curves: sizes without a law"
    )
    figure.text(0.012, 1 - 0.6 / height, note, fontsize=9, color=PALE)
    return figure


def _over_direction(axes: Axes, law: MotifLaw, varying: list[int], name: str) -> str:
    degrees = np.linspace(0.0, 180.0, 181)
    turned = np.stack([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))], -1)
    shown = _some(law.plan.sizes[varying[0]].nodes) if varying else (None,)
    for number, value in enumerate(shown):
        colour = _colour(number, len(shown))
        sizes = _sizes(law, {} if value is None else {varying[0]: value})
        tensors, _, inside = law.table(sizes)
        values = getattr(values_along(tensors, turned), name)[0]
        label = None if value is None else f"{_name(law, law.plan.sizes[varying[0]])} {value:g} mm"
        axes.plot(degrees, values, color=colour, linewidth=1.3, linestyle="-" if inside[0] else ":", label=label)
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
        tensors, _, inside = law.table(_sizes(law, {varying[0]: many} | ({} if value is None else {varying[1]: value})))
        values: Floats = getattr(values_along(tensors, stretch_axes(tensors.metric)), name)
        label = "" if value is None else f"{_name(law, law.plan.sizes[varying[1]])} {value:g} mm, "
        _both_axes(axes, many, values, inside, colour, label)
    return f"{_name(law, across)}, mm"


def _both_axes(axes: Axes, many: Floats, values: Floats, inside: Bools, colour: Colour, label: str) -> None:
    """Curves along the smaller stretch and across it; dotted where the law does not cover the sizes."""
    for column, (line, side) in enumerate((("-", "along the smaller stretch"), ("--", "across it"))):
        stated = np.where(inside, values[:, column], np.nan)
        axes.plot(many, stated, color=colour, linewidth=1.3, linestyle=line, label=f"{label}{side}")
        axes.plot(many, np.where(inside, np.nan, values[:, column]), color=colour, linewidth=0.8, linestyle=":")


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
        if each["sample"] is not None and np.allclose(each["sizes"], sizes, rtol=SAME_SIZE, atol=0.0)
    ]


def _name(law: MotifLaw, size: MotifSize) -> str:
    """'thickness', or 'thickness of lines 1, 3' if other lines have another one."""
    name = size.key.removesuffix("_mm")
    if len([each for each in law.plan.sizes if each.key == size.key]) == 1:
        return name
    return f"{name} of lines {', '.join(map(str, size.lines))}"


def _middle(size: MotifSize) -> float:
    return size.nodes[len(size.nodes) // 2]


def _some(nodes: tuple[float, ...]) -> tuple[float, ...]:
    """The first and the last node, and others between them."""
    chosen = np.linspace(0, len(nodes) - 1, min(len(nodes), CURVES)).round().astype(int)
    return tuple(nodes[number] for number in chosen)


def _colour(number: int, count: int) -> Colour:
    return colormaps["viridis"](0.9 * number / max(count - 1, 1))
