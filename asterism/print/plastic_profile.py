"""What the instruction and the estimate have to know about a plastic."""

from __future__ import annotations

from pydantic import Field

from pattern.design.section import Line, MassDensity, Number, Section


class PlasticProfile(Section):
    """A plastic as the printer sees it; how stiff it is says the design.

    Attributes
    ----------
    density_kg_m3 : for the mass.
    tiny_arm_mm : stars with shorter arms are named: such dots may jump off the fabric.
    nozzle_c, bed_c : temperatures for the instruction; left out if they are not given.
    advice : lines for the instruction.
    """

    name: Line = Field(min_length=1, max_length=100)
    density_kg_m3: MassDensity = Field(gt=0)
    tiny_arm_mm: Number = Field(3.0, ge=0, le=100)
    nozzle_c: Number | None = Field(None, ge=0, le=500)
    bed_c: Number | None = Field(None, ge=0, le=200)
    advice: tuple[Line, ...] = Field((), max_length=20)
