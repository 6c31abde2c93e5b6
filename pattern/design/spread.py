"""The section `[spread]`: how far a print may be off the values of its design that nobody measures exactly."""

from __future__ import annotations

from pydantic import Field

from asterism.pattern.design.section import Number, Section

MAX_FACTOR = 10.0
MAX_KAPPA_BAR_ERROR_PER_MM = 0.1


class Spread(Section):
    """Intervals about the values of the design that hold those of 95 in 100 prints.

    The defaults are those of a fabric and a plastic that nobody measured. An error of 0 or a factor of 1 leaves its
    value as it is.
    """

    # E1/E2 is from its value over this factor to its value times this factor.
    modulus_ratio_factor: Number = Field(1.3, ge=1, le=MAX_FACTOR)
    stretch_percent: Number = Field(10.0, ge=0, lt=100)  # of the fabric's strain `stretch - 1`, to both sides
    bending_factor: Number = Field(2.0, ge=1, le=MAX_FACTOR)  # of the fabric's bending stiffness, as that of E1/E2
    kappa_bar_error_per_mm: Number = Field(0.0015, ge=0, le=MAX_KAPPA_BAR_ERROR_PER_MM)  # to both sides
    # of all stars and rods alike, to both sides, as a first layer has it.
    thickness_error_mm: Number = Field(0.03, ge=0, le=1)
    grain_error_deg: Number = Field(5.0, ge=0, le=45)  # to both sides; of fabric with a grain
