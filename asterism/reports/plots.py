"""Plots of an exact shape and of a verification.

Of a shape the bond, and the range of shapes that prints may have; of a verification both shapes, their distance, and
profiles through the middle.
"""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.tri import Triangulation

from asterism.draw.fonts import write_title
from asterism.draw.render import FABRIC_SIDE, render
from asterism.draw.scene import Camera, Scene, bare, scene, sheet_camera
from asterism.draw.style import BLUE, INK, PALE, add_grid, style_axes
from asterism.equilibrium.arrays import Floats
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.results.records.exact import VALUES, SpreadRecord
from asterism.shape.comparison import Comparison
from asterism.shape.shape import Shape

ORANGE = (0.93, 0.47, 0.16)
PLOT_DPI = 130
# of growing distances
DISTANCE_COLOURS = colormaps["magma_r"]


def comparison_views(comparison: Comparison) -> dict[str, list[Floats]]:
    """Images (height, width, 4) by name.

    - `exact`, `preview`: the shape with its arms, in perspective.
    - `overlaid`: the exact sheet in blue and the preview in orange, in perspective, from the front and from the side.
    - `distance`: the exact sheet in perspective; darker colours show a larger distance of the preview.
    """
    exact, preview = scene(comparison.reference), scene(comparison.other)
    share = comparison.distance_mm / max(float(comparison.distance_mm.max()), 1e-12)
    (right, triangles), (other, others) = ((s.positions, s.triangles) for s in (comparison.reference, comparison.other))
    things = {
        "exact": exact,
        "preview": preview,
        "overlaid": together(bare(right, triangles, FABRIC_SIDE), bare(other, others, ORANGE)),
        "distance": bare(right, triangles, DISTANCE_COLOURS(share)[:, :3]),
    }
    return aligned_views(things, np.concatenate([exact.points, preview.points]))


def aligned_views(things: Mapping[str, Scene], frame: Floats) -> dict[str, list[Floats]]:
    """Images of scenes in one perspective and scale, all around the points of `frame` (n, 3).

    The scene `overlaid` is also seen from the front and from the side.
    """
    cameras = [sheet_camera("oblique", frame), sheet_camera("front", frame), sheet_camera("side", frame)]
    return {
        name: [_framed(thing, view, frame) for view in (cameras if name == "overlaid" else cameras[:1])]
        for name, thing in things.items()
    }


def together(one: Scene, other: Scene) -> Scene:
    """Both sheets in one scene; each has its colours."""
    assert one.colours is not None and other.colours is not None
    return Scene(
        np.concatenate([one.points, other.points]),
        np.concatenate([one.normals, other.normals]),
        np.concatenate([one.triangles, other.triangles + len(one.points)]),
        len(one.triangles) + len(other.triangles),
        colours=np.concatenate([one.colours, other.colours]),
    )


def _framed(thing: Scene, view: Camera, frame: Floats) -> Floats:
    """The view of a scene, placed in a picture that encloses all points of `frame`; row 0 the lowest."""
    seen, own = view.project(frame)[:, :2], view.project(thing.points)[:, :2]
    low, high = seen.min(axis=0), seen.max(axis=0)
    # largest size of a view, in pixels
    scale = float((np.array([640, 440]) / np.maximum(high - low, 1e-3)).min())
    image = render(thing, view, scale)
    width, height = np.ceil((high - low) * scale).astype(int) + 8
    out = np.zeros((height, width, 4))
    own_middle = (own.min(axis=0) + own.max(axis=0)) / 2
    corner = (own_middle - low) * scale + 4 - np.array(image.shape[1::-1]) / 2
    column, row = np.clip(np.rint(corner).astype(int), 0, [width - image.shape[1], height - image.shape[0]])
    out[row : row + image.shape[0], column : column + image.shape[1]] = image
    return out


SLATE = "#4f6d92"
# a profile ends at this part of the distance to the outline, so that rounding does not move it outside
MAX_CUT_SHARE = 0.999


