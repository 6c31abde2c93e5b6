"""Sources of the error of a height; `asterism.previews.uncertainty.height_error` estimates the error from them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.search.linear_response import compliance
from asterism.fem.supports.loads import point_load
from asterism.previews.state import AnyPreviewState
from asterism.shape.shape import Shape


@dataclass(frozen=True)
class HeightDoubts:
    """Sources of the error of a height, mm.

    Attributes
    ----------
    height : of the preview.
    lowest : distance of the lowest point from the smooth surface.
    softness : by which the energy at stake would part the lowest and the highest point.
    stiffness : by which they part per relative error of the stiffnesses; root of the sum of squares.
    """

    height: float
    lowest: float
    softness: float
    stiffness: float


def height_doubts(state: AnyPreviewState, shape: Shape, up: Floats, moves: Floats) -> HeightDoubts:
    """Of a state at its equilibrium; the factor holds the exact Hessian there.

    Parameters
    ----------
    shape : the sheet with its bumps, its height along z.
    up : (3,) unit vector, that direction in the pose of the shell.
    moves : (n, 4) mm, linear responses to the stiffnesses, over the free unknowns.
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
        stiffness=float(np.linalg.norm(state.shell.restrict(forces) @ moves)),
    )
