"""The law: the homogenised constitutive law of a pattern, as smooth functions of its sizes.

A law belongs to one material, one lattice and one edge length of the mesh, and to stars (`star_law`) or to one motif of
drawn rods (`motif_law`). It has one table for each stretch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

import numpy as np

from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.plan import LawPlan, Stretch, stretch_text
from asterism.homogenize.law.same_material import same_values
from asterism.homogenize.law.table import LawTable
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout

Table = TypeVar("Table", bound=LawTable)


@dataclass(frozen=True)
class Law(Generic[Table]):
    """Tables for one material and pattern, and everything that produced them.

    Attributes
    ----------
    plan : what the law is for, and its cells.
    tables : one for each stretch.
    samples : all records of the campaign as plain data, in the order of the plan.
    residuals : errors of the law, see `homogenize.law.residuals`.
    made : versions, command, machine, seconds.
    """

    plan: LawPlan
    tables: tuple[Table, ...]
    samples: Sequence[dict[str, Any]]
    residuals: dict[str, Any]
    made: dict[str, Any] = field(default_factory=dict)

    @property
    def edge_mm(self) -> float:
        """Edge length of the cells' mesh, mm."""
        return self.plan.edge_mm

    @property
    def stretches(self) -> tuple[Stretch, ...]:
        """The stretches of the tables."""
        return tuple(table.stretch for table in self.tables)

    def at(self, stretch: Stretch) -> Table:
        """The table of a stretch.

        Raises
        ------
        ForeignLaw
            The law has no table for this stretch.
        """
        asked = np.broadcast_to(stretch, 2).tolist()
        for table in self.tables:
            if same_values(np.broadcast_to(table.stretch, 2).tolist(), asked):
                return table
        known = ", ".join(map(stretch_text, self.stretches))
        raise ForeignLaw(
            f"fabric.stretch = {stretch_text(stretch)}: the law was made for {known}", field="fabric.stretch"
        )

    def size_ranges(self, stretch: Stretch) -> dict[str, tuple[float, float]]:
        """Smallest and largest size in mm that the table of a stretch covers, by the keys of design files.

        Raises
        ------
        ForeignLaw
            The law has no table for this stretch.

        Examples
        --------
        >>> from asterism.homogenize.law.law_file import load_law
        >>> load_law().size_ranges(1.35)["width_mm"]
        (0.8, 1.6)
        """
        return self.at(stretch).size_ranges

    def check(self, design: Design) -> Table:
        """The table for a design.

        Moduli and densities may differ from the law's: without gravity, shapes depend on the ratio of the moduli only.
        `evaluate` scales the stiffnesses.

        Raises
        ------
        ForeignLaw
            The law is for another material, pattern, lattice or stretch; the message names the difference.
        LawError
            Designs of this kind have no law.
        """
        self.plan.check(design)
        return self.at(design.fabric.stretch_xy)

    def covers(self, design: Design, layout: Layout) -> bool:
        """Whether the law is for a design and covers all sizes that occur on its sheet."""
        try:
            table = self.check(design)
            return bool(table.inside(self.plan.sizes_on(design, layout)).all())
        except LawError:
            return False

    def modulus_ratio(self, design: Design) -> float:
        """Modulus of a design's fabric over that of the cells, to which stiffnesses are proportional."""
        return design.fabric.modulus_mpa / self.plan.design.fabric.modulus_mpa
