"""The law of a motif: rest metric, stiffnesses and rest curvature of its sheet by the sizes of its rods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.motif_plan import ROD_SIZE_KEYS, MotifPlan
from asterism.homogenize.law.motif_table import SIZE_TOLERANCE, MotifTable
from asterism.homogenize.law.tensor_forms import SheetTensors
from asterism.pattern.design.design import Design, leading_field
from asterism.pattern.design.sizing.profile import Profile


@dataclass(frozen=True)
class MotifValues:
    """The law at n places of a sheet.

    Attributes
    ----------
    metric : (n, 3) components 11, 22, 12 of the rest metric of the print.
    stiffness : (n, 6, 6) membrane (N/mm) and bending (N mm), Voigt, as of `fem.shell.density.Density`.
    curvature : (n, 3) rest curvature, components 11, 22, 12, 1/mm, as of `fem.shell.fields.Fields`.
    inside : (n,) False outside the range of the law. Values there are those of the nearest sizes in the range.
    outside : one line for each place outside the range.
    slopes : derivatives of the three by the A sizes: arrays with an axis of A after the first.
    """

    metric: Floats
    stiffness: Floats
    curvature: Floats
    inside: Bools
    outside: tuple[str, ...]
    slopes: SheetTensors


@dataclass(frozen=True)
class MotifLaw:
    """A table for one motif, lattice, material and stretch, and everything that produced it.

    Attributes
    ----------
    plan : what the law is for.
    table : the tensors.
    samples : all records of the campaign as plain data, in the order of the plan's tasks.
    residuals : errors of the law at its held-out cells, see `homogenize.law.motif_table`.
    made : versions, command, machine, seconds.
    """

    plan: MotifPlan
    table: MotifTable
    samples: Sequence[dict[str, Any]]
    residuals: dict[str, Any]
    made: dict[str, Any] = field(default_factory=dict)

    @property
    def edge_mm(self) -> float:
        """Edge length of the cells' mesh. Exact models that the law is compared with need the same edge length."""
        return self.plan.edge_mm

    def check(self, design: Design) -> None:
        """Compare a design with the law. Sizes that vary over the sheet are left to `evaluate_at`.

        Raises
        ------
        ForeignLaw
            The law is for another material, stretch, lattice or motif, or for other sizes.
        LawError
            Designs of this kind have no law, or the cell of the design's motif has none.
        """
        self.plan.check(design)
        fields = self.plan.sources(design)
        if any(isinstance(each, Profile) for each in fields):
            return
        values = self.evaluate_at(design, np.zeros((1, 2)))
        if not values.inside[0]:
            raise LawError(values.outside[0], field=leading_field(values.outside[0]))

    def evaluate(self, design: Design, thickness_mm: ArrayLike, width_mm: ArrayLike) -> MotifValues:
        """The law at places where all rods have these sizes. Lines with sizes of their own keep those.

        Parameters
        ----------
        thickness_mm, width_mm : (n,), or a number for both.

        Returns
        -------
        The values; `slopes` are by thickness and width, A = 2.

        Raises
        ------
        LawError
            As of `MotifPlan.check`, or several groups of lines have thicknesses or widths of their own: use
            `evaluate_at`.
        """
        given = np.stack(np.broadcast_arrays(*(np.atleast_1d(np.asarray(v, float)) for v in (thickness_mm, width_mm))))
        keys = [size.key for size in self.plan.sizes]
        if len(set(keys)) < len(keys):
            raise LawError("the law has several thicknesses or widths: evaluate_at takes them from the design")
        columns = [ROD_SIZE_KEYS.index(key) for key in keys]
        values = self._at(design, given[columns].T)

        def by_both(slope: Floats) -> Floats:
            out = np.zeros((len(slope), 2, *slope.shape[2:]))
            out[:, columns] = slope
            return out

        slopes = values.slopes
        both = SheetTensors(by_both(slopes.metric), by_both(slopes.stiffness), by_both(slopes.curvature))
        return MotifValues(values.metric, values.stiffness, values.curvature, values.inside, values.outside, both)

    def evaluate_at(self, design: Design, points: Floats) -> MotifValues:
        """The law at printed points (n, 2) mm, with the sizes that the design's rods have there.

        Returns
        -------
        The values; `slopes` are by the sizes of the plan.

        Raises
        ------
        LawError
            As of `MotifPlan.check`.
        """
        return self._at(design, self.plan.sizes_at(design, points))

    def _at(self, design: Design, sizes: Floats) -> MotifValues:
        """The law at sizes (n, A), with stiffnesses for the modulus of the design's fabric."""
        self.plan.check(design)
        tensors, slopes, inside = self.table(sizes)
        scale = design.fabric.modulus_mpa / self.plan.design.fabric.modulus_mpa
        slopes = SheetTensors(slopes.metric, scale * slopes.stiffness, slopes.curvature)
        outside = tuple(self._why_outside(sizes[place]) for place in np.flatnonzero(~inside))
        return MotifValues(tensors.metric, scale * tensors.stiffness, tensors.curvature, inside, outside, slopes)

    def _why_outside(self, sizes: Floats) -> str:
        """One line about sizes (A,) without a law; it begins with the field of a design."""
        for size, value in zip(self.plan.sizes, sizes, strict=True):
            low, high = size.nodes[0], size.nodes[-1]
            if not low * (1 - SIZE_TOLERANCE) <= value <= high * (1 + SIZE_TOLERANCE):
                covered = f"{low:g}" if low == high else f"{low:g} to {high:g}"
                return f"rods.{size.key} = {value:g}: is outside the law's {covered}"
        problems = [each for each in self.samples if each["problem"] is not None and not each["held_out"]]
        if not problems:
            return "rods.motif: no cell was solved"
        known = np.log([each["sizes"] for each in problems]).reshape(len(problems), -1)
        nearest = problems[int(np.argmin(np.linalg.norm(known - np.log(sizes), axis=1)))]
        place = ", ".join(
            f"{size.key} = {value:g}" for size, value in zip(self.plan.sizes, nearest["sizes"], strict=True)
        )
        return problem_of_motif(nearest["problem"]) + (f" ({place})" if place else "")


def problem_of_motif(problem: str) -> str:
    """The problem of a cell after the field that it is about: its own, or that of the motif.

    Examples
    --------
    >>> problem_of_motif("the motif has no law of one cell")
    'rods.motif: the motif has no law of one cell'
    >>> problem_of_motif("rods: motif[0] has a piece of 0.50 mm at [1.00, 0.00]: 1 or more")
    'rods: motif[0] has a piece of 0.50 mm at [1.00, 0.00]: 1 or more'
    """
    return problem if leading_field(problem) else f"rods.motif: {problem}"
