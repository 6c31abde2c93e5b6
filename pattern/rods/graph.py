"""The printed pattern as a planar graph: nodes, and rods between them. Stars and drawings are its generators."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.planar import cross_2d

# a rod that turns by more at a node has a corner there; decided on the drawing, since a mesh turns curves in steps
CORNER_DEG = 10.0


@dataclass(frozen=True)
class Rod:
    """A rod from one node to another.

    >>> ends = np.array([[0.0, 0.0], [10.0, 0.0]])
    >>> rod = Rod(ends, 0, 1, np.array([[0.3, 1.2], [0.5, 1.2]]))
    >>> rod.length, rod.at(rod.thickness, np.array([0.5])).tolist()
    (10.0, [0.4])
    """

    # (n, 2) mm, polyline of its middle line; curves are flattened. The first and last points are its nodes.
    points: Floats
    # start, end: numbers of its nodes; equal for a closed rod.
    start: int
    end: int
    # (n, K) thickness, width and further `pattern.design.stars.ROD_SIZES` at the points, linear in arc length between.
    sections: Floats
    kappa_bar: float | None = None  # 1/mm, residual curvature of its plastic; None for that of the design's plastic
    name: str = ""  # the name in the drawing, for messages
    group: int = -1  # number of the star or of the copy of a motif that it belongs to; -1 for none
    side: int = 1  # face of the fabric that carries it: 1 above, -1 below

    @property
    def thickness(self) -> Floats:
        """(n,) mm, at the points."""
        return self.sections[:, 0]

    @property
    def width(self) -> Floats:
        """(n,) mm, at the points."""
        return self.sections[:, 1]

    @cached_property
    def arc_lengths(self) -> Floats:
        """(n,) mm from the start to each point."""
        steps = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def length(self) -> float:
        """mm."""
        return float(self.arc_lengths[-1])

    @property
    def volume_mm3(self) -> float:
        """mm^3, length times thickness times width, both of which change linearly between the points."""
        (a, b), (c, d) = ((each[:-1], each[1:]) for each in (self.thickness, self.width))
        return float(np.diff(self.arc_lengths) @ (2.0 * (a * c + b * d) + a * d + b * c) / 6.0)

    @property
    def turn(self) -> float:
        """rad, by which the rod turns along its length, to either side."""
        step = np.diff(self.points, axis=0)
        angles = np.arctan2(cross_2d(step[:-1], step[1:]), (step[:-1] * step[1:]).sum(axis=1))
        return float(np.abs(angles).sum())

    def at(self, values: Floats, part: Floats) -> Floats:
        """(k, ...) values, given at the points (n, ...), at parts (k,) of the length from 0 to 1."""
        known = self.arc_lengths / self.length
        piece = np.clip(np.searchsorted(known, part, side="right") - 1, 0, len(known) - 2)
        share = (part - known[piece]) / (known[piece + 1] - known[piece])
        share = share.reshape(-1, *[1] * (values.ndim - 1))
        return np.asarray(values[piece] + share * (values[piece + 1] - values[piece]))

    def direction_at(self, end: int) -> Floats:
        """(2,) unit vector along the rod away from its start (`end` = 0) or from its end (1)."""
        step = self.points[1] - self.points[0] if end == 0 else self.points[-2] - self.points[-1]
        return np.asarray(step / np.linalg.norm(step))


class RodEnd(NamedTuple):
    """An end of a rod: its number, and 0 for the start or 1 for the end."""

    rod: int
    end: int


@dataclass(frozen=True)
class RodGraph:
    """Nodes and rods.

    Two rods that meet at a right angle are bonded there, and end freely at their other nodes:

    >>> nodes, sizes = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 5.0]]), np.array([[0.3, 1.2], [0.3, 1.2]])
    >>> rods = (Rod(nodes[:2], 0, 1, sizes), Rod(nodes[1:], 1, 2, sizes))
    >>> RodGraph(nodes, rods).joints
    (1,)
    """

    nodes: Floats  # (N, 2) mm
    rods: tuple[Rod, ...]  # the rods. They meet at nodes only.
    # numbers of the nodes at which rods bend pair by pair, as in the paper: centres of stars that no rod of another
    # star touches. All rods start there.
    paired: Ints = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    # numbers of the nodes that are joints, however few rods end there. In a unit cell the other rods of such a node are
    # images.
    bonded: Ints = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    @cached_property
    def lines(self) -> NDArray[np.object_]:
        """(R,) the rods for shapely."""
        return np.array([shapely.LineString(rod.points) for rod in self.rods])

    @cached_property
    def ends_at(self) -> tuple[tuple[RodEnd, ...], ...]:
        """For each node the ends of rods there."""
        ends: list[list[RodEnd]] = [[] for _ in self.nodes]
        for number, rod in enumerate(self.rods):
            ends[rod.start].append(RodEnd(number, 0))
            ends[rod.end].append(RodEnd(number, 1))
        return tuple(tuple(at_node) for at_node in ends)

    @cached_property
    def links(self) -> tuple[tuple[RodEnd, RodEnd], ...]:
        """Pairs of ends at which one rod goes on as another, or a closed rod as itself, without a corner."""
        bonded = set(self.bonded.tolist())
        return tuple(
            (ends[0], ends[1])
            for node, ends in enumerate(self.ends_at)
            if node not in bonded and len(ends) == 2 and self._goes_on(*ends)
        )

    @cached_property
    def joints(self) -> tuple[int, ...]:
        """Nodes with a joint: `bonded` ones, corners, branches, crossings, and ends that meet; not `paired` nodes."""
        paired, bonded = set(self.paired.tolist()), set(self.bonded.tolist())
        return tuple(
            node
            for node, ends in enumerate(self.ends_at)
            if node in bonded
            or (node not in paired and len(ends) > 1 and not (len(ends) == 2 and self._goes_on(*ends)))
        )

    @property
    def total_length(self) -> float:
        """mm, of all rods."""
        return sum(rod.length for rod in self.rods)

    def _goes_on(self, first: RodEnd, second: RodEnd) -> bool:
        """Whether two ends at a node are one smooth line."""
        out = self.rods[first.rod].direction_at(first.end)
        back = -self.rods[second.rod].direction_at(second.end)
        turn = np.arctan2(cross_2d(back, out), back @ out)
        return bool(abs(turn) <= np.radians(CORNER_DEG))


def apart_by_face(graph: RodGraph) -> RodGraph:
    """The graph of the same rods in which those above and those below the fabric have nodes of their own.

    Plastic bonds to plastic of its own face. Across the fabric, which is far softer, rods share the place at which they
    meet, and turn freely against each other. So two nodes may be at one place. `paired` and `bonded` of the graph are
    empty.

    Two rods in one line and two across them. Those across are below, so nothing is bonded:

    >>> ends, sizes = np.array([[-9.0, 0.0], [9.0, 0.0], [0.0, -9.0], [0.0, 9.0]]), np.array([[0.3, 1.2], [0.3, 1.2]])
    >>> sides = [1, 1, -1, -1]
    >>> rods = [Rod(np.array([ends[k], [0, 0]]), k, 4, sizes, side=side) for k, side in enumerate(sides)]
    >>> cross = RodGraph(np.vstack([ends, [0, 0]]), tuple(rods))
    >>> len(cross.joints), len(apart_by_face(cross).joints), len(apart_by_face(cross).links)
    (1, 0, 2)
    """
    ends = np.array([[rod.start, rod.end] for rod in graph.rods], dtype=np.int64).reshape(-1, 2)
    is_below = np.array([[rod.side < 0] for rod in graph.rods], dtype=bool).reshape(-1, 1)
    if is_below.all() or not is_below.any():
        return graph
    own, number = np.unique(2 * ends + is_below, return_inverse=True)
    rods = zip(graph.rods, number.reshape(-1, 2).tolist(), strict=True)
    return RodGraph(graph.nodes[own // 2], tuple(replace(rod, start=start, end=end) for rod, (start, end) in rods))


def close_rods(first: RodGraph, second: RodGraph) -> Iterator[tuple[Rod, Rod, float]]:
    """Rods of two graphs nearer to each other than half the sum of their widths, and their gap, mm."""
    widths, others = (np.array([rod.width.max() for rod in graph.rods]) for graph in (first, second))
    widest = max(widths.max(), others.max())
    i, j = shapely.STRtree(second.lines).query(first.lines, predicate="dwithin", distance=widest)
    gaps = shapely.distance(first.lines[i], second.lines[j])
    for k in np.flatnonzero(gaps < 0.5 * (widths[i] + others[j])):
        yield first.rods[i[k]], second.rods[j[k]], float(gaps[k])


def place_between(one: Rod, other: Rod) -> Floats:
    """(2,) mm, the middle of the gap between two rods."""
    lines = (shapely.LineString(rod.points) for rod in (one, other))
    return np.asarray(shapely.get_coordinates(shapely.shortest_line(*lines)).mean(axis=0))