def distance_map(comparison: Comparison) -> bytes:
    """PNG of the distance over the print, in % of the diameter: cell means as colours, stars or sites as dots."""
    reference, layout = comparison.reference, comparison.layout
    figure, axes = print_figure(layout)
    percent = 100.0 / comparison.diameter_mm
    most = percent * max(float(comparison.distance_mm.max()), 1e-12)
    mesh = Triangulation(reference.printed[:, 0], reference.printed[:, 1], reference.triangles)
    drawn = axes.tripcolor(
        mesh, percent * comparison.distance_mm, cmap=DISTANCE_COLOURS, vmin=0.0, vmax=most, shading="gouraud"
    )
    figure.colorbar(drawn, label="distance, % of the diameter", shrink=0.85)
    colours = DISTANCE_COLOURS(percent * comparison.star_distance_mm / most)
    x, y = layout.sample_points.T
    axes.scatter(x, y, s=20, c=colours, edgecolors="0.4", linewidths=0.6)
    return png_of(figure)


def bond_map(shape: Shape, layout: Layout) -> bytes:
    """PNG of the force that pulls the fabric off the rods of an exact shape, over the print."""
    peel = shape.rod_fields["peel_n_per_mm"]
    most = max(float(np.abs(peel).max()), 1e-9)
    figure, axes = print_figure(layout)
    lines = shape.printed[shape.rod_edges]
    rods = axes.add_collection(LineCollection(list(lines), array=peel, cmap="coolwarm", clim=(-most, most), lw=2.5))
    figure.colorbar(rods, label="N/mm; red: pulls the fabric off, blue: presses it on", shrink=0.85)
    return png_of(figure)


def print_figure(layout: Layout) -> tuple[Figure, Axes]:
    """A figure whose height follows the print, so that a colour bar is not much higher than the sheet's outline."""
    width, height = np.ptp(layout.outline, axis=0)
    size = (5.6, float(np.clip(1.0 + 4.0 * height / width, 2.2, 4.6)))
    figure = Figure(figsize=size, dpi=PLOT_DPI, layout=ConstrainedLayoutEngine(w_pad=0.12))
    axes = figure.subplots()
    axes.set(aspect="equal", xlabel="x on the print, mm", ylabel="y on the print, mm")
    axes.plot(*np.vstack([layout.outline, layout.outline[:1]]).T, color="0.3", linewidth=0.8)
    return figure, axes


def png_of(figure: Figure) -> bytes:
    """PNG of a figure. In contrast to `Figure.savefig`, the canvas draws and lays out the figure once."""
    out = BytesIO()
    FigureCanvasAgg(figure).print_png(out)  # type: ignore[no-untyped-call]
    return out.getvalue()


def profiles(comparison: Comparison) -> list[tuple[bytes, str]]:
    """PNG and name of two perpendicular cuts through the middle of the print, each in its own plane."""
    out = []
    for name, way in _profile_directions(comparison).items():
        exact, preview = _in_plane(*profile_cut(comparison, way))
        width, rise = np.ptp(np.concatenate([exact, preview]), axis=0)
        size = (5.6, float(np.clip(1.0 + 4.6 * rise / width, 1.6, 4.2)))
        figure = Figure(figsize=size, dpi=PLOT_DPI, layout="constrained")
        axes = figure.subplots()
        axes.set(xlabel="mm", ylabel="mm")
        axes.set_aspect("equal", adjustable="datalim")
        axes.plot(*exact.T, color=SLATE)
        axes.plot(*preview.T, color=ORANGE)
        out.append((png_of(figure), f"{name}; exact blue, preview orange"))
    return out


def _profile_directions(comparison: Comparison) -> dict[str, Floats]:
    """Two unit directions on the print: across and along the axis of a rolled sheet, otherwise x and y."""
    axis = comparison.record.roll_axes_deg[0]
    a = np.radians(axis if axis is not None else 90.0)
    along, across = np.array([np.cos(a), np.sin(a)]), np.array([np.sin(a), -np.cos(a)])
    if axis is None:
        return {"along x": across, "along y": along}
    return {"across the axis of the roll": across, "along the axis": along}


