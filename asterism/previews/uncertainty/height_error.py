"""Estimated error of the height of a preview, in % of it.

The height is from the lowest to the highest point, bumps included. The covariance of the shape
(`asterism.previews.uncertainty.distance_error`) gives its error, in mm:

- **Energy.** With the compliance c (mm/N) against a pair of unit forces at the two points, the standard deviation is
  `u/2 sqrt(2 E c)`.
- **Stiffnesses.** The linear response to each moves the two points apart; s times that.
- **Narrow sheets.** n (1 - q) of the diameter is a distance in space. A third of its variance is along the height.
- **The lowest point** is often the tip of an arm beside the border. Its error is the distance from there to the smooth
  surface. On nearly flat sheets that is much of the height.
- **The mesh.** `mesh_error_percent` of the diameter, as in the distance.

Other forms are left out: a warning names them, and most are as high.
"""

from __future__ import annotations

import math

from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.uncertainty.distance_error import COVERAGE
from asterism.previews.uncertainty.error_sources import ErrorSources


def height_error_percent(sources: ErrorSources, model: PreviewModel = PREVIEW_MODEL) -> float | None:
    """In % of the height; None for a sheet without a height that is certain. Nine of ten heights are within it.

    Examples
    --------
    >>> import numpy as np
    >>> from asterism.previews.uncertainty.height_doubts import HeightDoubts
    >>> doubts = HeightDoubts(height=20.0, lowest=0.0, softness=0.0, stiffness=0.0)
    >>> height_error_percent(ErrorSources(100.0, np.zeros(2), height=doubts)) == 5.0 * PREVIEW_MODEL.mesh_error_percent
    True
    """
    doubts = sources.height
    if doubts is None or doubts.height <= 0.0:
        return None
    deviations = (
        0.5 * model.energy_uncertainty * doubts.softness,
        model.stiffness_uncertainty * doubts.stiffness,
        model.buckling_share * sources.narrowing * sources.diameter_mm / math.sqrt(3.0),
    )
    mesh = 0.01 * model.mesh_error_percent * sources.diameter_mm
    return 100.0 * math.hypot(mesh, doubts.lowest, COVERAGE * math.hypot(*deviations)) / doubts.height
