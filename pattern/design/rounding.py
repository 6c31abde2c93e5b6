"""Sizes that a printer can make: whole layers over a first one, and whole lines."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.section import Number, Section


class Rounding(Section):
    """Thickness is a first layer and n more, n = 0, 1, ...; width is one line or more."""

    # first_layer_mm, layer_mm: heights of the first layer and of the others.
    first_layer_mm: Number = Field(ge=0.05, le=2)
    layer_mm: Number = Field(ge=0.01, le=2)
    line_mm: Number = Field(ge=0.05, le=5)  # width of a line, the nozzle's

    def rounds(self, key: str) -> bool:
        """Whether layers or lines limit a size of arms or rods of this key."""
        return key in ("thickness_mm", "width_mm")

    def thickness(self, exact_mm: Floats) -> Floats:
        """The nearest thickness that can be printed; halfway goes up."""
        return np.round(self.height(np.maximum(_nearest(self.layers(exact_mm)), 0.0)), 9)

    def layers(self, height_mm: Floats) -> Floats:
        """Number of layers above the first one for a height, with its fraction."""
        return np.asarray((height_mm - self.first_layer_mm) / self.layer_mm)

    def height(self, layers: Floats) -> Floats:
        """Height (mm) of a first layer and a number of layers above it."""
        return np.asarray(self.first_layer_mm + self.layer_mm * layers)

    def width(self, exact_mm: Floats) -> Floats:
        """The nearest width that can be printed; halfway goes up."""
        return np.round(self.line_mm * np.maximum(_nearest(exact_mm / self.line_mm), 1.0), 9)


def rounded(rounding: Rounding | None, key: str, exact: Floats) -> Floats:
    """A size of arms or rods by its key, as it is printed."""
    if rounding is None or not rounding.rounds(key):
        return exact
    return rounding.thickness(exact) if key == "thickness_mm" else rounding.width(exact)


def _nearest(number: Floats) -> Floats:
    # decimal fractions are not exact: a value meant as a half goes up
    return np.asarray(np.floor(np.asarray(number, dtype=float) + 0.5 + 1e-9))
