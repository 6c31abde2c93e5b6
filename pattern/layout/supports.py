"""Supports of the sheet: which printed places are supported, in which directions, and where they stand in space.

A `PinSet` answers the questions that meshes, models, drawings and needles ask. So a new kind of pin is defined here and
in `pattern.layout.pin_placement`, and its users stay as they are.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.planar import STRAIGHT_TURN_RAD
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.layout.support_curve import SupportCurve

# Which of x, y, z are supported, by the value of `slide` in the design file.
FIXED_BY_SLIDE = {None: (True, True, True), "z": (True, True, False), "plane": (False, False, True)}


@dataclass(frozen=True)
class PinSet:
    """Places of the sheet that are all supported in the same way.

    Attributes
    ----------
    points : (P, 2) mm, single printed points (corners of the outline included).
    edges : edges of the outline and of holes that are supported along their whole length, numbered as in `SheetEdges`.
    fixed : which of x, y, z are supported. The sheet slides freely along the others.
    scale : x and y are held at `scale` times the printed place (about the origin of the print), z at 0.
    offset_mm : added to the place given by `scale`.
    target_mm : places in space, (P, 3), one a point, or one for each corner along the edges; in place of `scale` and
        `offset_mm`.
    curve : through the targets of edges; None for points, and for edges with `scale` and `offset_mm`.
    step : 0 supports the sheet during its release; 1, 2, ... move the released sheet, in this order.

    Examples
    --------
    >>> pins = PinSet(np.array([[10.0, -20.0]]), (), FIXED_BY_SLIDE["z"], scale=0.5)
    >>> pins.places(pins.points).tolist()
    [[5.0, -10.0, 0.0]]
    >>> pins.holds_in_plane, pins.slide
    (True, 'z')
    """

    points: Floats
    edges: tuple[int, ...]
    fixed: tuple[bool, bool, bool]
    scale: float = 1.0
    offset_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    target_mm: Floats | None = None
    step: int = 0
    curve: SupportCurve | None = None

    @property
    def holds_in_plane(self) -> bool:
        """Whether x or y is supported."""
        return self.fixed[0] or self.fixed[1]

    @property
    def holds_height(self) -> bool:
        """Whether z is supported."""
        return self.fixed[2]

    @property
    def slide(self) -> str | None:
        """`z` or `plane` where the sheet is free to slide, None if it is not."""
        return next(slide for slide, fixed in FIXED_BY_SLIDE.items() if fixed == self.fixed)

    @property
    def directions(self) -> Floats:
        """(k, 3) unit vectors of the supported directions."""
        return np.eye(3)[list(self.fixed)]

    @property
    def affine_motion(self) -> tuple[Floats, Floats]:
        """Matrix (3, 2) and shift (3,) mm from printed points to their places, or to the affine image of a curve."""
        if self.curve is not None:
            return self.curve.matrix, self.curve.offset
        return self.scale * np.eye(3)[:, :2], np.asarray(self.offset_mm, dtype=float)

    def places(self, printed: Floats) -> Floats:
        """(n, 3) mm, places in space of the printed points (n, 2); only the components in `fixed` count.

        With `target_mm` for points, `printed` must be `points`; for edges, it must be on them.
        """
        if self.curve is not None:
            return self.curve.places(printed)
        if self.target_mm is not None:
            return np.asarray(self.target_mm, dtype=float)
        flat = np.column_stack([self.scale * printed, np.zeros(len(printed))])
        return np.asarray(flat + np.asarray(self.offset_mm))

    def holds_as(self, other: PinSet) -> bool:
        """Whether another set holds the same points and edges in the same directions, from the same step on."""
        same = (self.edges, self.fixed, self.step) == (other.edges, other.fixed, other.step)
        return same and np.array_equal(self.points, other.points)

    def stands_as(self, other: PinSet) -> bool:
        """Whether another set that holds the same points holds them at the same places in space."""
        if (self.target_mm is None) != (other.target_mm is None):
            return False
        if self.target_mm is not None and other.target_mm is not None:
            return np.array_equal(self.target_mm, other.target_mm)
        return self.scale == other.scale and self.offset_mm == other.offset_mm

    def is_active(self, step: int) -> bool:
        """Whether these pins support the sheet in a step."""
        return self.step <= step

    def chains(self, sheet: SheetEdges) -> list[list[int]]:
        """Corners along edges that follow each other, chain by chain.

        A chain all around the outline or a hole ends with its first corner.

        Examples
        --------
        >>> hexagon = SheetEdges.of(np.array([[2, 0], [1, 2], [-1, 2], [-2, 0], [-1, -2], [1, -2]]))
        >>> PinSet(np.empty((0, 2)), (5, 0, 2), FIXED_BY_SLIDE[None]).chains(hexagon)
        [[5, 0, 1], [2, 3]]
        """
        left = set(self.edges)
        chains = []
        for first in [*(edge for edge in self.edges if int(sheet.preceding[edge]) not in left), *self.edges]:
            chain = [first]
            while chain[-1] in left:
                left.remove(chain[-1])
                chain.append(int(sheet.following[chain[-1]]))
            if len(chain) > 1:
                chains.append(chain)
        return chains

    def segments(self, sheet: SheetEdges) -> Iterator[tuple[Floats, Floats]]:
        """Both ends (2,) mm of every edge."""
        for edge in self.edges:
            yield sheet.start[edge], sheet.end[edge]

    def straight_stretches(self, sheet: SheetEdges) -> list[Floats]:
        """(2, 2) mm, both ends of every straight stretch of edges; there may be corners on a stretch."""
        held = set(self.edges)
        continues = np.abs(sheet.turns) <= STRAIGHT_TURN_RAD  # at corner i, from the edge before to edge i
        stretches = []
        for edge in self.edges:
            if continues[edge] and int(sheet.preceding[edge]) in held:
                continue
            last = edge
            while continues[following := int(sheet.following[last])] and following in held:
                last = following
            stretches.append(np.array([sheet.start[edge], sheet.end[last]]))
        return stretches


def all_points(pins: tuple[PinSet, ...]) -> Floats:
    """(P, 2) mm, the single points of several pin sets, one set after the other."""
    return np.concatenate([np.empty((0, 2)), *(pin.points for pin in pins)])


def set_of_point(pins: tuple[PinSet, ...]) -> Ints:
    """(P,) number of the pin set of each of `all_points`."""
    return np.repeat(np.arange(len(pins)), [len(pin.points) for pin in pins])


class SupportSamples(NamedTuple):
    """Places at which supports act.

    Attributes
    ----------
    printed : (P, 2) mm.
    places : (P, 3) mm in space, not a number along directions in which the sheet slides.
    kind : (P,) equal for points of equal directions, step and shape (point or edge).
    """

    printed: Floats
    places: Floats
    kind: Ints


def sample_supports(pins: Sequence[PinSet], edges: SheetEdges) -> SupportSamples:
    """Of pins all single points, and both ends and the middle of every straight stretch of supported edges.

    Places are affine along an edge. So the samples of a stretch determine all of its places. Edges on a curve are
    sampled one by one.
    """
    printed, places, kinds = [np.empty((0, 2))], [np.empty((0, 3))], [np.empty(0, dtype=np.int64)]
    for pin in pins:
        fixed = np.asarray(pin.fixed)
        kind = 2 * int(fixed @ [1, 2, 4]) + 20 * pin.step
        stretches = pin.straight_stretches(edges) if pin.curve is None else pin.segments(edges)
        along = [np.vstack([*ends, np.mean(ends, axis=0)]) for ends in stretches]
        for points, kind_of_points in [(pin.points, kind), *((edge, kind + 1) for edge in along)]:
            if len(points):
                printed.append(points)
                places.append(np.where(fixed, pin.places(points), np.nan))
                kinds.append(np.full(len(points), kind_of_points))
    all_printed, all_kinds = np.concatenate(printed), np.concatenate(kinds)
    if len(all_printed) == 0:
        return SupportSamples(all_printed, places[0], all_kinds)
    # neighbouring edges share a corner
    _, first = np.unique(np.round(np.column_stack([all_printed, all_kinds]), 6), axis=0, return_index=True)
    return SupportSamples(all_printed[first], np.concatenate(places)[first], all_kinds[first])
