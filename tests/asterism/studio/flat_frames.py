"""Flat shapes without arms and needles, for tests of everything but the computation; and what a binary frame holds."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Array
from asterism.studio.messages import Frame

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def flat_places(height: float = 0.0, printed: Array = SQUARE) -> Array:
    """(V, 3) places of the sheet at a height (mm)."""
    return np.pad(printed, ((0, 0), (0, 1)), constant_values=height)


def flat_frame(
    seq: int,
    stage: str = "equilibrium",
    height: float = 0.0,
    printed: Array = SQUARE,
    beside: dict[str, Array] | None = None,
    **rest: Any,
) -> Frame:
    """A frame of a square, or of a triangle of three points, with its mesh, and with other arrays beside its own."""
    triangles, none = np.array([[0, 1, 2], [0, 2, 3]])[: len(printed) - 2], np.zeros((0, 2, 3, 3))
    arrays = {"positions": flat_places(height, printed), "arms": none, "arm_normals": none[:, 0], "needles": none[:, 0]}
    arrays |= dict.fromkeys(("curvature", "strain"), np.zeros(len(printed))) | (beside or {})
    arm_site = np.zeros(0, dtype=np.int64)
    mesh_arrays = {"printed": printed, "triangles": triangles, "outline": np.arange(len(printed)), "arm_site": arm_site}
    return Frame(seq, stage, arrays, mesh_arrays, **rest)


def unpack(frame: bytes) -> tuple[int, dict[str, Any], dict[str, Any]]:
    """Kind, header and arrays of a binary frame."""
    kind, length = struct.unpack_from("<II", frame)
    header = json.loads(frame[8 : 8 + length])
    arrays = {}
    for entry in header.pop("arrays"):
        count = int(np.prod(entry["shape"], dtype=np.int64))
        flat = np.frombuffer(frame, np.dtype("<" + entry["dtype"]), count, entry["offset"])
        arrays[entry["name"]] = flat.reshape(entry["shape"])
    return kind, header, arrays
