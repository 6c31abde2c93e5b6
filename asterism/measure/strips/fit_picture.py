"""A picture of a fit: curvatures of strips over their thickness, and the fitted curves."""

from __future__ import annotations

from pathlib import Path
from typing import IO

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from asterism.draw.chart_axes import add_grid, style_axes
from asterism.draw.colours import PALE
from asterism.draw.fonts import write_title
from asterism.measure.strips.strip_fit import StripFit
from asterism.pattern.design.materials import Fabric, rest_curvature
from asterism.pattern.design.residual_curvature import residual_curvature

WITH_FABRIC_COLOUR = "#2a6f97"
PEELED_COLOUR = "#c8553d"
DOUBTFUL_COLOUR = "#9d1f1f"


def draw_fit(fit: StripFit, title: str, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw a fit as PNG."""
    figure = Figure(figsize=(9, 5.4), dpi=150, facecolor="white")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    figure.subplots_adjust(left=0.08, right=0.98, bottom=0.12, top=0.79)
    ratio = fit.ratio[fit.formula]
    thicknesses = [reading.thickness_mm for reading in fit.used]
    h = np.linspace(min(thicknesses) - 0.01, max(thicknesses) + 0.01, 200)
    for stretch, fabric_mm in {(r.stretch, r.fabric_thickness_mm) for r in fit.used if not r.peeled}:
        fabric = Fabric(stretch=stretch, thickness_mm=fabric_mm)
        middle, low, high = (rest_curvature(h, fabric, fit.plastic(min(max(one, 1.0), 1e7))) for one in ratio)
        axes.fill_between(h, low, high, color=WITH_FABRIC_COLOUR, alpha=0.2, linewidth=0)
        axes.plot(h, middle, color=WITH_FABRIC_COLOUR, linewidth=1.2)
    if fit.kappa_bar:
        axes.plot(h, residual_curvature(h, fit.plastic().kappa_bar_per_mm), color=PEELED_COLOUR, linewidth=1.2)
    for peeled, colour, label in ((False, WITH_FABRIC_COLOUR, "with fabric"), (True, PEELED_COLOUR, "peeled")):
        bent = [(r.thickness_mm, r.curvature_per_mm) for r in fit.used if r.peeled == peeled and r.curvature_per_mm]
        flat = [
            (r.thickness_mm, 8 * fit.flat_height_mm / r.length_mm**2)
            for r in fit.used
            if r.peeled == peeled and r.curvature_per_mm is None
        ]
        if bent:
            axes.plot(*zip(*bent, strict=True), "o", color=colour, markersize=4, alpha=0.6, label=label)
        if flat:
            label += ", flat: below"
            axes.plot(*zip(*flat, strict=True), "v", color=colour, markersize=6, fillstyle="none", label=label)
    for one, _ in (*fit.left_out, *fit.outliers):
        place = (one.thickness_mm, one.curvature_per_mm or 0.0)
        axes.plot(*place, "x", color=DOUBTFUL_COLOUR, markersize=8)
        axes.annotate(f"  {one.strip}", place, fontsize=8, color=DOUBTFUL_COLOUR, va="center", parse_math=False)
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    style_axes(axes, "curvature of the strips, 1/mm", "thickness of the plastic, mm")
    add_grid(axes)
    axes.legend(fontsize=8, frameon=False)
    write_title(figure, 0.012, 0.93, title, 14)
    text = (
        f"E1/E2 = {ratio.value:.0f}, {ratio.low:.0f} to {'no bound' if np.isinf(ratio.high) else f'{ratio.high:.0f}'}"
    )
    text += f' ({100 * fit.confidence:g} %, shaded), rest_curvature = "{fit.formula}"; crosses: left out or doubtful'
    figure.text(0.012, 0.88, text, fontsize=10, color=PALE, parse_math=False)
    figure.savefig(path_or_file, format="png", dpi=150)
