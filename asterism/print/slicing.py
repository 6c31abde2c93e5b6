"""Settings of slicers with which every line of an arm is printed."""

from __future__ import annotations

import math

from asterism.pattern.design.rounding import Rounding

# more walls than half the lines of the widest arm
WALLS = 20


def wider_mm(rounding: Rounding) -> float:
    """By how much each side of a solid is moved outwards for slicers whose lines have round edges.

    In PrusaSlicer and its forks a line of width w and height h holds h (w - (1 - pi/4) h), less than a rectangle:
    11 % in a line of 0.4 x 0.2 mm. Arms that are wider by (1 - pi/4) h get the plastic of the solid.
    """
    height = (rounding.first_layer_mm + rounding.layer_mm) / 2
    return round((1 - math.pi / 4) * height / 2, 3)


def prusa_settings(rounding: Rounding) -> dict[str, str]:
    """Settings of one object in PrusaSlicer, which go before those of its profiles."""
    widths = ("", "perimeter_", "external_perimeter_", "infill_", "solid_infill_", "top_infill_")
    return {
        "layer_height": f"{rounding.layer_mm:g}",
        "perimeter_generator": "arachne",
        "perimeters": str(WALLS),
        **{f"{part}extrusion_width": f"{rounding.line_mm:g}" for part in widths},
        "xy_size_compensation": f"{wider_mm(rounding):g}",
        # each of these takes lines away from the first or the last layer
        "elefant_foot_compensation": "0",
        "only_one_perimeter_first_layer": "0",
        "top_one_perimeter_type": "none",
        "fill_density": "100%",
        "fill_pattern": "rectilinear",
        "brim_type": "no_brim",
        "raft_layers": "0",
        "support_material": "0",
    }
