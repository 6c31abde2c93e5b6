"""The printed lines of a sheet as ribbons of equally many stations: one for each arm, several along each drawn rod."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.layout.layout import Layout

STATIONS = 5  # along each ribbon
# length of a ribbon along a drawn rod, so that curves look smooth; longer where there would be too many ribbons
RIBBON_MM = 5.0
MAX_RIBBONS = 6000
NO_SITE = 2**32 - 1  # in place of the row of a star, for ribbons of drawn rods


@dataclass(frozen=True)
class RibbonStations:
    """Stations along all ribbons, in printed coordinates.

    Attributes
    ----------
    points : (A, K, 2) mm, of the middle lines.
    width, thickness : (A, K) mm.
    site : (A,) row of the star's site in the plan; `NO_SITE` for drawn rods.
    """

    points: Floats
    width: Floats
    thickness: Floats
    site: Ints


def ribbon_stations(layout: Layout) -> RibbonStations:
    """The stations of a layout: arms from the centre to the tip, then drawn rods in pieces of about `RIBBON_MM`.

    Examples
    --------
    >>> from asterism.pattern.design.design import Design
    >>> from asterism.pattern.layout.print_layout import print_layout
    >>> lines = [{"line_mm": [(-5, 0), (5, 0)]}]
    >>> sheet = print_layout(Design.from_dict({"rods": {"draw": lines}, "border": {"rectangle_mm": (12, 8)}}))
    >>> stations = ribbon_stations(sheet)
    >>> stations.points[:, [0, -1], 0].tolist()
    [[-5.0, 0.0], [0.0, 5.0]]
    """
    share = np.linspace(0.0, 1.0, STATIONS)
    start = layout.centres[layout.arm_star][:, None]
    points = [start + share[:, None] * (layout.arm_tip[:, None] - start)]
    width, thickness = ([_between(ends, share)] for ends in (layout.arm_width, layout.arm_thickness))
    longest = max(RIBBON_MM, sum(rod.length for rod in layout.drawn_rods) / MAX_RIBBONS)
    for rod in layout.drawn_rods:
        count = int(np.ceil(rod.length / longest))
        part = ((np.arange(count)[:, None] + share) / count).ravel()
        points.append(rod.at(rod.points, part).reshape(count, STATIONS, 2))
        width.append(rod.at(rod.width, part).reshape(count, STATIONS))
        thickness.append(rod.at(rod.thickness, part).reshape(count, STATIONS))
    site = np.full(sum(len(part) for part in points), NO_SITE)
    site[: len(layout.arm_star)] = layout.star_number[layout.arm_star]
    return RibbonStations(np.concatenate(points), np.concatenate(width), np.concatenate(thickness), site)


def _between(ends: Floats, share: Floats) -> Floats:
    """(A, K) values between those at both ends (A, 2)."""
    return np.asarray(ends[:, :1] + share * (ends[:, 1:] - ends[:, :1]))
