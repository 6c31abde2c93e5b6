"""What a sweep costs, estimated before anything is computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from asterism.equilibrium.errors import Error
from asterism.exact.cost import Cost, exact_cost
from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import with_entries
from asterism.pattern.layout.build import layout
from asterism.sweeps.parameters import SweepParameter

# processor time of a preview with its picture, and memory of its process: all stars of the gallery with three
# thicknesses each (0.06 s to 0.3 s of 37 stars, 0.3 s to 1.6 s of 85 to 127)
PREVIEW_S = 0.05
PREVIEW_S_A_STAR = 0.004
# processor time of a preview of a motif without its cells (0.26 s to 1.1 s), and of one cell with edges of 2 mm (the
# four motifs of asterism new: 0.5 s to 1.6 s in motif_responses)
MOTIF_PREVIEW_S = 0.6
MOTIF_CELL_S = 0.9
# a process imports its libraries
START_S = 3.0


@dataclass(frozen=True)
class SweepCost(Cost):
    """An estimate for so many designs; `vertices` of the largest exact shape, 0 for previews."""

    designs: int
    cheaper: ClassVar[str] = "fewer designs"

    def in_words(self) -> str:
        """One phrase.

        >>> SweepCost(0, 700.0, 11.0, 60).in_words(), SweepCost(4000, 800.0, 600.0, 60).in_words()
        ('60 previews, 0.7 GB, 11 s', '60 exact shapes of up to 4000 vertices, 0.8 GB, 10 min')
        """
        what = f"exact shapes of up to {self.vertices} vertices" if self.vertices else "previews"
        return f"{self.designs} {what}, {self.memory_mb / 1000:.1f} GB, {self.time_in_words}"


def sweep_cost(
    design: Design,
    parameters: Sequence[SweepParameter],
    count: int,
    exact: bool,
    processes: int,
    law_is_given: bool = False,
) -> SweepCost:
    """The cost of so many designs on so many processes; of exact shapes by the largest at the ends of parameters."""
    processes = min(processes, count)
    if not exact:
        each = PREVIEW_S + PREVIEW_S_A_STAR * _stars(design) if design.rods is None else MOTIF_PREVIEW_S
        # sheets on supports may buckle, and are searched for further forms
        each *= 2.0 if design.pins else 1.0
        if design.rods is not None and not law_is_given and design.law_file is None:
            # the preview solves the cells of its motif
            each += MOTIF_CELL_S * _motif_cells(design)
        return SweepCost(0, 350.0 * processes, START_S + each * count / processes, count)
    largest = max(map(exact_cost, _ends(design, parameters)), key=lambda cost: cost.seconds)
    seconds = START_S + largest.seconds * count / processes
    return SweepCost(largest.vertices, largest.memory_mb * processes, seconds, count)


def _stars(design: Design) -> int:
    """Number of stars; 0 if the design that is varied cannot be laid out itself."""
    try:
        return len(layout(design).centres)
    except Error:
        return 0


def _motif_cells(design: Design) -> int:
    """Number of cells of a preview's law; 1 if the design that is varied has no law itself."""
    from asterism.homogenize.campaign.design_plan import plan_for_design  # it loads the exact model

    try:
        plan, sheet = plan_for_design(design), layout(design)
        return len(plan.tasks_for_sizes(plan.sizes_on(design, sheet)))
    except Error:
        return 1


def _ends(design: Design, parameters: Sequence[SweepParameter]) -> list[Design]:
    """The design, and variants with the first or the last value of one parameter, as far as they are possible."""
    table, ends = design.to_dict(), [design]
    for parameter in parameters:
        values: Sequence[Any] = parameter.limits or parameter.values
        for value in (values[0], values[-1]):
            try:
                one = Design.from_dict(with_entries(table, {parameter.path: value}))
                exact_cost(one)
            except Error:
                continue
            ends.append(one)
    return ends
