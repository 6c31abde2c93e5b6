"""Pictures of a comparison: the distance in colour, two sections, and a histogram of the distances."""

from __future__ import annotations

from pathlib import Path
from typing import IO

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from asterism.draw.bare_sheet import bare
from asterism.draw.chart_axes import style_axes
from asterism.draw.colours import INK, PALE
from asterism.draw.fonts import write_title
from asterism.draw.render import OBLIQUE, camera, render
from asterism.equilibrium.arrays import Floats
from asterism.measure.compare.scan_comparison import ScanComparison
from asterism.measure.compare.silhouette import OutlineFit

SHAPE_COLOUR = INK
SIGNED_DISTANCE_COLOURS = colormaps["RdBu_r"]
NOT_SCANNED = (0.86, 0.86, 0.88)
# resolution of the picture
COMPARISON_DPI = 100
# size of the picture, inches
COMPARISON_WIDTH_IN = 16.0
COMPARISON_HEIGHT_IN = 8.6
# a section shows the points of the scan that are nearer to its plane than this
_SECTION_HALF_WIDTH_MM = 1.0


def draw_scan(comparison: ScanComparison, title: str, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw the comparison with a scan as PNG."""
    figure = _figure(title, _words(comparison))
    far = max(float(np.quantile(np.abs(comparison.distance[comparison.used]), 0.98)), 0.1)
    scale = Normalize(-far, far)
    _coloured(figure, comparison, scale)
    bar = figure.add_axes((0.06, 0.075, 0.4, 0.022))
    figure.colorbar(ScalarMappable(scale, SIGNED_DISTANCE_COLOURS), cax=bar, orientation="horizontal")
    bar.set_title("distance of the scan, mm; red: on the plastic side; grey: not scanned", fontsize=9, color=PALE)
    positions = comparison.shape.positions
    centre = (positions.min(axis=0) + positions.max(axis=0)) / 2
    sections = figure.add_axes((0.56, 0.66, 0.42, 0.2)), figure.add_axes((0.56, 0.37, 0.42, 0.2))
    for axes, along in zip(sections, (0, 1), strict=True):
        _section(axes, comparison, along, float(centre[1 - along]))
    _histogram(figure.add_axes((0.56, 0.09, 0.42, 0.19)), comparison)
    figure.savefig(path_or_file, format="png", dpi=COMPARISON_DPI)


def draw_outline(outline_fit: OutlineFit, title: str, words: str, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw the comparison with an outline as PNG."""
    figure = _figure(title, words)
    axes = figure.add_axes((0.05, 0.09, 0.6, 0.77))
    axes.fill(*outline_fit.silhouette.T, color="#eceef2")
    axes.plot(
        *np.vstack([outline_fit.silhouette, outline_fit.silhouette[:1]]).T,
        color=SHAPE_COLOUR,
        linewidth=1.2,
        label="shape",
    )
    far = max(float(np.quantile(np.abs(outline_fit.distance), 0.98)), 0.1)
    scale = Normalize(-far, far)
    # a grey line below, because distance 0 is white
    axes.plot(*np.vstack([outline_fit.places, outline_fit.places[:1]]).T, color="#b8b8c0", linewidth=4.5)
    ends = np.stack([outline_fit.places, np.roll(outline_fit.places, -1, axis=0)], axis=1)
    axes.add_collection(
        LineCollection(list(ends), colors=SIGNED_DISTANCE_COLOURS(scale(outline_fit.distance)), linewidths=3)
    )
    axes.set_aspect("equal")
    axes.margins(0.05)
    style_axes(axes, "the outline in the colour of its distance, on the shape's silhouette", "mm")
    bar = figure.colorbar(
        ScalarMappable(scale, SIGNED_DISTANCE_COLOURS),
        cax=figure.add_axes((0.72, 0.62, 0.25, 0.025)),
        orientation="horizontal",
    )
    bar.ax.set_title("distance, mm; red: outside", fontsize=9, color=PALE)
    below = figure.add_axes((0.72, 0.15, 0.25, 0.34))
    below.hist(outline_fit.distance, bins=60, color="#2a6f97")
    style_axes(below, "length of outline at each distance", "mm")
    below.set_yticks([])
    for axis in (bar.ax, below):  # the axes have room for four numbers
        axis.xaxis.set_major_locator(MaxNLocator(4))
    figure.savefig(path_or_file, format="png", dpi=COMPARISON_DPI)


def _figure(title: str, words: str) -> Figure:
    figure = Figure(figsize=(COMPARISON_WIDTH_IN, COMPARISON_HEIGHT_IN), dpi=COMPARISON_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    size = 15 * min(1.0, 90 / max(len(title), 1))
    write_title(figure, 0.025, 0.945, title, size)
    figure.text(0.025, 0.91, words, fontsize=10, color=PALE, parse_math=False)
    return figure


def _words(comparison: ScanComparison) -> str:
    numbers = comparison.distances()
    return (
        f"rms {numbers.rms_mm:.2f} mm ({numbers.rms_percent:.2f} % of the diameter)   ·   "
        f"largest {numbers.max_mm:.2f} mm   ·   {numbers.points_left_out_percent:.0f} % of the points left out   ·   "
        f"{numbers.shape_covered_percent:.0f} % of the shape scanned"
    )


def _coloured(figure: Figure, comparison: ScanComparison, scale: Normalize) -> None:
    """Draw the shape in perspective in the colours of the distance."""
    distance = comparison.vertex_distance
    known = np.isfinite(distance)
    colours = np.where(
        known[:, None], SIGNED_DISTANCE_COLOURS(scale(np.where(known, distance, 0.0)))[:, :3], NOT_SCANNED
    )
    sheet = bare(comparison.shape, colours)
    low, high = comparison.shape.positions.min(axis=0), comparison.shape.positions.max(axis=0)
    view = camera(*OBLIQUE, (low + high) / 2, 2.6 * float(np.linalg.norm(high - low)))
    room = np.array([0.46 * COMPARISON_WIDTH_IN, 0.68 * COMPARISON_HEIGHT_IN]) * COMPARISON_DPI
    seen = np.maximum(np.ptp(view.project(sheet.points)[:, :2], axis=0), 1e-3)
    image = render(sheet, view, float((room / seen).min()))
    height, width = image.shape[:2]
    canvas = image[..., 3:] * image[..., :3] + 1 - image[..., 3:]
    left, bottom = (
        0.27 * COMPARISON_WIDTH_IN * COMPARISON_DPI - width / 2,
        0.5 * COMPARISON_HEIGHT_IN * COMPARISON_DPI - height / 2,
    )
    figure.figimage(canvas, left, bottom, origin="lower")


def _section(axes: Axes, comparison: ScanComparison, along: int, level: float) -> None:
    """Draw the section of the shape along x (0) or y (1), where the other coordinate is `level` (mm), with the scan."""
    across = 1 - along
    segments = surface_cut(comparison.shape.positions, comparison.shape.triangles, across, level)[:, :, [along, 2]]
    near = np.abs(comparison.points[:, across] - level) < _SECTION_HALF_WIDTH_MM
    for selected, colour in ((near & ~comparison.used, "#b0b0b8"), (near & comparison.used, "#c8553d")):
        axes.plot(*comparison.points[selected][:, [along, 2]].T, ".", color=colour, markersize=2.5)
    axes.add_collection(LineCollection(list(segments), colors=SHAPE_COLOUR, linewidths=1.2))
    positions = comparison.shape.positions[:, [along, 2]]
    low, high = positions.min(axis=0), positions.max(axis=0)
    room = 0.06 * float((high - low).max()) + 1.0
    axes.set_xlim(low[0] - room, high[0] + room)
    axes.set_ylim(low[1] - room, high[1] + room)
    axes.set_aspect("equal")
    style_axes(axes, f"cut along {'xy'[along]} through the middle: shape black, scan red, left out grey", "mm")


def surface_cut(positions: Floats, triangles: np.ndarray, axis: int, level: float) -> Floats:
    """(k, 2, 3) segments in which triangles intersect the plane where a coordinate is `level`."""
    height = positions[:, axis] - level
    # a vertex on the plane counts as above it, so that a triangle has two intersected edges or none
    above = height >= 0
    segments = []
    for corners in triangles[above[triangles].any(axis=1) & ~above[triangles].all(axis=1)]:
        ends = []
        for i, j in ((0, 1), (1, 2), (2, 0)):
            a, b = corners[i], corners[j]
            if above[a] != above[b]:
                share = height[a] / (height[a] - height[b])
                ends.append(positions[a] + share * (positions[b] - positions[a]))
        segments.append(ends)
    return np.array(segments).reshape(-1, 2, 3)


def _histogram(axes: Axes, comparison: ScanComparison) -> None:
    axes.hist(comparison.distance[comparison.used], bins=80, color="#2a6f97")
    axes.set_yticks([])
    style_axes(axes, "points of the scan at each distance", "mm, positive on the plastic side")
