"""Flat shapes without arms and needles, for tests of everything but the computation."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Array
from asterism.studio.messages import Frame, SheetPart, ShownMesh

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
_NONE = np.zeros((0, 2, 3, 3))


def flat_mesh(number: int = 1, printed: Array = SQUARE) -> ShownMesh:
    """The mesh of a square, or of a triangle of three points."""
    triangles = np.array([[0, 1, 2], [0, 2, 3]])[: len(printed) - 2]
    return ShownMesh(number, printed, triangles, np.arange(len(printed)), np.zeros(0, dtype=np.int64))


def flat_part(height: float = 0.0, printed: Array = SQUARE) -> SheetPart:
    """The sheet at a height (mm)."""
    places = np.pad(printed, ((0, 0), (0, 1)), constant_values=height)
    return SheetPart(places, _NONE, _NONE[:, 0], _NONE[:, 0])


def flat_frame(seq: int, mesh: int = 1, stage: str = "equilibrium", height: float = 0.0, **rest: Any) -> Frame:
    """A frame of it."""
    return Frame.of(flat_part(height), seq, mesh, stage, **rest)
