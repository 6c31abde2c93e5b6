"""The plan of a sheet as plain data for the page: lattice, stars, rods, outline and supports in printed millimetres."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from asterism.pattern.design.stars import Site
from asterism.pattern.layout.layout import Layout
from asterism.studio.weights import PLAIN_WEIGHT

PLAN_DIGITS = 5


def plan_data(layout: Layout, painted_sites: set[Site], weights: Mapping[Site, float]) -> dict[str, Any]:
    """Plain data of a layout; lengths in mm.

    Parameters
    ----------
    painted_sites : sites whose sizes differ from the design's profiles.
    weights : of places in a fit, where they are painted.

    Returns
    -------
    outline_mm, spacing_mm, lattice, sites (in the order of the stars' numbers: site, at_mm, sizes_mm, arms, removed,
    painted, weight), rods (without the arms of stars), holes_mm, pins (one entry a table of the design), ignored_sites.
    """
    places = layout.lattice.place(layout.sheet_sites)
    arms: list[list[Any]] = [[] for _ in layout.sheet_sites]
    numbers = layout.star_number[layout.arm_star]
    ends = np.stack([layout.centres[layout.arm_star], layout.arm_tip], axis=1)
    for number, arm in zip(numbers.tolist(), _plain(ends), strict=True):
        arms[number].append(arm)
    sites = [
        {
            "site": site,
            "at_mm": at,
            "sizes_mm": sizes,
            "arms": arms[number],
            "removed": sizes[0] == 0.0,
            "painted": tuple(site) in painted_sites,
            "weight": weights.get(tuple(site), PLAIN_WEIGHT),
        }
        for number, (site, at, sizes) in enumerate(
            zip(layout.sheet_sites.tolist(), _plain(places), _plain(layout.site_sizes_mm), strict=True)
        )
    ]
    return {
        "outline_mm": _plain(layout.outline),
        "spacing_mm": layout.spacing_mm,
        "lattice": {"vectors_mm": _plain(layout.lattice_vectors), "origin_mm": _plain(layout.lattice_origin)},
        "sites": sites,
        "rods": [
            {
                "name": rod.name,
                "points_mm": _plain(rod.points),
                "thickness_mm": _plain(rod.thickness),
                "width_mm": _plain(rod.width),
            }
            for rod in layout.drawn_rods
        ],
        "holes_mm": [_plain(ring) for ring in layout.holes],
        "pins": [
            {
                "points_mm": _plain(pins.points),
                "edges": [_plain(np.array(segment)) for segment in pins.segments(layout.edges)],
                "places_mm": _plain(pins.places(pins.points)),
                "fixed": list(pins.fixed),
                "step": pins.step,
            }
            for pins in layout.pins
        ],
        "ignored_sites": layout.ignored_sites.tolist(),
    }


def _plain(values: Any) -> list[Any]:
    rounded: list[Any] = np.round(np.asarray(values, dtype=float), PLAN_DIGITS).tolist()
    return rounded
