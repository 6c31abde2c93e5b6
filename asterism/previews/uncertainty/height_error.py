"""Estimated error of the height of a preview, in % of it.

The height is from the lowest to the highest point, bumps included. Its error is the root of the sum of squares of three
contributions in mm:

- **The lowest point** is often the tip of an arm beside the border. Its error is the distance from there to the smooth
  surface. On nearly flat sheets that is much of the height.
- **Softness.** The energy E at stake would part the highest from the lowest point by `sqrt(2 E c)`, c (mm/N) being the
  compliance against a pair of unit forces there. `height_softness_share` times the share of the amplitudes
  (`asterism.previews.uncertainty.distance_error`) of that counts.
- **The floor.** `floor_percent` of the diameter, as in the distance.

`python -m benchmarks.accuracy.expectation` fits that share, `python -m benchmarks.accuracy.amplitude_share` states
how many heights the estimate covers. Other forms are left out: a warning names them, and
most are as high.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.state import AnyPreviewState
from asterism.shape.shape import Shape
from equilibrium.arrays import Floats
from fem.search.compliance import compliance
from fem.supports.loads import point_load


@dataclass(frozen=True)
class HeightDoubts:
    """What the estimated error of a height is computed from, mm.

    Attributes
    ----------
    height : of the preview.
    lowest : distance of the lowest point from the smooth surface.
    softness : by which the energy at stake would part the lowest and the highest point.
    """

    height: float
    lowest: float
    softness: float


def height_error_percent(doubts: HeightDoubts, diameter_mm: float, model: PreviewModel = PREVIEW_MODEL) -> float | None:
    """The estimated error in % of the height; None for a sheet without height.

    Over many designs the estimate is a root mean square: most previews are closer.

    Examples
    --------
    >>> height_error_percent(HeightDoubts(height=20.0, lowest=0.0, softness=0.0), diameter_mm=100.0).__round__(2)
    1.5
    """
    if doubts.height <= 0.0:
        return None
    contributions = (
        doubts.lowest,
        model.height_softness_share * model.amplitude_share * doubts.softness,
        0.01 * model.floor_percent * diameter_mm,
    )
    return 100.0 * math.hypot(*contributions) / doubts.height


def height_doubts(state: AnyPreviewState, shape: Shape, up: Floats) -> HeightDoubts:
    """Of a state at its equilibrium; the factor holds the exact Hessian there.

    Parameters
    ----------
    shape : the sheet with its bumps, its height along z.
    up : (3,) unit vector, that direction in the pose of the shell.
    """
    equilibrium, sheet = state.equilibrium, state.sheet
    height = shape.positions[:, 2]
    ends = [int(height.argmax()), int(height.argmin())]
    forces = point_load(sheet.space, shape.printed[ends], np.array([up, -up]))
    apart = compliance(state.shell, equilibrium.x, state.factor, forces)
    return HeightDoubts(
        height=shape.height_mm,
        lowest=abs(float(shape.point_fields["bump_mm"][ends[1], 2])),
        softness=math.sqrt(2.0 * max(equilibrium.absolute_energy, 0.0) * max(apart, 0.0)),
    )