def profile_cut(comparison: Comparison, direction: Floats) -> tuple[Floats, Floats]:
    """(n, 3) mm, positions of both shapes along a straight line of the print through the mean of the star centres.

    If this point is outside of the sheet, as for an L, the line passes through the nearest star. It ends at holes.
    """
    layout, centres = comparison.layout, comparison.layout.sample_points
    middle = centres.mean(axis=0)
    if not layout.is_on_sheet(middle[None])[0]:
        middle = centres[np.linalg.norm(centres - middle, axis=1).argmin()]
    printed = middle + np.linspace(*_ends(layout.edges, middle, direction), 241)[:, None] * direction
    return comparison.reference.at(printed), comparison.other.at(printed)


def _ends(edges: SheetEdges, middle: Floats, direction: Floats) -> tuple[float, float]:
    """Distances in mm from the middle to the sheet's edge along the direction, backwards (negative) and forwards."""
    normal = np.array([-direction[1], direction[0]])
    gap, along = (edges.start - middle) @ normal, (edges.start - middle) @ direction
    after, beyond = gap[edges.following], along[edges.following]
    crossing = (gap < 0.0) != (after < 0.0)
    way = gap[crossing] / (gap[crossing] - after[crossing])
    at = along[crossing] + way * (beyond - along)[crossing]
    return MAX_CUT_SHARE * float(at[at < 0.0].max()), MAX_CUT_SHARE * float(at[at > 0.0].min())


def _in_plane(exact: Floats, preview: Floats) -> tuple[Floats, Floats]:
    """(n, 2) mm, both curves in the best-fit plane of the exact one: along its chord, and upwards."""
    middle, chord = exact.mean(axis=0), exact[-1] - exact[0]
    normal = np.linalg.svd(exact - middle, full_matrices=False)[2][2]
    chord -= (chord @ normal) * normal
    first = chord / np.linalg.norm(chord)
    second = np.cross(normal, first)
    plane = np.array([first, second if second[2] >= 0.0 else -second])
    return (exact - middle) @ plane.T, (preview - middle) @ plane.T


def draw_spread(record: SpreadRecord, name: str, path: Path) -> None:
    """Draw the range of shapes of a design as PNG."""
    figure = Figure(figsize=(10, 4.2), dpi=150, facecolor="white")
    FigureCanvasAgg(figure)
    side, bars = figure.subplots(1, 2, width_ratios=(1.5, 1.0))
    figure.subplots_adjust(left=0.06, right=0.98, bottom=0.13, top=0.74, wspace=0.42)
    low, median, high = (np.array(line) for line in (record.line_low_mm, record.line_median_mm, record.line_high_mm))
    side.fill(*np.concatenate([low, high[::-1]]).T, color=BLUE, alpha=0.2, linewidth=0)
    for line, width in ((low, 0.6), (median, 1.6), (high, 0.6)):
        side.plot(*line.T, color=BLUE, linewidth=width)
    side.set_aspect("equal", adjustable="datalim")
    style_axes(side, "through the highest point, mm: nine of ten prints", "along the ground, mm")
    add_grid(side)
    for row, share in enumerate(reversed(record.shares)):
        ends = share.heights_mm
        bars.barh(row, np.ptp(ends), left=min(ends), height=0.6, color="#9fbdd0")
        bars.plot(ends[1], row, "o", color=BLUE, markersize=4)
    bars.use_sticky_edges = False
    bars.axvline(record.height_median_mm, color=INK, linewidth=0.8)
    bars.set_yticks(range(len(record.shares)), [VALUES[share.value] for share in reversed(record.shares)])
    style_axes(bars, "height by each value alone; dots: upper end", "height, mm")
    add_grid(bars)
    write_title(figure, 0.012, 0.92, name, 14)
    figure.text(0.012, 0.86, record.range_in_words, fontsize=10, color=INK)
    if record.best_measurement is not None:
        figure.text(0.012, 0.81, f"measure {record.best_measurement}", fontsize=10, color=PALE)
    figure.savefig(path, format="png", dpi=150)
