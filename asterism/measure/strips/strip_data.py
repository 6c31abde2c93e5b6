"""Strips as arrays: curvatures with their usual errors, of single strips or as means of equal strips."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.strips.strip_table import Reading

# Usual errors, for the weights of a fit; the scatter of the strips scales them. The first is that of a side of a box,
# and repeats average it. The second is a part of the curvature, and equal strips may share it: by a wrong thickness.
_USUAL_READING_MM = 0.3
_USUAL_SHARE = 0.03


@dataclass(frozen=True)
class StripData:
    """Strips, or means of strips of a kind: one thickness, fabric and stretch. Arrays (n,).

    Attributes
    ----------
    curvature : 1/mm; 0 for flat strips.
    sensitivity : 1/mm^2, change of the curvature by a change of the box.
    limit : 1/mm, bound of errors that repeats share: of flat strips, and of rounding to the marks of a ruler.
    thickness, fabric : mm, thickness of the plastic and of the fabric.
    mismatch : 1 - 1/s^2 for the stretch s.
    count : strips of each mean.
    """

    curvature: Floats
    sensitivity: Floats
    limit: Floats
    thickness: Floats
    fabric: Floats
    mismatch: Floats
    count: Floats

    @classmethod
    def of(cls, readings: list[Reading], flat_height_mm: float) -> Self:
        """Single strips; an arc lower than `flat_height_mm` looks flat."""
        curvature = np.array([r.curvature_per_mm or 0.0 for r in readings])
        # of an arc up to a half circle, and beyond, where its width is 2/curvature
        sensitivity = np.maximum(8 / np.array([r.length_mm for r in readings]) ** 2, curvature**2 / 2)
        flat = np.array([r.curvature_per_mm is None for r in readings])
        strips = cls(
            curvature,
            sensitivity,
            flat * flat_height_mm * sensitivity,
            np.array([r.thickness_mm for r in readings]),
            np.array([r.fabric_thickness_mm for r in readings]),
            1 - np.array([r.stretch for r in readings]) ** -2,
            np.ones(len(readings)),
        )
        # Repeats average the error of rounding if they scatter by marks of the ruler: for a normal scatter s and marks
        # at a distance d, their mean is off by about d/2 exp(-2 pi^2 s^2/d^2) (Widrow, Kollar, Quantization Noise).
        step = np.array([r.step_mm for r in readings])
        kinds, kind = strips.kinds()
        squares = np.sum(((curvature - kinds.curvature[kind]) / sensitivity) ** 2)
        scatter = max(squares / max(len(kind) - len(kinds.count), 1) - np.max(step) ** 2 / 12, 0.0)
        shared = step / 2 * sensitivity * np.exp(-2 * np.pi**2 * scatter / np.maximum(step, 1e-9) ** 2)
        return replace(strips, limit=np.maximum(strips.limit, shared))

    def kinds(self) -> tuple[StripData, Ints]:
        """Means of the kinds, and the kind of each strip."""
        sizes = np.column_stack([self.thickness, self.fabric, self.mismatch])
        _, first, kind = np.unique(sizes, axis=0, return_index=True, return_inverse=True)
        kind = kind.reshape(-1)
        count = np.bincount(kind).astype(float)
        same = {name: values[first] for name, values in vars(self).items()}
        means = {name: np.bincount(kind, getattr(self, name)) / count for name in ("curvature", "sensitivity", "limit")}
        return StripData(**(same | means | {"count": count})), kind

    def usual_error(self, curvature: Floats) -> Floats:
        """(n,) 1/mm, usual errors at some curvatures (n,)."""
        reading = (_USUAL_READING_MM * self.sensitivity) ** 2 / self.count
        return np.asarray(np.sqrt(reading + (_USUAL_SHARE * curvature) ** 2 + self.limit**2 / 3))

    def beyond(self, curvature: Floats) -> Floats:
        """(n,) 1/mm, deviations from some curvatures (n,), as far as they exceed `limit`."""
        off = self.curvature - curvature
        return np.asarray(np.sign(off) * np.maximum(np.abs(off) - self.limit, 0.0))
