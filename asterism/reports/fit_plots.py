"""Views and plots of a fit: target and shape, signed distance, needed contraction, and sections."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from asterism.draw.render import Scene, bare, scene
from asterism.draw.shading import FABRIC_SIDE
from asterism.draw.style import INK, PALE, add_grid, style_axes
from asterism.equilibrium.arrays import Floats
from asterism.fitting.fit import Fit
from asterism.measure.compare.comparison_picture import SIGNED_DISTANCE_COLOURS, surface_cut
from asterism.pattern.geometry.normals import vertex_normals
from asterism.reports.plots import BLUE, ORANGE, PLOT_DPI, aligned_views, png_of, print_figure, together

TARGET_COLOUR = "#c8553d"


def signed_distance_map(fitted: Fit) -> bytes:
    """PNG of the signed distance over the print, mean over a cell; needles are points, a cross is at the largest."""
    figure, axes = _figure_with_needles(fitted)
    shape, far = fitted.shape, colour_limit(fitted)
    mesh = Triangulation(shape.printed[:, 0], shape.printed[:, 1], shape.triangles)
    drawn = axes.tripcolor(
        mesh, fitted.distance.mean_mm, cmap=SIGNED_DISTANCE_COLOURS, vmin=-far, vmax=far, shading="gouraud"
    )
    figure.colorbar(drawn, label="mm; red: on the plastic side of the target", shrink=0.85, extend="both")
    worst = int(np.abs(fitted.distance.surface_mm).argmax())
    axes.plot(*shape.printed[worst], "X", color=INK, markersize=9, markeredgecolor="white")
    return png_of(figure)


def contraction_map(fitted: Fit) -> bytes:
    """PNG of the contraction that each place of the print needs; stars whose law does not give it are red."""
    figure, axes = _figure_with_needles(fitted)
    target_map = fitted.guess.target_map
    triangles = target_map.flat.disk.triangles
    mesh = Triangulation(target_map.printed[:, 0], target_map.printed[:, 1], triangles)
    needed = np.exp(target_map.log_contraction)
    drawn = axes.tripcolor(mesh, needed, cmap=colormaps["viridis"], shading="gouraud")
    figure.colorbar(drawn, label="length in space over printed length", shrink=0.85)
    plan = fitted.shape.layout
    assert plan is not None
    here, low, high = star_contractions(fitted)
    outside = (here < low) | (here > high)
    axes.plot(*plan.centres[~outside].T, ".", color="white", markersize=4)
    axes.plot(*plan.centres[outside].T, "o", color=TARGET_COLOUR, markersize=5, markeredgecolor="white")
    return png_of(figure)


def contraction_ranges(fitted: Fit) -> bytes:
    """PNG of the contraction that each star needs, over the range that stars have."""
    figure = Figure(figsize=(5.6, 3.6), dpi=PLOT_DPI, layout="constrained")
    axes = figure.subplots()
    here, low, high = star_contractions(fitted)
    order = np.argsort(here, kind="stable")
    rank, outside = np.arange(len(here)), ((here < low) | (here > high))[order]
    axes.axhspan(low, high, color="#cfd6e2", label="available")
    axes.plot(rank[~outside], here[order][~outside], "o", color=BLUE, markersize=3.5, label="needed")
    if outside.any():
        axes.plot(rank[outside], here[order][outside], "o", color=TARGET_COLOUR, markersize=4.5, label="not available")
    add_grid(axes)
    style_axes(axes, f"stretch {fitted.summary.stretch:g}", "stars, in the order of the needed contraction")
    axes.set_ylabel("length in space over printed length", fontsize=9, color=PALE)
    figure.legend(*axes.get_legend_handles_labels(), frameon=False, loc="outside upper right", ncols=3, fontsize=8)
    return png_of(figure)


def star_contractions(fitted: Fit) -> tuple[Floats, float, float]:
    """(S,) contraction that each star's place needs, and the smallest and the largest one of all stars."""
    plan, target_map = fitted.shape.layout, fitted.guess.target_map
    assert plan is not None
    needed = np.exp(target_map.interpolate(target_map.log_contraction, plan.centres))
    return needed, *fitted.guess.menu.range


