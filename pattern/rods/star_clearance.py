"""Stars and drawn rods beside each other: they print as two, and do not touch."""

from __future__ import annotations

import numpy as np
import shapely

from asterism.pattern.design.errors import DesignError
from asterism.pattern.rods.graph import RodGraph


def check_beside(stars: RodGraph, drawn: RodGraph) -> None:
    """Refuse arms of stars nearer to drawn rods than half the sum of their widths.

    Raises
    ------
    DesignError
        The message names the star, the rod and the place.
    """
    arms = np.array([shapely.LineString(rod.points) for rod in stars.rods])
    lines = np.array([shapely.LineString(rod.points) for rod in drawn.rods])
    widest = max(float(rod.width.max()) for rod in (*stars.rods, *drawn.rods))
    near_arm, near_line = shapely.STRtree(lines).query(arms, predicate="dwithin", distance=widest)
    for i, j in zip(near_arm, near_line, strict=True):
        arm, rod = stars.rods[i], drawn.rods[j]
        gap = float(shapely.distance(arms[i], lines[j]))
        if gap < 0.5 * (arm.width.max() + rod.width.max()):
            place = shapely.get_coordinates(shapely.shortest_line(arms[i], lines[j])).mean(axis=0)
            at, centre = (f"[{x:.2f}, {y:.2f}]" for x, y in (place, arm.points[0]))
            what = "crosses" if gap == 0.0 else f"is {gap:.2f} mm from"
            problem = f"an arm of the star at {centre} {what} {rod.name} at {at}: shorten it, remove the star, or move"
            raise DesignError("stars", f"{problem} the line", stars=[arm.group], place_mm=place)
