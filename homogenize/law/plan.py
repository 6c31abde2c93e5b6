"""The plan of a campaign: the stretches and star sizes at which unit cells are solved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Literal, Self

import numpy as np
from pydantic import Field, ValidationInfo, field_validator, model_validator

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.axes import AXES, LENGTH, Axis, min_length
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import Number, Point, Section, Whole
from asterism.pattern.design.stars import MIN_ARM_MM

# cells of one grid or one set of scattered cells
MAX_SAMPLES = 100_000
# stars are at least 1 mm apart, and a cell has at least three edges between two stars
MIN_CELL_EDGE_MM = 0.2
# between two stretches: designs with rounded numbers must find the stretch of their table
MIN_STRETCH_STEP = 1e-4
# arms of held-out cells, unless the law covers shorter or only longer ones
MIN_TEST_ARM_MM = 1.5
# decimals of the sizes of scattered and held-out cells, in mm
SIZE_DECIMALS = 3
AxisNodes = tuple[Number, ...]
Sizes = tuple[float, ...]

_BY_NODES = {axis.nodes_key: axis for axis in AXES}
_BY_RANGE = {axis.range_key: axis for axis in AXES}


@dataclass(frozen=True, order=True)
class CellTask:
    """One unit cell to solve.

    Attributes
    ----------
    stretch : of the fabric, equal in x and y.
    held_out : the cell tests the law; the fit does not use it.
    sizes : of the star, in the order of `homogenize.law.axes.AXES`.
    """

    stretch: float
    held_out: bool
    sizes: Sizes

    @property
    def length_mm(self) -> float:
        """Length of the arms."""
        return self.sizes[0]

    @property
    def is_bare(self) -> bool:
        """Whether the star has no arms, so that the cell is the bare fabric."""
        return self.sizes[0] == 0.0


class CampaignPlan(Section):
    """Section `[plan]` of a material file: which unit cells are solved.

    Attributes
    ----------
    kind : "grid" solves all combinations of the three lists. "halton" and "sobol" scatter `count` cells over the
        ranges, by the sequence of that name.
    stretches : the law has one table for each; by default the stretch of the fabric alone.
    lengths_mm, thicknesses_mm, widths_mm : nodes of a grid, increasing. The bare fabric (length 0) is always solved.
    length_range_mm, thickness_range_mm, width_range_mm : [low, high] of scattered cells.
    count, seed : of scattered cells.
    edge_mm : of the cells' mesh. Sheets that use the law have meshes with the same edge length.
    graded : finer at arms and tips, as sheets with `mesh.graded`; not for the paper's hinges.
    held_out : number of random cells per stretch that test the law.
    """

    kind: Literal["grid", "halton", "sobol"] = "grid"
    stretches: AxisNodes | None = Field(None, min_length=1, max_length=20)
    lengths_mm: AxisNodes = Field((2.0, 4.0, 5.5, 7.0, 8.5, 10.0, 11.5, 13.0), min_length=1, max_length=200)
    thicknesses_mm: AxisNodes = Field((0.2, 0.25, 0.3, 0.4, 0.5, 0.6), min_length=1, max_length=200)
    widths_mm: AxisNodes = Field((0.8, 1.2, 1.6), min_length=1, max_length=200)
    length_range_mm: Point = (1.0, 13.0)
    thickness_range_mm: Point = (0.2, 0.6)
    width_range_mm: Point = (0.8, 1.6)
    count: Whole = Field(128, ge=8, le=MAX_SAMPLES)
    seed: Whole = Field(0, ge=0, lt=2**32)
    edge_mm: Number = Field(2.0, ge=MIN_CELL_EDGE_MM, le=100)
    graded: bool = False
    held_out: Whole = Field(12, ge=0, le=10_000)

    @field_validator("stretches", *_BY_NODES)
    @classmethod
    def _increase(cls, values: AxisNodes | None) -> AxisNodes | None:
        if values is not None and any(b <= a for a, b in pairwise(values)):
            raise DesignError("", "must increase", list(values))
        return values

    @field_validator("stretches")
    @classmethod
    def _are_stretches(cls, values: AxisNodes | None) -> AxisNodes | None:
        if values is None:
            return None
        _check_within(values, (1.0, 3.0))
        if any(b - a < MIN_STRETCH_STEP * (1.0 - 1e-6) for a, b in pairwise(sorted(values))):
            raise DesignError("", f"must be at least {MIN_STRETCH_STEP:g} apart", list(values))
        return values

    @field_validator(*_BY_NODES, *_BY_RANGE)
    @classmethod
    def _can_be_printed(cls, values: AxisNodes, info: ValidationInfo) -> AxisNodes:
        axis = (_BY_NODES | _BY_RANGE)[str(info.field_name)]
        if axis is not LENGTH:
            _check_within(values, axis.limits)
            return values
        printed = [v for v in values if v != 0]
        if not all(v >= MIN_ARM_MM for v in printed):
            raise DesignError("", f"must be at least {MIN_ARM_MM:g}: shorter arms are not printed", list(values))
        if not printed:
            raise DesignError("", "must hold a length above 0: the bare fabric is always there", list(values))
        return values

    @field_validator(*_BY_RANGE)
    @classmethod
    def _from_low_to_high(cls, values: Point) -> Point:
        if not 0 < values[0] < values[1]:
            raise DesignError("", "must be [low, high] with 0 < low < high", list(values))
        return values

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        foreign = {*_BY_RANGE, "count"} if self.kind == "grid" else set(_BY_NODES)
        for key in sorted(foreign & self.model_fields_set):
            raise DesignError(key, f'does not go with kind = "{self.kind}"', getattr(self, key))
        if math.prod(len(self.nodes(axis)) for axis in AXES) > MAX_SAMPLES:
            raise DesignError("", f"must have at most {MAX_SAMPLES} cells in its grid")
        return self

    def nodes(self, axis: Axis) -> AxisNodes:
        """Nodes of an axis, for a grid of cells."""
        nodes: AxisNodes = getattr(self, axis.nodes_key)
        return nodes

    def scatter_range(self, axis: Axis) -> Point:
        """Range of an axis, for scattered cells."""
        low_high: Point = getattr(self, axis.range_key)
        return low_high

    @property
    def ranges(self) -> tuple[Point, ...]:
        """Smallest and largest size along each of `AXES`; the smallest length is 0."""
        ends = [self.nodes(axis) if self.kind == "grid" else self.scatter_range(axis) for axis in AXES]
        return tuple((0.0 if axis is LENGTH else end[0], end[-1]) for axis, end in zip(AXES, ends, strict=True))

    def sizes(self) -> list[Sizes]:
        """Sizes of the stars with arms that the law is fitted to."""
        if self.kind == "grid":
            return list(product(*([v for v in self.nodes(axis) if v > 0] for axis in AXES)))
        from scipy.stats import qmc  # its import takes half a second, and only these plans use it

        engine = qmc.Halton if self.kind == "halton" else qmc.Sobol
        count = self.count
        if self.kind == "sobol":  # its points are balanced in powers of two
            count = 2 ** int(np.ceil(np.log2(self.count)))
        points = engine(len(AXES), seed=np.random.default_rng(self.seed)).random(count)[: self.count]
        return _spread(points, [self.scatter_range(axis) for axis in AXES])

    def min_length_mm(self, spacing_mm: float) -> float:
        """The shortest arms that the law covers; 0 if it covers all."""
        return min_length(self.nodes(LENGTH) if self.kind == "grid" else self.scatter_range(LENGTH), spacing_mm)

    def test_sizes(self, spacing_mm: float) -> list[Sizes]:
        """Sizes of the held-out stars, with lengths that the law covers."""
        (_, longest), *others = self.ranges
        low = max(min(max(MIN_ARM_MM, MIN_TEST_ARM_MM), longest), self.min_length_mm(spacing_mm))
        points = np.random.default_rng(self.seed + 1).random((self.held_out, len(AXES)))
        return _spread(points, [(low, longest), *others])


def _check_within(values: AxisNodes, limits: tuple[float, float]) -> None:
    if not all(limits[0] <= v <= limits[1] for v in values):
        raise DesignError("", f"must be from {limits[0]:g} to {limits[1]:g}", list(values))


def _spread(points: Floats, ranges: Sequence[Point]) -> list[Sizes]:
    """Sizes for points of the unit cube (n, A), rounded so that files stay readable."""
    low, high = np.transpose(ranges)
    rows = np.clip(np.round(low + points * (high - low), SIZE_DECIMALS), low, high)
    return [tuple(float(size) for size in row) for row in rows]
