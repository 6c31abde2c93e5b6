"""Views of both shapes of a verification, with the same cameras and scale: alone, together, and with their distance."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib import colormaps

from asterism.draw.render import OBLIQUE, VIEWS, Camera, Scene, bare, camera, render, scene
from asterism.draw.shading import FABRIC_SIDE
from asterism.equilibrium.arrays import Floats
from asterism.shape.comparison import Comparison

ORANGE = (0.93, 0.47, 0.16)
# largest size of a view
MAX_VIEW_HEIGHT_PX = 440
MAX_VIEW_WIDTH_PX = 640
DISTANCE_COLOURS = colormaps["magma_r"]


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
    low, high = frame.min(axis=0), frame.max(axis=0)
    middle, size = (low + high) / 2, float(np.linalg.norm(high - low))
    cameras = [camera(*OBLIQUE, middle, 2.6 * size), *(camera(*VIEWS[name], middle) for name in ("front", "side"))]
    return {
        name: [_framed(thing, view, frame) for view in (cameras if name == "overlaid" else cameras[:1])]
        for name, thing in things.items()
    }


def colours_of(comparison: Comparison) -> Floats:
    """(V, 3) colours of the distance at the vertices of the exact sheet, from zero to its maximum."""
    far = max(float(comparison.distance_mm.max()), 1e-12)
    return np.asarray(DISTANCE_COLOURS(comparison.distance_mm / far))[:, :3]


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
