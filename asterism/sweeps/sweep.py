"""The result of a sweep: designs, numbers and small pictures."""

from __future__ import annotations

from dataclasses import dataclass

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
class Sweep:
    """The result of `asterism.sweep`.

    Attributes
    ----------
    design : the design that was varied.
    parameters : what was varied.
    points : all designs in the order of their numbers: `number`, values of the `parameters` by path, values of the
        table's columns as `results`, and why a design has none, its `problem`.
    pictures : small pictures of their shapes; None without a shape.
    exact : the exact model computed the shapes, not the preview.
    seed : seed of the Latin hypercube; None for all combinations.
    law : digest of the law that was given; None for that of the design, or else the paper's.
    """

    design: Design
    parameters: tuple[SweepParameter, ...]
    points: tuple[SweepRowRecord, ...]
    pictures: tuple[SmallPicture | None, ...]
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
        shapes = [point.results for point in self.points if point.results is not None]
        without = sum(not results["is_minimum"] for results in shapes)
        doubtful = sum(results["not_reliable"] is not None for results in shapes)
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
        given = [{**(point.results or {}), **point.parameters}.get(name) for point in self.points]
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
            table_rows=list(self.points),
            law=self.law,
            version=__version__,
            design=self.design.to_dict(),
        )
