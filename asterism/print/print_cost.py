"""Estimate of the plastic and the time of a print."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely

from asterism.pattern.design.rounding import Rounding
from asterism.print.plastic_profile import PlasticProfile
from asterism.print.printer import Printer
from asterism.print.solid import Terrace
from asterism.results.records.export import PrintCostRecord


def print_cost(
    prints: Sequence[Sequence[Terrace]], printer: Printer, rounding: Rounding, plastic: PlasticProfile
) -> PrintCostRecord:
    """Volume, mass, filament and time of a print.

    Lines as wide as the nozzle fill each layer at the printer's speed. The nozzle travels from each island of a layer
    to the nearest one, and loses `speed.island_s` at each. Acceleration is not modelled.

    Parameters
    ----------
    prints : nested terraces of each solid.
    """
    volume = float(
        sum(
            step.region.area * (step.height_mm - below)
            for steps in prints
            for step, below in zip(steps, [0.0, *(step.height_mm for step in steps)], strict=False)
        )
    )
    seconds = 60.0 * printer.speed.heating_min
    top = max(step.height_mm for steps in prints for step in steps)
    layers = 1 + max(round((top - rounding.first_layer_mm) / rounding.layer_mm), 0)
    length = 0.0
    for layer in range(layers):
        middle = rounding.first_layer_mm + (layer - 0.5) * rounding.layer_mm if layer else 0.5 * rounding.first_layer_mm
        area, islands, travel = _slice(prints, middle)
        lines = area / rounding.line_mm
        speed = printer.speed.print_mm_s if layer else printer.speed.first_layer_mm_s
        seconds += lines / speed + travel / printer.speed.travel_mm_s + islands * printer.speed.island_s
        length += lines
    return PrintCostRecord(
        volume_mm3=volume,
        mass_g=volume * plastic.density_kg_m3 * 1e-6,
        filament_m=volume / (math.pi / 4 * printer.filament_mm**2) * 1e-3,
        layers=layers,
        lines_m=length * 1e-3,
        minutes=seconds / 60.0,
    )


def _slice(prints: Sequence[Sequence[Terrace]], height_mm: float) -> tuple[float, int, float]:
    """Area (mm^2), number of islands, and travel between them (mm) of the slice at a height."""
    area, islands, travel = 0.0, 0, 0.0
    for steps in prints:
        # terraces are nested: the first one above this height is the slice
        here = next((step.region for step in steps if step.height_mm > height_mm), None)
        if here is None:
            continue
        parts = shapely.get_parts(here)
        centres = shapely.get_coordinates(shapely.centroid(parts))
        area += here.area
        islands += len(parts)
        if len(parts) > 1:
            nearest = shapely.STRtree(parts).query_nearest(
                parts, exclusive=True, all_matches=False, return_distance=False
            )
            travel += float(np.linalg.norm(centres[nearest[0]] - centres[nearest[1]], axis=1).sum())
    return area, islands, travel
