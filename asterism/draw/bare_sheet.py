"""Scene of a sheet without its arms and supports, in given colours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from asterism.draw.render import Scene, scene
from asterism.equilibrium.arrays import Floats
from asterism.shape.shape import Shape


def bare(shape: Shape, colour: Floats | Sequence[float]) -> Scene:
    """The sheet without arms and supports.

    Parameters
    ----------
    colour : (3,) one colour, or (V, 3) one for each vertex, 0 to 1.
    """
    thing = scene(replace(shape, rods=(), rod_fields={}, held=False))
    return replace(thing, colours=np.broadcast_to(np.asarray(colour, dtype=float), (len(shape.positions), 3)))
