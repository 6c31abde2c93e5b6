"""Views of a fit: shape beside target, both in one another, and the signed distance on the shape."""

from __future__ import annotations

import numpy as np

from asterism.draw.render import Scene, bare, scene
from asterism.draw.shading import FABRIC_SIDE
from asterism.equilibrium.arrays import Floats
from asterism.fitting.result import Fit
from asterism.measure.compare.comparison_picture import SIGNED_DISTANCE_COLOURS
from asterism.pattern.geometry.normals import vertex_normals
from asterism.reports.views import ORANGE, aligned_views, together

# colours end at this quantile of the distance, so that a few places at the rim do not make the rest pale
COLOUR_QUANTILE = 0.98
# mm, smallest distance at which colours end
MIN_COLOUR_MM = 0.05


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
    return max(float(np.quantile(np.abs(fitted.distance.mean_mm), COLOUR_QUANTILE)), MIN_COLOUR_MM)


def _distance_colours(fitted: Fit) -> Floats:
    share = 0.5 + 0.5 * np.clip(fitted.distance.mean_mm / colour_limit(fitted), -1.0, 1.0)
    return np.asarray(SIGNED_DISTANCE_COLOURS(share))[:, :3]


def _target_scene(fitted: Fit) -> Scene:
    disk = fitted.target.disk
    normals = vertex_normals(disk.vertices, disk.triangles)
    colours = np.broadcast_to(ORANGE, disk.vertices.shape)
    return Scene(disk.vertices, normals, disk.triangles, len(disk.triangles), colours=colours)
