"""Meshes that are finer where the fabric creases: across the arms, and about their tips.

A line that does not stretch, in a sheet under tension: the sheet creases along it within sqrt(D/N), about a third of a
millimetre, and its stress is singular at the line's end. Away from both the shape is smooth.

The vertices of an even mesh move. Those of an arm crowd at its tip; those of the outline and of holes stay. The others
rest between springs along the edges, stiffer where edges are to be short (Winslow's variable diffusion). The springs
have the weights of linear finite elements on the even mesh, so that equal stiffnesses leave it as it is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array
from scipy.sparse.linalg import SuperLU, splu
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.planar import STRAIGHT_TURN_RAD, cross_2d, triangle_angles, triangle_areas
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh

GRADED_EDGE_FACTOR = 0.3  # edge at an arm or a tip over the edge far from both
REACH_SPACINGS = 0.25  # distance from the arms, in spacings, at which edges have their full length
# least weight of a spring: diagonals of squares have none of their own
MIN_SPRING_WEIGHT = 0.05
MAX_ROUNDS = 30
STEP_EDGES = 0.01  # points that move by less have reached their places
PLACES = np.linspace(0.0, 1.0, 1001)  # at which the sizes of edges along a line are known
# smallest angle that a move leaves, unless the even mesh has flat triangles: these lose at most a quarter of theirs
MIN_GRADED_ANGLE_DEG = 12.0
MIN_KEPT_ANGLE = 0.75


@dataclass(frozen=True)
class Grading:
    """Relative lengths of edges: `GRADED_EDGE_FACTOR` at arms, growing with the distance up to 1 at `reach` (mm)."""

    arms: cKDTree
    reach: float

    @classmethod
    def of(cls, layout: Layout) -> Grading:
        """For all rods of a layout."""
        samples = [rod.at(rod.points, _even_parts(rod.length, layout.spacing_mm)) for rod in layout.graph.rods]
        return cls(cKDTree(np.concatenate([np.empty((0, 2)), *samples])), REACH_SPACINGS * layout.spacing_mm)

    @classmethod
    def of_arms(cls, centre: Floats, tip: Floats, spacing: float) -> Grading:
        """For arms from their stars' centres (A, 2) to their tips (A, 2); all lengths in mm."""
        step = tip - centre
        along = _even_parts(float(np.linalg.norm(step, axis=1).max(initial=0.0)), spacing)
        return cls(cKDTree((centre[:, None] + along[:, None] * step[:, None]).reshape(-1, 2)), REACH_SPACINGS * spacing)

    def distance(self, points: Floats) -> Floats:
        """(n,) mm, of points (n, 2) from the nearest arm."""
        return np.asarray(self.arms.query(points)[0])

    def between(self, one: Floats, other: Floats) -> Floats:
        """(n,) of edges between points at these distances (n,) from the arms: the harmonic mean along the edge."""
        passed = [self._passed(distance) for distance in (one, other)]
        step = other - one
        even = np.abs(step) < 1e-6 * self.reach
        mean = np.where(even, 1.0, step) / np.where(even, 1.0, passed[1] - passed[0])
        return np.where(even, self.ramp(0.5 * (one + other)), mean)

    def _passed(self, distance: Floats) -> Floats:
        """(n,) mm, the integral of 1/size over the distance from an arm."""
        slope = (1.0 - GRADED_EDGE_FACTOR) / self.reach
        within = np.log1p(slope * np.minimum(distance, self.reach) / GRADED_EDGE_FACTOR) / slope
        return within + np.maximum(distance - self.reach, 0.0)

    def along(self, length: float, count: int) -> Floats:
        """(count + 1,) parts of an arm of this length (mm) at which its vertices are; they crowd at the tip, 1."""
        return graded_parts(np.linspace(0.0, 1.0, count + 1), self.ramp((1.0 - PLACES) * length))

    def ramp(self, distance: Floats) -> Floats:
        """(n,) of edges at distances (n,) in mm from the arms."""
        return GRADED_EDGE_FACTOR + (1.0 - GRADED_EDGE_FACTOR) * np.minimum(distance / self.reach, 1.0)

    def settled(
        self,
        points: Floats,
        ends: Callable[[Floats], tuple[Floats, Floats]],
        means: Callable[[Floats], Floats],
        edge_mm: float,
    ) -> Floats:
        """Points (n, 2) mm at rest between springs that are stiffer where edges are short.

        Parameters
        ----------
        points : (n, 2) mm, where they start.
        ends : both ends (E, 2) of all edges, from the points.
        means : the points, each the mean of its neighbours, from the weights (E,) of the edges.
        edge_mm : of the grid.
        """
        for round_ in range(MAX_ROUNDS):
            one, other = (self.distance(end) for end in ends(points))
            target = means(1.0 / self.between(one, other))
            step = target - points
            # sizes follow the points: half steps avoid oscillation
            points = target if round_ == 0 else points + 0.5 * step
            if np.abs(step).max(initial=0.0) < STEP_EDGES * edge_mm:
                break
        return points


