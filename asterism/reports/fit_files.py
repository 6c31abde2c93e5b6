"""The files of a fit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import IO

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from asterism.draw.style import INK, PALE, style_axes
from asterism.fitting.fit import Fit
from asterism.fitting.target import TargetSurface
from asterism.pattern.design.arguments import check_type
from asterism.print.formats.obj import write_shape_obj
from asterism.reports.fit_page import fit_page
from asterism.reports.fit_plots import TARGET_COLOUR, colour_limit, draw_section
from asterism.results.files import SUMMARY_FILE, staged_result
from asterism.shape.vtu import write_rods_vtu, write_shape_vtu

_DPI = 100


def draw_target_fit(fitted: Fit, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw a fit as PNG."""
    # size of the picture in inches, and its resolution
    figure = Figure(figsize=(14.0, 8.4), dpi=_DPI, facecolor="white")
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
    figure.savefig(path_or_file, format="png", dpi=_DPI)


def _distance_map(figure: Figure, fitted: Fit) -> None:
    shape, mean = fitted.shape, fitted.distance.mean_mm
    far = colour_limit(fitted)
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


def write_fit(fitted: Fit, directory: str | Path) -> list[str]:
    """Write report.html, summary.json, fit.png, target.obj, and shape.vtu, shape.obj and rods.vtu laid on the target.

    The shape is the exact one, or the preview if the exact model was not asked for. Its field `target_distance_mm` is
    the signed distance to the target. The target is written in the pose of the fit.

    The files appear together, or none of them if writing fails.

    Returns
    -------
    Their names.

    Raises
    ------
    OutputError
        They cannot be written there.
    """
    check_type(fitted, Fit, "fit makes them")
    distance = fitted.distance
    fields = {
        **distance.shape.point_fields,
        "target_distance_mm": distance.surface_mm,
        "mean_target_distance_mm": distance.mean_mm,
    }
    shape = replace(distance.shape, point_fields=fields)
    with staged_result(directory) as folder:
        write_shape_vtu(shape, folder / "shape.vtu")
        write_rods_vtu(shape, folder / "rods.vtu")
        write_shape_obj(folder / "shape.obj", shape, fitted.summary["design"]["name"])
        (folder / "target.obj").write_text(_obj(fitted.target), encoding="ascii")
        draw_target_fit(fitted, folder / "fit.png")
        # a name may hold characters that are not valid text
        (folder / "report.html").write_text(fit_page(fitted), encoding="utf-8", errors="backslashreplace")
        (folder / SUMMARY_FILE).write_text(fitted.summary.json_text())
        return sorted(file.name for file in folder.iterdir())


def _obj(target: TargetSurface) -> str:
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in target.disk.vertices]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in target.disk.triangles]
    return "\n".join(["# target in the pose of the fit, mm", *lines]) + "\n"
