"""Rods that a printer can lay side by side: clear of each other, not too short, and not at narrow angles."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.stars import MIN_ARM_MM
from asterism.pattern.rods.graph import Rod, RodGraph

MAX_RODS = 20_000
# rods that meet at a smaller angle print as one, and the mesh has no good triangles between them
MIN_ROD_ANGLE_DEG = 20.0


def check_rods(graph: RodGraph) -> None:
    """Refuse a graph that prints as another one.

    Raises
    ------
    DesignError
        The message names the rods and the place.
    """
    if len(graph.rods) > MAX_RODS:
        raise DesignError("rods", f"must have at most {MAX_RODS} rods between nodes, has {len(graph.rods)}")
    degree = [len(ends) for ends in graph.ends_at]
    for rod in graph.rods:
        if rod.length < MIN_ARM_MM and min(degree[rod.start], degree[rod.end]) < 2:
            place = rod.at(rod.points, np.array([0.5]))[0]
            raise _error(
                f"{rod.name} has a piece of {rod.length:.2f} mm at {_at(place)}: {MIN_ARM_MM:g} or more", place
            )
    _check_angles(graph)
    _check_clearance(graph)


def _check_angles(graph: RodGraph) -> None:
    for node, ends in enumerate(graph.ends_at):
        for end_1, end_2 in combinations(ends, 2):
            first, second = graph.rods[end_1.rod], graph.rods[end_2.rod]
            cosine = first.direction_at(end_1.end) @ second.direction_at(end_2.end)
            angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
            if angle < MIN_ROD_ANGLE_DEG:
                place = graph.nodes[node]
                meet = f"{first.name} and {second.name} meet at {angle:.0f} deg at {_at(place)}"
                raise _error(f"{meet}: {MIN_ROD_ANGLE_DEG:g} or more, or draw them as one", place)


def _check_clearance(graph: RodGraph) -> None:
    """Refuse rods without a common node that are nearer than half the sum of their widths."""
    lines = np.array([shapely.LineString(rod.points) for rod in graph.rods])
    widest = max(float(rod.width.max()) for rod in graph.rods)
    first, second = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=widest)
    keep = first < second
    for i, j in zip(first[keep], second[keep], strict=True):
        first_rod, second_rod = graph.rods[i], graph.rods[j]
        if {first_rod.start, first_rod.end} & {second_rod.start, second_rod.end}:
            continue
        distance = float(shapely.distance(lines[i], lines[j]))
        widths = _width(first_rod), _width(second_rod)
        if distance < 0.5 * sum(widths):
            place = shapely.get_coordinates(shapely.shortest_line(lines[i], lines[j])).mean(axis=0)
            raise _error(
                f"{first_rod.name} and {second_rod.name} are {distance:.2f} mm apart at {_at(place)} and would print "
                f"as one (widths {widths[0]:g}, {widths[1]:g}): move them apart, or let them meet",
                place,
            )


def _width(rod: Rod) -> float:
    return float(rod.width.max())


def _at(place: Floats) -> str:
    return f"[{place[0]:.2f}, {place[1]:.2f}]"


def _error(problem: str, place: Floats) -> DesignError:
    return DesignError("rods", problem, place_mm=place)
