"""The profile of a plastic, for the instructions and the estimate."""

from __future__ import annotations

from pydantic import Field

from asterism.pattern.design.section import Line, MassDensity, Number, Section


class PlasticProfile(Section):
    """A plastic for the printer. Its stiffness belongs to the design.

    Attributes
    ----------
    density_kg_m3 : density, for the mass.
    tiny_arm_mm : the export names stars with shorter arms, which may jump off the fabric.
    nozzle_c, bed_c : temperatures in the instructions; None for no advice.
    advice : lines of the instructions.
    """

    name: Line = Field(min_length=1, max_length=100)
    density_kg_m3: MassDensity = Field(gt=0)
    tiny_arm_mm: Number = Field(3.0, ge=0, le=100)
    nozzle_c: Number | None = Field(None, ge=0, le=500)
    bed_c: Number | None = Field(None, ge=0, le=200)
    advice: tuple[Line, ...] = Field((), max_length=20)
