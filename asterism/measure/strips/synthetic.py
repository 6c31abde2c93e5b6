"""Synthetic strips: readings of a known material with known errors, to test the fit."""

from __future__ import annotations

import numpy as np

from asterism.measure.strips import arc
from asterism.measure.strips.reading import Reading
from asterism.measure.strips.specimen import THICKNESSES_MM
from asterism.pattern.design.materials import Fabric, Plastic, rest_curvature


def synthetic_readings(
    seed: int,
    plastic: Plastic | None = None,
    *,
    count: int = 10,
    length: float = 60.0,
    reading_mm: float = 0.3,
    scatter: float = 0.03,
    flat_mm: float = 0.0,
    stretch: float = 1.35,
    fabric_mm: float = 0.8,
    step_mm: float = 0.0,
    off_mm: float = 0.0,
) -> list[Reading]:
    """Readings of `count` strips of each of the paper's thicknesses, with fabric and peeled.

    Parameters
    ----------
    stretch, fabric_mm : of the fabric, its thickness when it is released.
    reading_mm : standard deviation of each side of a box.
    scatter : relative standard deviation of the curvature from strip to strip.
    flat_mm : strips whose arc is lower count as flat.
    step_mm : step of the ruler to which sides are rounded; 0 for no rounding.
    off_mm : standard deviation of the error of a thickness, which all its strips share.
    """
    plastic = plastic or Plastic(kappa_bar_per_mm=0.003)
    rng = np.random.default_rng(seed)
    # a random generator of its own keeps tables without these errors unchanged
    fabric = Fabric(stretch=stretch, thickness_mm=fabric_mm)
    errors = off_mm * np.random.default_rng([seed, 1]).standard_normal(len(THICKNESSES_MM))
    readings = []
    for i, h1 in enumerate(np.repeat(THICKNESSES_MM, count)):
        real = h1 + errors[i // count]
        with_fabric = float(rest_curvature(real, fabric, plastic))
        alone = float(rest_curvature(real, fabric, plastic.model_copy(update={"rest_curvature": "none"})))
        for peeled, kappa in ((False, with_fabric), (True, alone)):
            true = kappa * (1 + scatter * rng.standard_normal())
            width, height = (float(side) + reading_mm * rng.standard_normal() for side in arc.box(true, length))
            if step_mm:
                width, height = (step_mm * round(side / step_mm) for side in (width, height))
            bent = None if height <= flat_mm else float(arc.curvature(width, height))
            known = (str(i + 1), i + 2, float(h1), length, stretch, fabric_mm)
            readings.append(Reading(*known, peeled, bent, step_mm=step_mm))
    return readings
