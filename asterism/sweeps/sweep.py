"""The result of a sweep: designs, numbers and small pictures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import with_entries
from asterism.process.version import __version__
from asterism.results.records.sweep import SweepColumnRecord, SweepParameterRecord, SweepRecord, SweepRowRecord
from asterism.sweeps.parameters import SweepError, SweepParameter
from asterism.sweeps.quantities import quantities
from asterism.sweeps.solve_point import SmallPicture


@dataclass(frozen=True)
class SweepPoint:
    """One design of a sweep.

    Attributes
    ----------
    number : from 1.
    parameters : values of the parameters by path.
    values : values of the table's columns by name; None without a shape.
    picture : small picture of the shape; None without a shape.
    problem : why the design has no shape; None if it has one.
    """

    number: int
    parameters: Mapping[str, Any]
    values: Mapping[str, Any] | None
    picture: SmallPicture | None
    problem: str | None


@dataclass(frozen=True)
class Sweep:
    """The result of `asterism.sweep`.

    Attributes
    ----------
    design : the design that was varied.
    parameters : what was varied.
    points : all designs in the order of their numbers.
    exact : the exact model computed the shapes, not the preview.
    seed : seed of the Latin hypercube; None for all combinations.
    law : digest of the law that was given; None for that of the design, or else the paper's.
    """

    design: Design
    parameters: tuple[SweepParameter, ...]
    points: tuple[SweepPoint, ...]
    exact: bool
    seed: int | None = None
    law: str | None = None

    @property
    def failed(self) -> int:
        """Number of designs without a shape."""
        return sum(point.problem is not None for point in self.points)

    @property
    def doubts(self) -> list[str]:
        """Why the table is not reliable, each reason once."""
        without = sum(point.values is not None and not point.values["is_minimum"] for point in self.points)
        doubtful = sum(point.values is not None and point.values["not_reliable"] is not None for point in self.points)
        counts = {"have no shape": self.failed, "have no certified shape": without, "are not reliable": doubtful}
        return [f"{count} of {len(self.points)} designs {what}" for what, count in counts.items() if count]

    def column(self, name: str) -> Floats:
        """(n,) values of a parameter or a column, one for each design; not a number where there is none.

        Raises
        ------
        SweepError
            There is no such column, or its values are texts.
        """
        names = [each.path for each in self.parameters] + [each.name for each in quantities(self.exact)]
        if name not in names:
            raise SweepError(f"{name}: no column of this sweep; there are {', '.join(names)}")
        given = [{**(point.values or {}), **point.parameters}.get(name) for point in self.points]
        try:
            return np.array([np.nan if value is None else value for value in given], dtype=float)
        except (TypeError, ValueError):
            raise SweepError(f"{name}: has values that are not numbers") from None

    def design_of(self, number: int) -> Design:
        """The design with this number, for `save_design`, `preview` or `simulate`.

        Raises
        ------
        SweepError
            There is no such number.
        DesignError
            The design is the reason of its failure.
        """
        if not 1 <= number <= len(self.points):
            raise SweepError(f"{number}: the designs of this sweep have numbers from 1 to {len(self.points)}")
        return Design.from_dict(with_entries(self.design.to_dict(), self.points[number - 1].parameters))

    @property
    def summary(self) -> SweepRecord:
        """The content of summary.json."""
        return SweepRecord(
            model=SweepRecord.model_name,
            by="exact" if self.exact else "preview",
            sampling="grid" if self.seed is None else "latin hypercube",
            seed=self.seed,
            parameters=[
                SweepParameterRecord(
                    path=each.path,
                    listed=list(each.values),
                    limits=None if each.limits is None else list(each.limits),
                )
                for each in self.parameters
            ],
            columns=[
                SweepColumnRecord(name=each.name, unit=each.unit, label=each.label) for each in quantities(self.exact)
            ],
            table_rows=[
                SweepRowRecord(
                    number=point.number,
                    parameters=dict(point.parameters),
                    results=None if point.values is None else dict(point.values),
                    problem=point.problem,
                )
                for point in self.points
            ],
            law=self.law,
            version=__version__,
            design=self.design.to_dict(),
        )
