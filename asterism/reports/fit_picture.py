"""Picture of a fit: two sections of target and shape, the distance on the print, and the lengths of the arms."""

from __future__ import annotations

from pathlib import Path
from typing import IO

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from asterism.draw.chart_axes import style_axes
from asterism.draw.colours import INK, PALE
from asterism.fitting.result import Fit
from asterism.reports.fit_plots import TARGET_COLOUR, draw_section

# size of the picture in inches, and its resolution
FIT_PICTURE_SIZE_IN = (14.0, 8.4)
FIT_PICTURE_DPI = 100


def draw_target_fit(fitted: Fit, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw a fit as PNG."""
    figure = Figure(figsize=FIT_PICTURE_SIZE_IN, dpi=FIT_PICTURE_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    summary, distance = fitted.summary, fitted.distance
    by = "exact model" if fitted.verification is not None else "preview"
    figure.text(0.03, 0.95, fitted.design.name, fontsize=15, weight="bold", color=INK, parse_math=False)
    words = (
        f"{by}: rms {distance.mean_percent:.2f} % of the diameter ({summary.diameter_mm:.1f} mm), with bumps "
        f"{distance.surface_percent:.2f} %, largest {distance.largest_percent:.1f} %   ·   {summary.stars} stars, "
        f"{summary.held_by}, stretch {summary.stretch:g}"
    )
    figure.text(0.03, 0.915, words, fontsize=10, color=PALE, parse_math=False)
    for row, along in enumerate((0, 1)):
        draw_section(figure.add_axes((0.05, 0.53 - 0.45 * row, 0.42, 0.3)), fitted, along)
    _distance_map(figure, fitted)
    _length_map(figure, fitted)
    figure.savefig(path_or_file, format="png", dpi=FIT_PICTURE_DPI)


def _distance_map(figure: Figure, fitted: Fit) -> None:
    shape, mean = fitted.shape, fitted.distance.mean_mm
    far = max(float(np.quantile(np.abs(mean), 0.98)), 0.05)
    axes = figure.add_axes((0.52, 0.5, 0.36, 0.36))
    mesh = Triangulation(shape.printed[:, 0], shape.printed[:, 1], shape.triangles)
    drawn = axes.tripcolor(mesh, mean, cmap=colormaps["RdBu_r"], vmin=-far, vmax=far, shading="gouraud")
    axes.set_aspect("equal")
    style_axes(axes, "distance to the target on the print, mean over a cell; red: on the plastic side", "")
    figure.colorbar(drawn, cax=figure.add_axes((0.9, 0.53, 0.012, 0.28))).set_label("mm", color=PALE)


def _length_map(figure: Figure, fitted: Fit) -> None:
    plan = fitted.shape.layout
    axes = figure.add_axes((0.52, 0.05, 0.36, 0.36))
    if plan is None:
        return
    starts, ends = plan.centres[plan.arm_star], plan.arm_tip
    lines = LineCollection(
        list(np.stack([starts, ends], axis=1)),
        array=plan.arm_thickness[:, 0],
        cmap=colormaps["viridis"],
        linewidths=2.5,
    )
    axes.add_collection(lines)
    axes.plot(*np.vstack([plan.outline, plan.outline[:1]]).T, color=INK, linewidth=1.0)
    axes.plot(*plan.pin_points.T, "o", color=TARGET_COLOUR, markersize=4)
    axes.set_aspect("equal")
    style_axes(axes, "print: arms in the colour of their thickness, needles red", "mm")
    figure.colorbar(lines, cax=figure.add_axes((0.9, 0.08, 0.012, 0.28))).set_label("thickness, mm", color=PALE)