def half_cotangents(one: Floats, other: Floats) -> Floats:
    """(n,) of the angles between vectors (n, 2): the sum over both angles opposite to an edge is its weight."""
    return np.asarray(0.5 * (one * other).sum(axis=1) / np.abs(cross_2d(one, other)))


def graded_parts(parts: Floats, size: Floats) -> Floats:
    """Parts (n,) of a line, from 0 to 1, moved so that its edges follow the sizes (m,) at `PLACES`."""
    passed = np.concatenate([[0.0], np.cumsum(1.0 / size[1:] + 1.0 / size[:-1])])
    return np.interp(parts * passed[-1], passed, PLACES)


def _even_parts(length: float, spacing: float) -> Floats:
    """(n,) parts of a rod from 0 to 1, 200 a spacing: close enough for distances to it."""
    return np.linspace(0.0, 1.0, max(int(np.ceil(200 * length / spacing)), 1) + 1)


def graded_mesh(mesh: Mesh, layout: Layout, edge_mm: float) -> Mesh:
    """The even mesh of a layout with edges of about `edge_mm`, graded: the same triangles, none of them flat."""
    even = _EvenMesh.of(mesh, layout, edge_mm)
    angles = triangle_angles(mesh.points, mesh.triangles).min(axis=1)
    enough = np.minimum(MIN_GRADED_ANGLE_DEG, MIN_KEPT_ANGLE * angles)
    points, eased = mesh.points, np.zeros(len(mesh.points))
    # edges near triangles that would be flatter keep this part of their even length at the next try; at 1, vertices
    # stay
    for rings, ease in enumerate((0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0), start=1):
        points = even.graded(points, eased)
        angles = triangle_angles(points, mesh.triangles).min(axis=1)
        flat = (angles < enough) | (triangle_areas(points, mesh.triangles) <= 0.0)
        if not flat.any():
            return replace(mesh, points=points)
        near = np.zeros(len(eased), dtype=bool)
        near[mesh.triangles[flat]] = True
        for _ in range(rings):
            near[even.edges[near[even.edges].any(axis=1)]] = True
        eased[near] = np.maximum(eased[near], ease)
    return mesh


@dataclass(frozen=True)
class _Line:
    """Vertices (n,) along a straight piece of a rod, their places from 0 to 1, and whether they crowd at either end."""

    vertices: Ints
    parts: Floats
    tips: tuple[bool, bool]


@dataclass(frozen=True)
class _EvenMesh:
    """An even mesh, and what is needed to move its vertices."""

    grading: Grading
    points: Floats  # (n, 2) mm
    # edges, weight: (E, 2) pairs of vertices, and (E,) of linear finite elements.
    edges: Ints
    weight: Floats
    held: NDArray[np.bool_]  # (n,) whether a vertex is on a rod, the outline, a hole, or a pin
    lines: tuple[_Line, ...]
    fineness: Floats  # (n,) length of the edges over the wished one, at most 1
    edge_mm: float

    @classmethod
    def of(cls, mesh: Mesh, layout: Layout, edge_mm: float) -> _EvenMesh:
        """`edge_mm`: the wished length of edges."""
        points, n = mesh.points, len(mesh.points)
        edges, weight = _weighted_edges(points, mesh.triangles)
        length = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
        mean = np.bincount(edges.ravel(), np.repeat(length, 2), n) / np.bincount(edges.ravel(), minlength=n)
        # where edges are shorter than the wished ones, the even mesh is already fine
        fineness = np.minimum(mean / (0.75 * edge_mm), 1.0)
        held = np.zeros(n, dtype=bool)
        pins = [at[: len(pin.points)] for pin, at in zip(layout.pins, mesh.pin_vertices, strict=True)]
        rims = (mesh.border_vertices, *mesh.hole_vertices)
        held[np.concatenate([mesh.star_vertices, *mesh.rods, *rims, *pins])] = True
        return cls(Grading.of(layout), points, edges, weight, held, _lines(mesh, layout), fineness, edge_mm)

    def graded(self, start: Floats, eased: Floats) -> Floats:
        """The points (n, 2) in mm."""
        points = start.copy()
        for line in self.lines:
            first, last = points[line.vertices[0]], points[line.vertices[-1]]
            ends = zip((PLACES, 1.0 - PLACES), line.tips, strict=True)
            to_tip = np.min([part for part, crowds in ends if crowds], axis=0)
            size = self.grading.ramp(to_tip * np.linalg.norm(last - first))
            fine, least = (np.interp(PLACES, line.parts, v[line.vertices]) for v in (self.fineness, eased))
            parts = graded_parts(line.parts, _relative(size, fine, least))
            points[line.vertices[1:-1]] = first + parts[1:-1, None] * (last - first)
        points[eased == 1.0] = self.points[eased == 1.0]
        return self._settled(points, eased)

    def _settled(self, points: Floats, eased: Floats) -> Floats:
        """The points at rest between springs, those that are held or keep their places in these."""
        held = self.held | (eased == 1.0)
        inner = ~held[self.edges].all(axis=1)
        (one, other), weight = self.edges[inner].T, self.weight[inner]
        fine = 0.5 * (self.fineness[one] + self.fineness[other])
        least = np.maximum(eased[one], eased[other])
        free, stiffness = np.flatnonzero(~held), weight
        if not len(free):
            return points
        number = np.full(len(points), -1)
        number[free] = np.arange(len(free))
        for round_ in range(MAX_ROUNDS):
            if round_:
                away = self.grading.distance(points)
                stiffness = weight / _relative(self.grading.between(away[one], away[other]), fine, least)
            # later, their stiffness changes little
            if round_ <= 2:
                factor = _factored(number[one], number[other], stiffness, len(free))
            pull = stiffness[:, None] * (points[other] - points[one])
            force = [np.bincount(one, p, len(points)) - np.bincount(other, p, len(points)) for p in pull.T]
            step = factor.solve(np.column_stack(force)[free])
            # stiffnesses follow the points: half steps avoid oscillation
            points[free] += step if round_ < 2 else 0.5 * step
            if round_ and np.abs(step).max() < STEP_EDGES * self.edge_mm:
                break
        return points


