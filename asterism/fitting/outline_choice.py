"""The outline of the print and its needles: corners along the border of a flattened target."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fitting.target_map import TargetMap

# of the spacing: largest distance of corners of the outline
OUTLINE_STEP = 0.45
# of the spacing: distance of needles along the outline
NEEDLE_STEP = 1.6
# the border has a corner where it turns by more than this angle within the window, a share of the spacing
MIN_CORNER_TURN_RAD = np.deg2rad(35.0)
CORNER_WINDOW = 0.3


@dataclass(frozen=True, eq=False)
class OutlineChoice:
    """The outline of a print.

    Attributes
    ----------
    corners : (n, 2) mm, counterclockwise.
    places : (n, 3) mm, where the target has the corners.
    needles : (m,) numbers of the corners that needles hold.
    """

    corners: Floats
    places: Floats
    needles: Ints


def choose_outline(target_map: TargetMap, needles: int | None) -> OutlineChoice:
    """The outline with its needles.

    Needles stand at the corners of the border, and between them at equal distances of about `NEEDLE_STEP` spacings.
    With a number of needles, they stand at equal distances from a corner on; 0 gives a free sheet.
    """
    disk = target_map.flat.disk
    ring, places = target_map.printed[disk.border], disk.vertices[disk.border]
    steps = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    total = along[-1]
    sharp = _corners(ring, along, CORNER_WINDOW * target_map.spacing_mm)
    starts = along[sharp] if len(sharp) else np.zeros(1)
    if needles:
        held = (starts[0] + np.arange(needles) * total / needles) % total
        starts = np.unique(np.concatenate([starts, held]).round(9))
    else:
        held = np.empty(0)
    gaps = np.diff(np.append(starts, starts[0] + total))
    if needles is None:
        counts = np.maximum(np.rint(gaps / (NEEDLE_STEP * target_map.spacing_mm)), 1).astype(int)
        if len(starts) == 1:
            counts = np.maximum(counts, 3)
        starts = np.concatenate([s + g * np.arange(n) / n for s, g, n in zip(starts, gaps, counts, strict=True)])
        held, gaps = starts, np.diff(np.append(starts, starts[0] + total))
    parts = np.maximum(np.ceil(gaps / (OUTLINE_STEP * target_map.spacing_mm)), 1).astype(int)
    stations = np.concatenate([s + g * np.arange(n) / n for s, g, n in zip(starts, gaps, parts, strict=True)])
    is_held = np.isin((stations % total).round(6), (held % total).round(6))

    def at(values: Floats) -> Floats:
        closed = np.concatenate([values, values[:1]])
        columns = [np.interp(stations % total, along, column) for column in closed.T]
        return np.column_stack(columns)

    return OutlineChoice(at(ring), at(places), np.flatnonzero(is_held))


def _corners(ring: Floats, along: Floats, window: float) -> Ints:
    """Vertices of a closed border (B, 2) where it turns sharply, in order.

    The turn at a vertex is the angle between the chords to the border half a window before and behind it.
    """
    total, closed = along[-1], np.concatenate([ring, ring[:1]])

    def at(stations: Floats) -> Floats:
        return np.column_stack([np.interp(stations % total, along, column) for column in closed.T])

    here = along[:-1]
    ahead, behind = at(here + 0.5 * window) - ring, ring - at(here - 0.5 * window)
    cross = behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0]
    turn = np.abs(np.arctan2(cross, np.einsum("nc,nc->n", behind, ahead)))
    corners: list[int] = []
    for vertex in np.argsort(-turn, kind="stable"):
        if turn[vertex] < MIN_CORNER_TURN_RAD:
            break
        distance = np.abs(here[vertex] - here[corners])
        if np.minimum(distance, total - distance).min(initial=np.inf) > 2.0 * window:
            corners.append(int(vertex))
    return np.asarray(sorted(corners), dtype=np.int64)
