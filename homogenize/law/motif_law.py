"""The law of a motif: rest metric, stiffnesses and rest curvature of its sheet by the sizes of its rods."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import CellErrors, Law, LawTable
from asterism.homogenize.law.plan import LawPlan
from asterism.homogenize.law.tensor_forms import STORED_SIZE, SheetTensors, plane_matrix, tensors_of_stored
from asterism.pattern.design.design import Design, leading_field
from asterism.pattern.design.sizing.profiles import Profile

# errors in percent: of the length of the flat sheet, of energies, and of the largest curvature
MOTIF_QUANTITIES = ("stretch", "membrane", "bending", "curvature")


@dataclass(frozen=True)
class MotifValues(SheetTensors):
    """The law at n places of a sheet: its tensors, as `fem.shell.density.Density` and `fem.shell.fields.Fields` take
    them.
    """

    inside: Bools  # (n,) False outside the range of the law. Values there are those of the nearest sizes in the range.
    outside: tuple[str, ...] = ()  # one line for each place outside the range


@dataclass(frozen=True, eq=False)
class MotifTable(LawTable):
    """The law of a motif at one stretch.

    The stored forms (`homogenize.law.tensor_forms`) are cubic splines over the logarithms of the sizes. These are
    linear in the answers of the cells, and so the law of a turned motif is the turned law. A cell without a law has the
    forms of its own answer.
    """

    error_names = MOTIF_QUANTITIES

    @staticmethod
    def columns(plan: LawPlan) -> int:
        return STORED_SIZE

    def __call__(self, sizes: Floats) -> MotifValues:
        """The law at sizes (n, A) mm."""
        tensors = tensors_of_stored(self.interpolated(sizes, slice(0, STORED_SIZE), ["spline"] * STORED_SIZE))
        return MotifValues(tensors.metric, tensors.stiffness, tensors.curvature, self.inside(sizes))

    def errors(self, sizes: Floats, stored: Floats) -> CellErrors:
        values = self(sizes)
        percent = tensor_errors(values, tensors_of_stored(stored))
        return CellErrors(percent, values.inside, np.zeros(len(sizes), bool), {}, {})


@dataclass(frozen=True)
class MotifLaw(Law[MotifTable]):
    """The law of one motif, lattice and material."""

    def check(self, design: Design) -> MotifTable:
        """As of `Law.check`; also for a motif of equal rods, whose cell must have a law. Sizes that vary over the sheet
        are left to `evaluate_at`."""
        table = super().check(design)
        if not any(isinstance(each, Profile) for each in self.plan.sources(design)):
            values = self._at(table, design, self.plan.sizes_at(design, np.zeros((1, 2))))
            if not values.inside[0]:
                raise LawError(values.outside[0], field=leading_field(values.outside[0]))
        return table

    def evaluate(self, design: Design, *sizes: ArrayLike) -> MotifValues:
        """The law at these sizes, with stiffnesses for the modulus of the design's fabric.

        Raises `LawError` as `Law.check` does.

        `sizes`: mm, in the order of `plan.sizes`, each (n,) or a number.
        """
        table = super().check(design)
        return self._at(table, design, table.rows(sizes))

    def evaluate_at(self, design: Design, points: Floats) -> MotifValues:
        """The law at printed points (n, 2) mm, with the sizes that the design's rods have there.

        Raises `LawError` as `Law.check` does.
        """
        return self._at(super().check(design), design, self.plan.sizes_at(design, points))

    def _at(self, table: MotifTable, design: Design, sizes: Floats) -> MotifValues:
        values, scale = table(sizes), self.modulus_ratio(design)
        outside = tuple(self._why_outside(table, sizes[place]) for place in np.flatnonzero(~values.inside))
        return replace(values, stiffness=scale * values.stiffness, outside=outside)

    def _why_outside(self, table: MotifTable, sizes: Floats) -> str:
        """One line about sizes (A,) without a law; it begins with the field of a design."""
        if (beyond := table.beyond(sizes)) is not None:
            name, size, covered = beyond
            return f"rods.{name.partition('_of_')[0]} = {size:g}: is outside the law's {covered}"
        problems = [each for each in self.samples if each["problem"] is not None and not each["held_out"]]
        if not problems:
            return "rods.motif: no cell was solved"
        rows = [[each[name] for name in self.plan.names] for each in problems]
        known = np.log(rows).reshape(len(problems), -1)
        nearest = int(np.argmin(np.linalg.norm(known - np.log(sizes), axis=1)))
        place = ", ".join(f"{size.key} = {x:g}" for size, x in zip(self.plan.sizes, rows[nearest], strict=True))
        return problem_of_motif(problems[nearest]["problem"]) + (f" ({place})" if place else "")


def problem_of_motif(problem: str) -> str:
    """The problem of a cell after the field that it is about: its own, or that of the motif.

    >>> problem_of_motif("the motif has no law of one cell")
    'rods.motif: the motif has no law of one cell'
    >>> problem_of_motif("rods: motif[0] has a piece of 0.50 mm at [1.00, 0.00]: 1 or more")
    'rods: motif[0] has a piece of 0.50 mm at [1.00, 0.00]: 1 or more'
    """
    return problem if leading_field(problem) else f"rods.motif: {problem}"


def tensor_errors(law: SheetTensors, cell: SheetTensors) -> Floats:
    """(n, 4) errors in percent of `MOTIF_QUANTITIES`, the same in all axes.

    - stretch: the largest error of the length of a line on the flat sheet;
    - membrane, bending: the largest error of the energy of a strain or curvature, over that energy;
    - curvature: the norm of the error of the rest curvature over the norm of the rest curvature.

    >>> cell = SheetTensors(np.array([[0.81, 0.64, 0.0]]), np.eye(6)[None], np.array([[-0.01, 0.0, 0.0]]))
    >>> law = SheetTensors(1.02 * cell.metric, 1.01 * cell.stiffness, 0.99 * cell.curvature)
    >>> tensor_errors(law, cell).round(2)
    array([[1., 1., 1., 1.]])
    """
    metric, known = (plane_matrix(each.metric) for each in (law, cell))
    errors = [np.abs(np.sqrt(_ratios(metric, known)) - 1.0).max(axis=-1)]
    for part in (slice(0, 3), slice(3, 6)):
        errors.append(np.abs(_ratios(law.stiffness[:, part, part], cell.stiffness[:, part, part]) - 1.0).max(axis=-1))
    apart, size = (
        np.linalg.norm(plane_matrix(each), axis=(1, 2)) for each in (law.curvature - cell.curvature, cell.curvature)
    )
    errors.append(apart / np.maximum(size, 1e-9))  # 1/mm, of a sheet that does not curl
    return 100.0 * np.stack(errors, axis=-1)


def _ratios(ours: Floats, known: Floats) -> Floats:
    """(n, k) stationary ratios of two quadratic forms (n, k, k)."""
    root = np.linalg.inv(np.linalg.cholesky(known))
    return np.asarray(np.linalg.eigvalsh(root @ ours @ np.swapaxes(root, -1, -2)))
