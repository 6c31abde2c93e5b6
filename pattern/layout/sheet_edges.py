"""The edges of a sheet: those of its outline and of its holes, numbered one ring after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.planar import STRAIGHT_TURN_RAD, polygon_area, turning_angles


@dataclass(frozen=True, eq=False)
class SheetEdges:
    """All edges of a sheet, which lies to the left of each. A corner has the number of the edge that begins there.

    >>> square = np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]])
    >>> edges = SheetEdges.of(square, [square[:3] / 3.0 + 2.0])
    >>> edges.following.tolist(), edges.numbers(1).tolist(), edges.area_mm2
    ([1, 2, 3, 0, 5, 6, 4], [4, 5, 6], 76.5)
    """

    rings: tuple[Floats, ...]  # (n, 2) mm each, corners of the outline, counterclockwise, then of each hole, clockwise

    @classmethod
    def of(cls, outline: Floats, holes: Sequence[Floats] = ()) -> SheetEdges:
        """The edges of an outline (B, 2) mm, counterclockwise, and of holes (n, 2) mm each, in any direction."""
        clockwise = (hole if polygon_area(hole) < 0.0 else hole[::-1] for hole in holes)
        return cls((np.asarray(outline, dtype=float), *clockwise))

    @cached_property
    def start(self) -> Floats:
        """(N, 2) mm, first corner of each edge."""
        return np.concatenate(self.rings)

    @cached_property
    def end(self) -> Floats:
        """(N, 2) mm, second corner of each edge."""
        return np.concatenate([np.roll(ring, -1, axis=0) for ring in self.rings])

    @cached_property
    def turns(self) -> Floats:
        """(N,) rad, angle by which the ring turns left at each corner."""
        return np.concatenate([turning_angles(ring) for ring in self.rings])

    @cached_property
    def following(self) -> Ints:
        """(N,) number of the edge that follows each edge on its ring."""
        return np.concatenate([np.roll(self.numbers(k), -1) for k in range(len(self.rings))])

    @cached_property
    def preceding(self) -> Ints:
        """(N,) number of the edge before each edge on its ring."""
        return np.concatenate([np.roll(self.numbers(k), 1) for k in range(len(self.rings))])

    @cached_property
    def straight_sides(self) -> Ints:
        """(N,) equal numbers for edges that continue each other straight."""
        side: Ints = np.cumsum(np.abs(self.turns) > STRAIGHT_TURN_RAD)
        for k in range(len(self.rings)):
            its = self.numbers(k)
            before_first = side[its] == (0 if k == 0 else side[its[0] - 1])
            side[its[before_first]] = side[its[-1]]
        return side

    @cached_property
    def area_mm2(self) -> float:
        """Area of the sheet without its holes."""
        return float(sum(polygon_area(ring) for ring in self.rings))

    def equals(self, other: SheetEdges) -> bool:
        """Whether all rings are the same."""
        return len(self.rings) == len(other.rings) and all(map(np.array_equal, self.rings, other.rings))

    def numbers(self, ring: int) -> Ints:
        """(n,) numbers of the edges of a ring: 0 is the outline, and k + 1 is hole k."""
        first = sum(len(each) for each in self.rings[:ring])
        return np.arange(first, first + len(self.rings[ring]))
