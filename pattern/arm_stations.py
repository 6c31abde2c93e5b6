"""Where arms, and the gaps behind their tips, take their vertices on the lines of the lattice grid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pattern.errors import MeshError
from pattern.grading import Grading
from pattern.lattice_grid import ON_LINE, LatticeGrid
from pattern.layout import Floats, Ints, Layout

# the grid's edges along arms and gaps may not be squeezed below this part of their length
SMALLEST_EDGE = 0.25


@dataclass(frozen=True)
class Stations:
    """Grid points of the arms, and all grid points that are moved to a place.

    Attributes
    ----------
    centres : (S, 2) grid points of the stars.
    arms : one (n + 1, 2) array of grid points an arm, from the star's centre to the tip.
    ij, places : (P, 2) grid points, and their places in mm; a point may occur more than once.
    """

    centres: Ints
    arms: tuple[Ints, ...]
    ij: Ints
    places: Floats


@dataclass
class _Link:
    """The grid points ahead of a star: `count` edges to the place `end` (mm), `taken` of them under the arm."""

    start: Ints
    step: Ints
    count: int
    end: Floats
    taken: int
    length: float

    def points(self, first: int, last: int) -> Ints:
        return self.start + np.arange(first, last + 1)[:, None] * self.step


Border = Callable[[Ints, Ints], tuple[int, Floats] | None]


def arm_stations(layout: Layout, grid: LatticeGrid, border: Border, grading: Grading | None = None) -> Stations:
    """Spread every arm evenly over grid edges, and the gap behind its tip over those left on its link.

    With a grading arms have their vertices where it wants them, and the gaps are left free.

    Parameters
    ----------
    border : for a grid point and a direction, the number of grid edges to the border and the place (mm) of the
        grid point there; None where the border takes no grid points.
    """
    links = _links(layout, grid, border)
    ends = {(*link.start, *link.step): arm for arm, link in enumerate(links)}
    tolerance = ON_LINE * grid.edge_mm * grid.k
    centres = grid.centres(layout)
    ij, places = [centres], [layout.centres]
    for arm, link in enumerate(links):
        centre, tip = layout.centres[layout.arm_star[arm]], layout.arm_tip[arm]
        last, end = link.count, link.end
        other = ends.get((*(link.start + link.count * link.step), *-link.step))
        if other is not None:
            end = layout.arm_tip[other]
            if link.length + links[other].length > np.linalg.norm(link.end - centre) + tolerance:
                raise MeshError(f"arms {arm} and {other} overlap")
            if arm < other:
                _share(link, links[other], float(np.linalg.norm(end - tip)) <= tolerance)
            last -= links[other].taken
        ij.append(link.points(0, link.taken))
        if grading is None:
            places.append(np.linspace(centre, tip, link.taken + 1))
        else:
            places.append(centre + grading.along(link.length, link.taken)[:, None] * (tip - centre))
        squeezed = link.length / link.taken
        if last > link.taken:
            if grading is None:
                ij.append(link.points(link.taken, last))
                places.append(np.linspace(tip, end, last - link.taken + 1))
            squeezed = min(squeezed, float(np.linalg.norm(end - tip)) / (last - link.taken))
        if squeezed < SMALLEST_EDGE * grid.edge_mm:
            raise MeshError(f"arm {arm} leaves too little room for a mesh edge at its tip")
    arms = tuple(link.points(0, link.taken) for link in links)
    return Stations(centres, arms, np.concatenate(ij), np.concatenate(places))


def _links(layout: Layout, grid: LatticeGrid, border: Border) -> list[_Link]:
    """The link of every arm: up to the lattice point at or behind its tip, or to the border."""
    centres, directions = grid.centres(layout), grid.directions(layout)
    star_at = {(*ij,): star for star, ij in enumerate(centres.tolist())}
    links = []
    for arm, (star, step, length) in enumerate(zip(layout.arm_star, directions, layout.arm_length, strict=True)):
        start, spacing = centres[star], float(np.linalg.norm(step @ grid.basis))
        steps = max(int(np.ceil(length / spacing - ON_LINE)), 1)
        passed = [star_at.get((*(start + n * grid.k * step).tolist(),)) for n in range(1, steps)]
        if any(p is not None for p in passed):
            raise MeshError(f"arm {arm} runs through another star")
        count, end = steps * grid.k, grid.place(start + steps * grid.k * step)
        edge = border(start, step)
        if edge is not None and edge[0] < count:
            count, end = edge
        reach = float(np.linalg.norm(end - layout.centres[star]))
        if length <= 0 or count < 1 or length > reach + ON_LINE * spacing:
            raise MeshError(f"arm {arm} has no length, or leaves the sheet")
        taken = count
        if np.linalg.norm(end - layout.arm_tip[arm]) > ON_LINE * spacing:
            taken = int(np.clip(round(length / reach * count), 1, count - 1))
            if not taken:
                raise MeshError(f"arm {arm} needs a shorter mesh edge")
        links.append(_Link(start, step, count, end, taken, length))
    return links


def _share(one: _Link, other: _Link, meeting: bool) -> None:
    """Divide the grid edges of a link between the arms from both its ends: all if they meet, else leave one."""
    room = one.count if meeting else one.count - 1
    if room < 2:
        raise MeshError("arms from both ends of a link need a shorter mesh edge")
    if meeting:
        one.taken = int(np.clip(round(one.length / (one.length + other.length) * room), 1, room - 1))
        other.taken = room - one.taken
    while one.taken + other.taken > room:
        # the arm whose edges are the shorter ones gives one up
        shorter = min((one, other), key=lambda link: link.length / link.taken if link.taken > 1 else np.inf)
        shorter.taken -= 1
