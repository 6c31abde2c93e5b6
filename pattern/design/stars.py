"""The section `[stars]`: sizes of the stars over the sheet, and single stars changed by hand.

Layouts, painted stars, laws, fits and pages take the sizes from `STAR_SIZES`. A new size is an entry there, fields of
its key in `Stars` and `Override` here and for drawn rods in `pattern.design.rods`, its nodes in `CampaignPlan` of
`homogenize.law.material`, and its effect on the rods in `discrete.model.discrete_model`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal, get_args

import numpy as np
from pydantic import Field, model_validator

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.rounding import Rounding, rounded
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
RodSizeKey = Literal["thickness_mm", "width_mm"]
SizeName = Literal["length_mm", RodSizeKey]


@dataclass(frozen=True)
class StarSize:
    """A size of the arms of stars, which laws are functions of."""

    name: str  # in sentences, and with its ending for several in `nodes_key`
    key: SizeName  # in designs, samples and law files
    nodes_key: str  # in material files
    # smallest and largest value that can be printed. The spacing of the stars limits lengths further.
    limits: tuple[float, float]
    # largest ratio of adjacent nodes in the plan for the stars of one design, and the law is interpolated over the
    # logarithm of the size, which is above 0; None for even steps and the size itself.
    node_ratio: float | None = None
    # the same for the rods of a motif: bending changes with the cube of the thickness, and membrane with the width.
    rod_ratio: float | None = None

    @property
    def plural(self) -> str:
        """The name for several stars."""
        return self.nodes_key.removesuffix("_mm")

    @property
    def usual(self) -> float:
        """The size of stars and rods that give none; laws that do not know the size are for it. Lengths have none."""
        usual: float = Stars.model_fields[self.key].default
        return usual

    def limits_at(self, spacing_mm: float) -> tuple[float, float]:
        """The limits on a lattice: arms are at most as long as its spacing."""
        low, high = self.limits
        return low, spacing_mm if math.isinf(high) else high

    def coordinate(self, values: Floats) -> Floats:
        """The coordinate that the law is interpolated over, of the same shape as the values."""
        return np.asarray(np.log(values)) if self.node_ratio else values


LENGTH = StarSize("length", "length_mm", "lengths_mm", (MIN_ARM_MM, math.inf))
THICKNESS = StarSize("thickness", "thickness_mm", "thicknesses_mm", THICKNESS_RANGE_MM, node_ratio=1.2, rod_ratio=1.12)
WIDTH = StarSize("width", "width_mm", "widths_mm", WIDTH_RANGE_MM, node_ratio=1.3, rod_ratio=1.26)
# wherever sizes of a star stand in a row, they stand in this order
STAR_SIZES = (LENGTH, THICKNESS, WIDTH)
# of the sections of arms and of drawn rods, which have no length of their own
ROD_SIZES = STAR_SIZES[1:]
SIZE_KEYS: tuple[SizeName, ...] = tuple(size.key for size in STAR_SIZES)
SIZE_OF = {size.key: size for size in STAR_SIZES}
ROD_SIZE_KEYS: tuple[RodSizeKey, ...] = get_args(RodSizeKey)


def rounded_sections(rounding: Rounding | None, sections: Floats) -> Floats:
    """Sections (..., K), in the order of `ROD_SIZES`, as they are printed."""
    return np.stack([rounded(rounding, size.key, sections[..., k]) for k, size in enumerate(ROD_SIZES)], axis=-1)


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
        if self.remove == any(getattr(self, key) is not None for key in (*SIZE_KEYS, "branch", "side")):
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