def _relative(size: Floats, fineness: Floats, least: Floats) -> Floats:
    """Wished lengths of edges over those of the even mesh."""
    return np.maximum(np.minimum(size / fineness, 1.0), least)


def _factored(one: Ints, other: Ints, stiffness: Floats, count: int) -> SuperLU:
    """The stiffness of springs between free vertices; -1 is a held one."""
    diagonal = np.zeros(count)
    for end in (one, other):
        diagonal += np.bincount(end[end >= 0], stiffness[end >= 0], count)
    inner, every = (one >= 0) & (other >= 0), np.arange(count)
    a, b, between = one[inner], other[inner], -stiffness[inner]
    entries = np.concatenate([between, between, diagonal])
    places = np.concatenate([a, b, every]), np.concatenate([b, a, every])
    matrix = csc_array((entries, places), shape=(count, count))
    return splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})


def _weighted_edges(points: Floats, triangles: Ints) -> tuple[Ints, Floats]:
    """Edges (E, 2) of triangles (T, 3), and half the cotangents (E,) of the angles opposite to each."""
    n, corner = len(points), points[triangles]
    codes, weights = [], []
    for k in range(3):
        a, b = np.sort(triangles[:, [k - 2, k - 1]], axis=1).T.astype(np.int64)
        codes.append(n * a + b)
        weights.append(half_cotangents(corner[:, k - 2] - corner[:, k], corner[:, k - 1] - corner[:, k]))
    code, edge = np.unique(np.concatenate(codes), return_inverse=True)
    weight = np.bincount(edge, np.concatenate(weights))
    return np.column_stack([code // n, code % n]), np.maximum(weight, MIN_SPRING_WEIGHT)


def _lines(mesh: Mesh, layout: Layout) -> tuple[_Line, ...]:
    """The pieces of straight rods that crowd: up to the tip of an arm, and to ends of drawn rods that meet no other."""
    n, arms = len(mesh.points), len(layout.arm_star)
    on_rods = np.bincount(np.concatenate([np.zeros(0, dtype=np.int64), *map(np.unique, mesh.rods)]), minlength=n)
    stop = on_rods != 1
    for pin, held in zip(layout.pins, mesh.pin_vertices, strict=True):
        stop[held[: len(pin.points)]] = True
    lines = []
    for number, (vertices, rod) in enumerate(zip(mesh.rods, layout.graph.rods, strict=True)):
        if rod.turn > STRAIGHT_TURN_RAD:
            continue
        start = number >= arms and on_rods[vertices[0]] == 1
        end = number < arms or on_rods[vertices[-1]] == 1
        stops = [0, *(np.flatnonzero(stop[vertices[1:-1]]) + 1).tolist(), len(vertices) - 1]
        for a, b in pairwise(stops):
            tips = bool(start and a == 0), bool(end and b == stops[-1])
            if any(tips) and b > a + 1:
                at = mesh.points[vertices[a : b + 1]]
                away = np.linalg.norm(at - at[0], axis=1)
                lines.append(_Line(vertices[a : b + 1], away / away[-1], tips))
    return tuple(lines)