def sections(fitted: Fit) -> bytes:
    """PNG of the sections of target and shape along x and y through the middle of the target."""
    both = np.concatenate([fitted.target.disk.vertices, fitted.shape.positions])
    width, depth, rise = np.ptp(both, axis=0)
    flatness = rise / max(min(width, depth), 1e-9)
    figure = Figure(figsize=(10.0, float(np.clip(1.2 + 5.0 * flatness, 1.8, 4.6))), dpi=PLOT_DPI, layout="constrained")
    for along, axes in enumerate(figure.subplots(1, 2)):
        _draw_section(axes, fitted, along)
    return png_of(figure)


def _draw_section(axes: Axes, fitted: Fit, along: int) -> None:
    """Draw the sections of target and shape along x (0) or y (1) through the middle of the target."""
    across = 1 - along
    disk, shape = fitted.target.disk, fitted.shape
    level = 0.5 * float(disk.vertices[:, across].min() + disk.vertices[:, across].max())
    parts: list[tuple[Any, Any, str, float]] = [
        (disk.vertices, disk.triangles, TARGET_COLOUR, 2.4),
        (shape.positions, shape.triangles, INK, 1.0),
    ]
    for positions, triangles, colour, width in parts:
        # a plane through rows of vertices would cut along edges
        segments = surface_cut(positions, triangles, across, level + 1e-6)[:, :, [along, 2]]
        axes.add_collection(LineCollection(list(segments), colors=colour, linewidths=width))
    both = np.concatenate([disk.vertices, shape.positions])[:, [along, 2]]
    low, high = both.min(axis=0), both.max(axis=0)
    room = 0.05 * float((high - low).max())
    axes.set_xlim(low[0] - room, high[0] + room)
    axes.set_ylim(low[1] - room, high[1] + room)
    axes.set_aspect("equal")
    style_axes(axes, f"cut along {'xy'[along]} through the middle: target red, shape black", "mm")


def _figure_with_needles(fitted: Fit) -> tuple[Figure, Axes]:
    plan = fitted.shape.layout
    assert plan is not None
    figure, axes = print_figure(plan)
    axes.plot(*plan.pin_points.T, "o", color=PALE, markersize=4)
    return figure, axes


def fit_views(fitted: Fit) -> dict[str, list[Floats]]:
    """Images (height, width, 4) by name, all with the same cameras and scale.

    - `target`, `shape`: alone, in perspective; the shape with its arms.
    - `overlaid`: the target in orange and the sheet in blue, in perspective, from the front and from the side.
    - `distance`: the sheet in the colours of its signed distance, red on the plastic side.
    """
    shape, target = scene(fitted.shape), _target_scene(fitted)
    things = {
        "target": target,
        "shape": shape,
        "overlaid": together(bare(fitted.shape, FABRIC_SIDE), target),
        "distance": bare(fitted.shape, _distance_colours(fitted)),
    }
    return aligned_views(things, np.concatenate([shape.points, target.points]))


def colour_limit(fitted: Fit) -> float:
    """The distance in mm at which the colours of signed distances end."""
    # colours end at this quantile of the distance, so that a few places at the rim do not make the rest pale
    # mm, smallest distance at which colours end
    return max(float(np.quantile(np.abs(fitted.distance.mean_mm), 0.98)), 0.05)


def _distance_colours(fitted: Fit) -> Floats:
    share = 0.5 + 0.5 * np.clip(fitted.distance.mean_mm / colour_limit(fitted), -1.0, 1.0)
    return np.asarray(SIGNED_DISTANCE_COLOURS(share))[:, :3]


def _target_scene(fitted: Fit) -> Scene:
    disk = fitted.target.disk
    normals = vertex_normals(disk.vertices, disk.triangles)
    colours = np.broadcast_to(ORANGE, disk.vertices.shape)
    return Scene(disk.vertices, normals, disk.triangles, len(disk.triangles), colours=colours)
