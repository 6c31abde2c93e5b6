"""Synthetic strips: readings of a known material with known errors, to test the fit."""

from __future__ import annotations

import numpy as np

from asterism.measure.strip_table import Reading, arc_box, arc_curvature
from asterism.pattern.design.materials import Fabric, Plastic, rest_curvature
from asterism.process.settings import THICKNESSES_MM


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
    moduli: tuple[float, float] | None = None,
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
    moduli : of the fabric along and across its grain, with strips that lie along and across in turn.
    """
    plastic = plastic or Plastic(kappa_bar_per_mm=0.003)
    rng = np.random.default_rng(seed)
    # a random generator of its own keeps tables without these errors unchanged
    fabric = Fabric(stretch=stretch, thickness_mm=fabric_mm)
    errors = off_mm * np.random.default_rng([seed, 1]).standard_normal(len(THICKNESSES_MM))
    thicknesses = np.repeat(THICKNESSES_MM, count)
    real = thicknesses + np.repeat(errors, count)
    bare = plastic.model_copy(update={"rest_curvature": "none"})
    along = np.ones(len(real), dtype=bool)
    if moduli:
        fabric = Fabric(stretch=stretch, thickness_mm=fabric_mm, modulus_mpa=moduli)
        along = np.arange(len(real)) % 2 == 0
    lie = np.column_stack([along, ~along]).astype(float)
    curvatures = np.column_stack([rest_curvature(real, fabric, each, lie) for each in (plastic, bare)])
    noise = rng.standard_normal((*curvatures.shape, 3))
    sides = np.stack(arc_box(curvatures * (1 + scatter * noise[..., 0]), length)) + reading_mm * np.moveaxis(
        noise[..., 1:], 2, 0
    )
    if step_mm:
        sides = step_mm * np.round(sides / step_mm)
    bent = arc_curvature(*sides)
    readings = []
    for i, h in enumerate(thicknesses):
        direction = ("along" if along[i] else "across") if moduli else None
        for peeled in (0, 1):
            curvature = None if sides[1, i, peeled] <= flat_mm else float(bent[i, peeled])
            strip = (str(i + 1), i + 2, float(h), length, stretch, fabric_mm, bool(peeled))
            readings.append(Reading(*strip, curvature, step_mm=step_mm, direction=direction))
    return readings
