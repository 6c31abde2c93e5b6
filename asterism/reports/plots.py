"""Views and plots of a verification: both shapes, the distance over the sheet, and profiles through the middle."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from asterism.draw.chart import RIGHT, Chart
from asterism.draw.raster import rasterise
from asterism.draw.render import Camera, Scene, bare, render, scene, sheet_camera
from asterism.draw.shading import FABRIC_SIDE
from asterism.draw.style import INK
from asterism.equilibrium.arrays import Floats
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.reports.html import png
from asterism.shape.comparison import Comparison

ORANGE = (0.93, 0.47, 0.16)
# largest size of a view
MAX_VIEW_HEIGHT_PX = 440
MAX_VIEW_WIDTH_PX = 640
# of growing distances, from 0 to 255: the colours of matplotlib's "magma", reversed
DISTANCE_COLOURS = np.array(
    [
        [252, 253, 191], [254, 194, 135], [251, 135, 97], [229, 80, 100], [181, 54, 122], [129, 37, 129],
        [79, 18, 123], [28, 16, 68], [0, 0, 4],
    ]
)  # fmt: skip


def comparison_views(comparison: Comparison) -> dict[str, list[Floats]]:
    """Images (height, width, 4) by name.

    - `exact`, `preview`: the shape with its arms, in perspective.
    - `overlaid`: the exact sheet in blue and the preview in orange, in perspective, from the front and from the side.
    - `distance`: the exact sheet in perspective; darker colours show a larger distance of the preview.
    """
    exact, preview = scene(comparison.reference), scene(comparison.other)
    things = {
        "exact": exact,
        "preview": preview,
        "overlaid": together(bare(comparison.reference, FABRIC_SIDE), bare(comparison.other, ORANGE)),
        "distance": bare(comparison.reference, colours_of(comparison)),
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


def colours_of(comparison: Comparison) -> Floats:
    """(V, 3) colours of the distance at the vertices of the exact sheet, from zero to its maximum."""
    return distance_colours(comparison.distance_mm / max(float(comparison.distance_mm.max()), 1e-12))


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
    scale = float((np.array([MAX_VIEW_WIDTH_PX, MAX_VIEW_HEIGHT_PX]) / np.maximum(high - low, 1e-3)).min())
    image = render(thing, view, scale)
    width, height = np.ceil((high - low) * scale).astype(int) + 8
    out = np.zeros((height, width, 4))
    own_middle = (own.min(axis=0) + own.max(axis=0)) / 2
    corner = (own_middle - low) * scale + 4 - np.array(image.shape[1::-1]) / 2
    column, row = np.clip(np.rint(corner).astype(int), 0, [width - image.shape[1], height - image.shape[0]])
    out[row : row + image.shape[0], column : column + image.shape[1]] = image
    return out


BLUE = "#4f6d92"
# a profile ends at this part of the distance to the outline, so that rounding does not move it outside
MAX_CUT_SHARE = 0.999


def distance_map(comparison: Comparison) -> bytes:
    """SVG of the distance over the print, in % of the diameter: cell means as colours, stars or sites as dots."""
    reference, layout = comparison.reference, comparison.layout
    low, high = layout.outline.min(axis=0), layout.outline.max(axis=0)
    chart = Chart(low, high, 560.0, 440.0, ("x on the print, mm", "y on the print, mm"), RIGHT)
    width, height = np.ceil(chart.size).astype(int)
    places = (reference.printed - low) * chart.scale
    raster = rasterise(places, np.zeros(len(places)), reference.triangles, height, width)
    seen, (row, column) = raster.face >= 0, np.indices(raster.face.shape) + 0.5
    along, up, constant = raster.affine(comparison.distance_mm[:, None], reference.triangles)[:, raster.face, 0]
    most = max(float(comparison.distance_mm.max()), 1e-12)
    image = np.dstack([distance_colours((along * column + up * row + constant) / most), seen])
    chart.picture(png(image))
    chart.dots(layout.sample_points, distance_colours(comparison.star_distance_mm / most))
    chart.line(np.concatenate([layout.outline, layout.outline[:1]]), INK, 1.0)
    most_percent = 100.0 * most / comparison.diameter_mm
    chart.colour_bar(distance_colours(np.linspace(0.0, 1.0, 64)), most_percent, "distance, % of the diameter")
    return chart.svg()


def distance_colours(part: Floats) -> Floats:
    """(..., 3) colours from 0 to 1 of distances over the largest one."""
    at = np.linspace(0.0, 1.0, len(DISTANCE_COLOURS))
    return np.stack([np.interp(part, at, DISTANCE_COLOURS[:, k] / 255.0) for k in range(3)], axis=-1)


def profiles(comparison: Comparison) -> list[tuple[bytes, str]]:
    """SVG and name of two perpendicular cuts through the middle of the print, each in its own plane."""
    out = []
    for name, way in profile_directions(comparison).items():
        exact, preview = _in_plane(*profile_cut(comparison, way))
        both = np.concatenate([exact, preview])
        low, high = both.min(axis=0), both.max(axis=0)
        # also a flat cut has a picture of some height
        margin = 0.03 * (high - low).max()
        chart = Chart(low - margin, high + margin, 560.0, 420.0)
        chart.line(exact, BLUE)
        chart.line(preview, "#ed7829")
        out.append((chart.svg(), f"{name}; exact blue, preview orange"))
    return out


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
