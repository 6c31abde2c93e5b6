"""Plots of a verification: the distance over the printed sheet, and profiles through its middle."""

from __future__ import annotations

from io import BytesIO

import numpy as np
from PIL import Image

from asterism.draw.magma import magma, magma_hex
from asterism.draw.raster import rasterise
from asterism.draw.svg_chart import SvgAxes, colour_bar, svg_picture
from asterism.reports.views import BLUE, ORANGE
from asterism.shape.comparison import Comparison
from equilibrium.arrays import Floats
from pattern.geometry.planar import inside

# number of points of a profile
POINTS_PER_CUT = 241
# a profile ends at this part of the distance to the outline, so that rounding does not move it outside
MAX_CUT_SHARE = 0.999
# px, on the page
MAP_WIDTH_PX, MAP_HEIGHT_PX, BAR_ROOM_PX = 460.0, 560.0, 90.0
PROFILE_WIDTH_PX, PROFILE_HEIGHT_PX = 500.0, 420.0
BAR_STEPS = 64
# pixels of the map of the distance along the longer side of the print
MAP_PIXELS = 700


def distance_map(comparison: Comparison) -> str:
    """SVG of the distance over the print, in % of the diameter: cell means as colours, star centres as dots."""
    layout = comparison.layout
    low, high = layout.outline.min(axis=0), layout.outline.max(axis=0)
    axes = SvgAxes(low, high, MAP_WIDTH_PX, "x on the print, mm", "y on the print, mm", MAP_HEIGHT_PX)
    far = max(float(comparison.distance_mm.max()), 1e-12)
    axes.picture(*_coloured_print(comparison, far))
    axes.line(layout.outline, "#4d4d4d", 1.0, closed=True)
    stars = np.clip(comparison.star_distance_mm / far, 0.0, 1.0)
    axes.dots(layout.centres, [magma_hex(share) for share in stars])
    stops = [magma_hex(share) for share in np.linspace(0.0, 1.0, BAR_STEPS)]
    height = 0.7 * axes.height
    percent = 100.0 * far / comparison.diameter_mm
    bar = colour_bar(axes.width + 8, 0.12 * axes.height, height, stops, percent, "distance, % of the diameter")
    return svg_picture(axes.width + BAR_ROOM_PX, axes.height, [axes.group(), bar])


def _coloured_print(comparison: Comparison, far: float) -> tuple[bytes, Floats, Floats]:
    """PNG of the printed triangles in the colours of the distance up to `far` mm, and its corners in mm."""
    printed, triangles = comparison.reference.printed, comparison.reference.triangles
    low, high = printed.min(axis=0), printed.max(axis=0)
    scale = MAP_PIXELS / float((high - low).max())
    width, height = np.maximum(np.ceil((high - low) * scale).astype(int), 1)
    raster = rasterise((printed - low) * scale, np.zeros(len(printed)), triangles, int(height), int(width))
    a, b, c = raster.affine(comparison.distance_mm[:, None] / far, triangles)[..., 0]
    x, y = np.arange(width) + 0.5, np.arange(height)[:, None] + 0.5
    shares = a[raster.face] * x + b[raster.face] * y + c[raster.face]
    colours = np.rint(255.0 * magma(np.clip(shares, 0.0, 1.0))).astype(np.uint8)
    opacity = np.where(raster.face >= 0, 255, 0).astype(np.uint8)
    out = BytesIO()
    Image.fromarray(np.dstack([colours, opacity])[::-1]).save(out, "PNG")
    return out.getvalue(), low, low + np.array([width, height]) / scale


def profiles(comparison: Comparison) -> str:
    """SVG of two perpendicular cuts through the middle of the print, each in its own plane."""
    drawn: list[SvgAxes] = []
    orange = "#" + "".join(f"{round(255 * channel):02x}" for channel in ORANGE)
    for name, way in profile_directions(comparison).items():
        pair = _in_plane(*profile_cut(comparison, way))
        both = np.concatenate(pair)
        axes = SvgAxes(both.min(axis=0), both.max(axis=0), PROFILE_WIDTH_PX, "mm", "mm", PROFILE_HEIGHT_PX)
        for curve, colour in zip(pair, (BLUE, orange), strict=True):
            axes.line(curve, colour)
        axes.title(f"{name}; exact blue, preview orange")
        drawn.append(axes)
    height = max(axes.height for axes in drawn)
    groups = [axes.group(n * PROFILE_WIDTH_PX, height - axes.height) for n, axes in enumerate(drawn)]
    return svg_picture(PROFILE_WIDTH_PX * len(drawn), height, groups)


def profile_directions(comparison: Comparison) -> dict[str, Floats]:
    """Two unit directions on the print: across and along the axis of a rolled sheet, otherwise x and y."""
    axis = comparison.roll_axes_deg[0]
    a = np.radians(axis if axis is not None else 90.0)
    along, across = np.array([np.cos(a), np.sin(a)]), np.array([np.sin(a), -np.cos(a)])
    if axis is None:
        return {"along x": across, "along y": along}
    return {"across the axis of the roll": across, "along the axis": along}


def profile_cut(comparison: Comparison, direction: Floats) -> tuple[Floats, Floats]:
    """(n, 3) mm, positions of both shapes along a straight line of the print through the mean of the star centres.

    If this point is outside of the sheet, as for an L, the line passes through the nearest star.
    """
    border, centres = comparison.layout.outline, comparison.layout.centres
    middle = centres.mean(axis=0)
    if not inside(middle[None], border)[0]:
        middle = centres[np.linalg.norm(centres - middle, axis=1).argmin()]
    printed = middle + np.linspace(*_ends(border, middle, direction), POINTS_PER_CUT)[:, None] * direction
    return comparison.reference.at(printed), comparison.other.at(printed)


def _ends(border: Floats, middle: Floats, direction: Floats) -> tuple[float, float]:
    """Distances in mm from the middle to the outline along the direction, backwards (negative) and forwards."""
    normal = np.array([-direction[1], direction[0]])
    gap, along = (border - middle) @ normal, (border - middle) @ direction
    after, beyond = np.roll(gap, -1), np.roll(along, -1)
    crossing = (gap < 0.0) != (after < 0.0)
    way = gap[crossing] / (gap[crossing] - after[crossing])
    at = along[crossing] + way * (beyond - along)[crossing]
    return MAX_CUT_SHARE * float(at[at < 0.0].max()), MAX_CUT_SHARE * float(at[at > 0.0].min())


def _in_plane(exact: Floats, preview: Floats) -> tuple[Floats, Floats]:
    """(n, 2) mm, both curves projected to the best-fit plane of the exact curve, with its centre as origin."""
    plane, middle = _plane(exact), exact.mean(axis=0)
    return (exact - middle) @ plane.T, (preview - middle) @ plane.T


def _plane(curve: Floats) -> Floats:
    """(2, 3) axes of the best-fit plane of a curve: along its chord, and perpendicular to it, upwards."""
    normal = np.linalg.svd(curve - curve.mean(axis=0), full_matrices=False)[2][2]
    chord = curve[-1] - curve[0]
    chord -= (chord @ normal) * normal
    first = chord / np.linalg.norm(chord)
    second = np.cross(normal, first)
    return np.array([first, second if second[2] >= 0.0 else -second])
