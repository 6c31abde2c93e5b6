"""What a calibration computes: a material, and the star sizes at which its cells are solved."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from homogenize.law.law_range import min_length
from pattern.design.errors import DesignError
from pattern.design.section import Number, Point, Section, Whole
from pattern.design.stars import MIN_ARM_MM, THICKNESS_RANGE_MM, WIDTH_RANGE_MM

MAX_SAMPLES = 100_000
# stars are at least 1 mm apart, and a cell has three edges between them
MIN_CELL_EDGE_MM = 0.2
MIN_STRETCH_STEP = 1e-4  # stretches that are nearer are one: a law is asked for with rounded numbers
AxisNodes = tuple[Number, ...]


@dataclass(frozen=True, order=True)
class CellTask:
    """One cell to solve; `held_out` ones test the law and are not used to make it."""

    stretch: float
    held_out: bool
    length_mm: float
    thickness_mm: float
    width_mm: float


class CampaignPlan(Section):
    """Which cells are solved.

    Attributes
    ----------
    kind : `grid` takes all combinations of the three lists; `halton` and `sobol` spread `count` cells over the ranges.
    stretches : one table of the law for each; the fabric's own stretch if left out.
    lengths_mm, thicknesses_mm, widths_mm : of the grid, increasing. Length 0, the bare fabric, is always there.
    length_range_mm, thickness_range_mm, width_range_mm : of `halton` and `sobol`, and count and seed.
    edge_mm : of the cells' mesh; that of the sheets the law is for.
    held_out : random cells per stretch within the ranges, to test the law with.
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
    held_out: Whole = Field(12, ge=0, le=10_000)

    @field_validator("stretches", "lengths_mm", "thicknesses_mm", "widths_mm")
    @classmethod
    def _increase(cls, values: AxisNodes | None) -> AxisNodes | None:
        if values is not None and any(b <= a for a, b in pairwise(values)):
            raise DesignError("", "must increase", list(values))
        return values

    @field_validator("stretches")
    @classmethod
    def _are_stretches(cls, values: AxisNodes | None) -> AxisNodes | None:
        values = _within(values, (1.0, 3.0))
        if values is not None and any(b - a < MIN_STRETCH_STEP * (1.0 - 1e-6) for a, b in pairwise(sorted(values))):
            raise DesignError("", f"must be at least {MIN_STRETCH_STEP:g} apart", list(values))
        return values

    @field_validator("lengths_mm", "length_range_mm")
    @classmethod
    def _are_lengths(cls, values: AxisNodes) -> AxisNodes:
        printed = [v for v in values if v != 0]
        if not all(v >= MIN_ARM_MM for v in printed):
            raise DesignError("", f"must be at least {MIN_ARM_MM:g}: shorter arms are not printed", list(values))
        if not printed:
            raise DesignError("", "must hold a length above 0: the bare fabric is always there", list(values))
        return values

    @field_validator("thicknesses_mm", "thickness_range_mm")
    @classmethod
    def _are_thicknesses(cls, values: AxisNodes) -> AxisNodes:
        return _within(values, THICKNESS_RANGE_MM) or ()

    @field_validator("widths_mm", "width_range_mm")
    @classmethod
    def _are_widths(cls, values: AxisNodes) -> AxisNodes:
        return _within(values, WIDTH_RANGE_MM) or ()

    @field_validator("length_range_mm", "thickness_range_mm", "width_range_mm")
    @classmethod
    def _from_low_to_high(cls, values: Point) -> Point:
        if not 0 < values[0] < values[1]:
            raise DesignError("", "must be [low, high] with 0 < low < high", list(values))
        return values

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        grid = {"lengths_mm", "thicknesses_mm", "widths_mm"}
        spread = {"length_range_mm", "thickness_range_mm", "width_range_mm", "count", "seed"}
        for key in sorted((spread - {"seed"} if self.kind == "grid" else grid) & self.model_fields_set):
            raise DesignError(key, f'does not go with kind = "{self.kind}"', getattr(self, key))
        if len(self.lengths_mm) * len(self.thicknesses_mm) * len(self.widths_mm) > MAX_SAMPLES:
            raise DesignError("", f"must have at most {MAX_SAMPLES} cells in its grid")
        return self

    @property
    def ranges(self) -> tuple[Point, Point, Point]:
        """Least and largest length (0 is the least), thickness and width."""
        if self.kind == "grid":
            h, w = self.thicknesses_mm, self.widths_mm
            return (0.0, self.lengths_mm[-1]), (h[0], h[-1]), (w[0], w[-1])
        return (0.0, self.length_range_mm[1]), self.thickness_range_mm, self.width_range_mm

    def sizes(self) -> list[tuple[float, float, float]]:
        """Length, thickness and width of the cells the law is made of, with arms."""
        if self.kind == "grid":
            axes = [v for v in self.lengths_mm if v > 0], self.thicknesses_mm, self.widths_mm
            return [(length, h, w) for length in axes[0] for h in axes[1] for w in axes[2]]
        from scipy.stats import qmc  # takes half a second, and only these plans need it

        engine = qmc.Halton if self.kind == "halton" else qmc.Sobol
        if self.kind == "sobol":  # its points are balanced in powers of two
            power = int(np.ceil(np.log2(self.count)))
            points = engine(3, seed=np.random.default_rng(self.seed)).random(2**power)[: self.count]
        else:
            points = engine(3, seed=np.random.default_rng(self.seed)).random(self.count)
        return _rows(points, (self.length_range_mm, self.thickness_range_mm, self.width_range_mm))

    def least_length_mm(self, spacing_mm: float) -> float:
        """The shortest arms that the law answers for; 0 if all are."""
        return min_length(self.lengths_mm if self.kind == "grid" else self.length_range_mm, spacing_mm)

    def tests(self, spacing_mm: float) -> list[tuple[float, float, float]]:
        """Length, thickness and width of the held-out cells, of the lengths that the law answers for."""
        (_, longest), *others = self.ranges
        low = max(min(max(MIN_ARM_MM, 1.5), longest), self.least_length_mm(spacing_mm))
        points = np.random.default_rng(self.seed + 1).random((self.held_out, 3))
        return _rows(points, ((low, longest), *others))


def _within(values: AxisNodes | None, limits: tuple[float, float]) -> AxisNodes | None:
    if values is not None and not all(limits[0] <= v <= limits[1] for v in values):
        raise DesignError("", f"must be from {limits[0]:g} to {limits[1]:g}", list(values))
    return values


def _rows(points: np.ndarray, ranges: tuple[Point, ...]) -> list[tuple[float, float, float]]:
    """Points of the unit cube (n, 3) spread over the ranges, to a thousandth so that files stay readable."""
    low, high = np.transpose(ranges)
    rows = np.clip(np.round(low + points * (high - low), 3), low, high)
    return [(float(a), float(b), float(c)) for a, b, c in rows]
