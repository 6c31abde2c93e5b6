"""A sheet without its arms and pins, in colours of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from asterism.draw.render import Scene, scene
from asterism.shape.shape import Shape
from pattern.geometry.arrays import Floats


def bare(shape: Shape, colour: Floats | Sequence[float]) -> Scene:
    """The sheet without its arms and pins, in one colour or in one at each vertex."""
    thing = scene(replace(shape, rods=(), rod_fields={}, held=False))
    return replace(thing, colours=np.broadcast_to(np.asarray(colour, dtype=float), (len(shape.positions), 3)))
