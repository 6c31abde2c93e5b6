"""The section `[stars]`: sizes of the stars over the sheet, and single stars changed by hand."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.design.section import Flag, Number, Point, Section, Side, Whole
from asterism.pattern.design.sizing.profiles import SizingField

THICKNESS_RANGE_MM = (0.05, 5.0)
WIDTH_RANGE_MM = (0.1, 10.0)
# Shorter arms are dots that come off the fabric.
MIN_ARM_MM = 1.0
MAX_SITE_NUMBER = 100_000
Branch = Literal["up", "down", "free"]
SiteNumber = Annotated[Whole, Field(ge=-MAX_SITE_NUMBER, le=MAX_SITE_NUMBER)]
Site = tuple[SiteNumber, SiteNumber]


class Override(Section):
    """One star changed by hand."""

    star: Whole | None = Field(None, ge=0)  # its number, from the origin outwards
    at_mm: Point | None = None  # place of its centre
    # its lattice site [i, j], at `i v1 + j v2` from the lattice's origin with the rows v1, v2 of `Lattice.vectors`. A
    # site off the sheet is ignored, so that the entry survives changes of the outline.
    site: Site | None = None
    # length_mm, thickness_mm, width_mm: sizes in place of those of the profiles.
    length_mm: Number | None = None
    thickness_mm: Number | None = None
    width_mm: Number | None = None
    branch: Branch | None = None  # the side to which the star starts
    side: Side | None = None  # the face of the fabric that carries its plastic
    remove: Flag = False  # no star stands there

    @model_validator(mode="after")
    def _changes_one_star(self) -> Override:
        self._check_one_of("star", "at_mm", "site")
        changes = [self.length_mm, self.thickness_mm, self.width_mm, self.branch, self.side]
        if self.remove == any(change is not None for change in changes):
            raise DesignError("", "must either change a size or remove the star, or set its branch or side")
        return self


class Stars(Section):
    """Sizes of the stars, each a number or a sizing profile over the sheet."""

    # length_mm, length_fraction: length of the arms in mm, or as a fraction of the lattice's spacing; one of them.
    length_mm: SizingField | None = None
    length_fraction: SizingField | None = None
    # thickness_mm, width_mm: cross-section of the arms.
    thickness_mm: SizingField = 0.3
    width_mm: SizingField = 1.2
    vary_along_arms: Flag = False  # evaluate thickness and width at the arm's tip too, not only at the star's centre
    branch: Branch = (
        "up"  # the side to which the stars start. `up` is the side of the plastic, `free` starts them flat.
    )
    # the face of the fabric that carries the plastic; above by default. Plastic below curls the other way.
    side: Side | None = None
    override: tuple[Override, ...] = ()  # stars changed one by one
    # rounds thickness and width of every star, also of changed ones, to what a printer can make.
    rounding: Rounding | None = None

    @model_validator(mode="after")
    def _one_length(self) -> Stars:
        self._check_one_of("length_mm", "length_fraction")
        return self
