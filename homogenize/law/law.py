"""The law: the homogenised constitutive law of a pattern, as smooth functions of its sizes.

A law belongs to one material, one lattice and one edge length of the mesh, and to stars (`star_law`) or to one motif of
drawn rods (`motif_law`). It has one table for each stretch: stored forms of its cells on a grid of sizes. A table never
extrapolates: outside its range, and next to cells without an answer, it marks its values.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.hermite_grid import HermiteGrid, SlopeRule
from asterism.homogenize.law.plan import LawPlan, Stretch, min_length, same_values, stretch_text
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout

# relative, of a size beyond the range of the law: rounding
SIZE_TOLERANCE = 1e-6


@dataclass(frozen=True)
class CellErrors:
    """How far a table is from n cells."""

    percent: Floats  # (n, E) errors, in percent, of the quantities `LawTable.error_names`
    inside: Bools  # (n,) inside the range of the law
    tight: Bools  # (n,) not scale-separated: the stated accuracy of the law ends there
    # law, cell: (n,) for each of the law's quantities, if they are numbers.
    law: dict[str, Floats]
    cell: dict[str, Floats]


@dataclass(frozen=True, eq=False)
class LawTable(ABC):
    """The law at one stretch, as a function of the A sizes of its plan."""

    plan: LawPlan  # of the law
    stretch: Stretch  # of the fabric
    # (n1, ..., nA, K) interpolated forms. A cell without an answer has those that follow from other cells.
    stored: Floats
    # (n1, ..., nA) False if the cell has no law, or was not solved. Between two answers on a line of lengths the law is
    # an interpolation on a coarser grid; elsewhere such a node lies outside its range.
    solved: Bools
    # what the errors at held-out cells are of
    error_names: ClassVar[tuple[str, ...]]

    @staticmethod
    @abstractmethod
    def columns(plan: LawPlan) -> int:
        """K, the number of stored forms of a cell."""

    @abstractmethod
    def errors(self, sizes: Floats, stored: Floats) -> CellErrors:
        """Errors of the table at cells of sizes (n, A) with stored forms (n, K)."""

    @property
    def size_ranges(self) -> dict[str, tuple[float, float]]:
        """Smallest and largest size in mm that the table covers, by the names of its sizes.

        Shorter arms than the shortest are covered too if the bare fabric is near, see `homogenize.law.plan.min_length`.
        """
        return {name: (float(a), float(b)) for name, (a, b) in zip(self.plan.names, self.plan.limits.T, strict=True)}

    def rows(self, sizes: Sequence[ArrayLike]) -> Floats:
        """(N, A) of A sizes, each (N,) or a number."""
        if len(sizes) != len(self.plan.names):
            raise TypeError(f"sizes: {len(sizes)} given, the law has {', '.join(self.plan.names)}")
        arrays = np.broadcast_arrays(*(np.atleast_1d(np.asarray(size, float)) for size in sizes))
        return np.column_stack([array.ravel() for array in arrays])

    def inside(self, sizes: Floats) -> Bools:
        """(N,) whether the law covers sizes (N, A)."""
        is_known = self._grid(slice(0, 0), ()).is_known(self._places(self._clipped(sizes)), self._known)
        return np.asarray(self._within(sizes).all(axis=1) & (is_known | self._is_bare(sizes)))

    def interpolated(self, sizes: Floats, block: slice, rules: Sequence[SlopeRule]) -> Floats:
        """Stored forms (N, k) of a block of columns at sizes (N, A).

        Outside the range they are those of the nearest sizes in it. Between the bare fabric and the shortest arms of a
        law that begins far from it, they are those of the curve that joins both.
        """
        return self._grid(block, rules)(self._places(self._clipped(sizes)))

    def beyond(self, sizes: Floats) -> tuple[str, float, str] | None:
        """Name and value of the first of sizes (A,) outside the range, and the range in words; None inside."""
        within = self._within(sizes[None])[0]
        for name, size, (low, high), fine in zip(self.plan.names, sizes, self.plan.limits.T, within, strict=True):
            if not fine:
                return name, float(size), f"{low:g}" if low == high else f"{low:g} to {high:g}"
        return None

    def _within(self, sizes: Floats) -> Bools:
        """(N, A) whether sizes are in the range; bare fabric has neither thickness nor width."""
        low, high = self.plan.limits
        within = (sizes >= low * (1.0 - SIZE_TOLERANCE)) & (sizes <= high * (1.0 + SIZE_TOLERANCE))
        return np.asarray(within | self._is_bare(sizes)[:, None])

    def _is_bare(self, sizes: Floats) -> Bools:
        """(N,) whether stars have no arms."""
        return np.zeros(len(sizes), bool) if self.plan.is_motif else np.asarray(sizes[:, 0] == 0.0)

    def _clipped(self, sizes: Floats) -> Floats:
        low, high = ([nodes[end] for nodes in self.plan.axis_nodes] for end in (0, -1))
        return np.clip(np.nan_to_num(sizes, nan=0.0), low, high)

    def _places(self, sizes: Floats) -> Floats:
        """(N, A) coordinates of sizes (N, A) on the grid; a law without sizes has one axis of one node."""
        columns = [size.axis.coordinate(column) for size, column in zip(self.plan.sizes, sizes.T, strict=True)]
        return np.column_stack(columns or [np.zeros(len(sizes))])

    @cached_property
    def _known(self) -> Bools:
        """Nodes with an answer, or between two answers on their line of lengths; bare fabric is one of near ones."""
        known = self.solved.copy()
        if not self.plan.is_motif:
            answers, lengths = self.solved.copy(), self.plan.axis_nodes[0]
            answers[0] &= min_length(lengths[2:], self.plan.design.lattice.spacing_mm) == 0.0
            known[1:-1] |= answers[:-2] & self.solved[2:]
        return known if known.ndim else known[None]

    @cached_property
    def _grids(self) -> dict[tuple[int, int], HermiteGrid]:
        return {}

    def _grid(self, block: slice, rules: Sequence[SlopeRule]) -> HermiteGrid:
        """The grid of a block of columns, made when it is first used."""
        key = block.start, block.stop
        if key not in self._grids:
            pairs = zip(self.plan.sizes, self.plan.axis_nodes, strict=True)
            nodes = [size.axis.coordinate(each) for size, each in pairs]
            values = self.stored[..., block] if nodes else self.stored[None, block]
            self._grids[key] = HermiteGrid(nodes or [np.zeros(1)], values, rules)
        return self._grids[key]


Table = TypeVar("Table", bound=LawTable)


@dataclass(frozen=True)
class Law(Generic[Table]):
    """Tables for one material and pattern, and everything that produced them."""

    plan: LawPlan  # what the law is for, and its cells
    tables: tuple[Table, ...]  # one for each stretch
    samples: Sequence[dict[str, Any]]  # all records of the campaign as plain data, in the order of the plan
    residuals: dict[str, Any]  # errors of the law, see `homogenize.campaign.fit_law`
    made: dict[str, Any] = field(default_factory=dict)  # versions, command, machine, seconds

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
        return design.fabric.modulus / self.plan.design.fabric.modulus
