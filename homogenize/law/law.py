"""The law: the homogenised constitutive law of the star pattern, as smooth functions of the star's sizes.

A law belongs to one material, one lattice and one edge length of the mesh. It has one table (`law_table`) for each
stretch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.axes import AXES, coordinates
from asterism.homogenize.law.law_table import QUANTITIES, LawTable, LawValues
from asterism.homogenize.law.material import Material
from asterism.homogenize.law.same_material import (
    FREE_KEYS,
    LATTICE_TOLERANCE,
    MATERIAL_TOLERANCE,
    check_bending,
    check_same,
    same_sites,
    same_values,
)
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import Lattice

# without bending, bare fabric has no stiffness or no equilibrium, and the natural curvature of the paper's star jumps
# between 0.027 and 0.079 per mm for mesh edges from 3.5 to 0.8 mm
WITHOUT_BENDING = (
    "has no law: bare fabric without bending stiffness makes unit cells depend on their mesh; "
    "use the exact model: asterism simulate"
)
WITH_TWO_STRETCHES = "a law is for equal stretch in x and y; use the exact model: asterism simulate"


@dataclass(frozen=True)
class Law:
    """Tables for one material, and everything that produced them.

    Attributes
    ----------
    material : fabric, plastic, lattice and plan.
    tables : one for each stretch.
    samples : all records of the campaign as plain data, in the order of the plan.
    residuals : errors of the law, see `law_residuals`.
    made : versions, command, machine, seconds.
    statement : how accurate a law without cells of its own material is, in one sentence; None for other laws.
    """

    material: Material
    tables: tuple[LawTable, ...]
    samples: Sequence[dict[str, Any]]
    residuals: dict[str, Any]
    made: dict[str, Any] = field(default_factory=dict)
    statement: str | None = None

    @property
    def edge_mm(self) -> float:
        """Edge length of the cells' mesh."""
        return self.material.plan.edge_mm

    @cached_property
    def waves(self) -> CorrugationWaves:
        """The waves whose amplitudes `LawTable.corrugation` gives."""
        return CorrugationWaves.of(self.material.lattice)

    def cell_stability(self, stretch: float) -> CellStabilityTable:
        """The stability of the cells at the stretch of a table. The first call unpacks the samples.

        Raises
        ------
        ForeignLaw
            The law has no table for this stretch.
        """
        stretch = self.at(stretch).stretch
        if stretch not in self._cell_stability:
            self._cell_stability[stretch] = CellStabilityTable.of(self.samples, stretch)
        return self._cell_stability[stretch]

    @cached_property
    def _cell_stability(self) -> dict[float, CellStabilityTable]:
        return {}

    def at(self, stretch: float) -> LawTable:
        """The table of a stretch.

        Raises
        ------
        ForeignLaw
            The law has no table for this stretch.
        """
        for table in self.tables:
            if same_values(table.stretch, stretch):
                return table
        problem = f"fabric.stretch = {stretch:g}: the law was made for {_list(self.stretches)}"
        raise ForeignLaw(problem, field="fabric.stretch")

    @property
    def stretches(self) -> tuple[float, ...]:
        """The stretches of the tables."""
        return tuple(table.stretch for table in self.tables)

    def size_ranges(self, stretch: float) -> dict[str, tuple[float, float]]:
        """Smallest and largest size in mm that the table of a stretch covers, by the keys of design files.

        Shorter arms than the shortest are covered too if the bare fabric is near, see `homogenize.law.axes`.

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

    def check(self, design: Design) -> LawTable:
        """The table for a design.

        Moduli and densities may differ from the law's: without gravity, shapes depend on the ratio of the moduli only.
        `evaluate` scales the stiffnesses.

        Raises
        ------
        ForeignLaw
            The law is for another material, lattice or stretch; the message names the difference.
        LawError
            Fabrics of this kind have no law.
        """
        if not design.fabric.has_bending:
            raise LawError(f"fabric.bending = {design.fabric.bending}: {WITHOUT_BENDING}", field="fabric.bending")
        sx, sy = design.fabric.stretch_xy
        if not same_values(sx, sy):
            raise LawError(f"fabric.stretch = {[sx, sy]}: {WITH_TWO_STRETCHES}", field="fabric.stretch")
        for section, free in FREE_KEYS.items():
            ours, theirs = (getattr(thing, section).model_dump(mode="json") for thing in (self.material, design))
            check_same(section, ours, theirs, MATERIAL_TOLERANCE, free)
        check_same(
            "lattice", _lattice(self.material.lattice, design.lattice), _lattice(design.lattice), LATTICE_TOLERANCE
        )
        check_bending(self.material.fabric, design.fabric)
        return self.at(sx)

    def corrugation(self, design: Design, *sizes: ArrayLike) -> Floats:
        """(N, 2, W) `LawTable.corrugation` for the stars of a design, which may be turned by half a turn."""
        parts = self.check(design).corrugation(*sizes)
        arms = design.lattice.arms
        turned = (design.lattice.orientation_deg - self.material.lattice.orientation_deg) * arms / 180.0
        return np.where(self.waves.odd, -parts, parts) if arms % 2 and round(turned) % 2 else parts

    def anisotropy(self, design: Design, *sizes: ArrayLike) -> Floats:
        """(N, K) `LawTable.anisotropy` for the stars of a design; half a turn does not change it."""
        return self.check(design).anisotropy(*sizes)

    def evaluate(self, design: Design, *sizes: ArrayLike) -> LawValues:
        """The law at stars of these sizes, with stiffnesses for the modulus of the design's fabric.

        Parameters
        ----------
        sizes : see `LawTable.__call__`.

        Raises
        ------
        LawError
            See `check`.

        Examples
        --------
        >>> from asterism.homogenize.law.law_file import load_law
        >>> from asterism.pattern.design.design import Design
        >>> design = Design.from_dict({"stars": {"length_mm": 9.0}, "border": {"rings": 1}})
        >>> found = load_law().evaluate(design, 9.0, 0.42, 1.2)
        >>> found.value["bending"].round(3), bool(found.inside[0])  # N mm
        (array([3.138]), True)
        """
        values = self.check(design)(*sizes)
        scale = design.fabric.modulus_mpa / self.material.fabric.modulus_mpa
        if scale == 1.0:
            return values
        factor = {name: scale if quantity.per_modulus else 1.0 for name, quantity in QUANTITIES.items()}
        return LawValues(
            {name: value * factor[name] for name, value in values.value.items()},
            {name: slope * factor[name] for name, slope in values.slope.items()},
            values.inside,
            values.outside,
            values.not_scale_separated,
        )


def _lattice(lattice: Lattice, like: Lattice | None = None) -> dict[str, Any]:
    """The data of a lattice that shape its cells, or those of another one (`like`) where its sites are the same.

    The origin is left out, and the orientation is reduced by the symmetry of star and lattice. A lattice repeats after
    half a turn: stars that are turned by it make the same sheet.
    """
    turn = (lattice.orientation_deg + 1e-7) % (360 / lattice.arms / (1 + lattice.arms % 2)) - 1e-7
    sites = (like if like is not None and same_sites(lattice, like) else lattice).model_dump(mode="json")
    return {
        "arms": lattice.arms,
        "kind": sites["kind"],
        "spacing_mm": sites["spacing_mm"],
        "vectors_mm": sites["vectors_mm"],
        "orientation_deg": round(turn, 6),
    }


def _list(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)


@dataclass(frozen=True)
class CellStabilityTable:
    """Smallest eigenvalues on 2 x 2 stars of the cells at one stretch. A law from other sources may have no such cells.

    Attributes
    ----------
    sizes : (n, A) of the stars, in the order of `homogenize.law.axes.AXES`.
    flat, rolled : (n,) N/mm, of the flat cell and of its natural tubes (smallest over the directions).

    Examples
    --------
    >>> table = CellStabilityTable(np.array([[10.0, 0.3, 1.2]]), np.array([-15.0]), np.array([7.0]))
    >>> table.eigenvalues(np.array([[10.0, 0.3, 1.2]] * 3), np.array([0.0, 0.5, 1.0])).tolist()
    [-15.0, -4.0, 7.0]
    """

    sizes: Floats
    flat: Floats
    rolled: Floats

    @classmethod
    def of(cls, samples: Sequence[dict[str, Any]], stretch: float) -> Self:
        """The cells with arms and an answer among samples as in a law's file."""
        known = [
            each for each in samples if each["problem"] is None and each["length_mm"] > 0 and each["stretch"] == stretch
        ]
        return cls(
            np.array([[each[axis.key] for axis in AXES] for each in known]).reshape(-1, len(AXES)),
            np.array([each["sample"]["supercell_eigenvalue"] for each in known]),
            np.array([min(each["sample"]["natural_supercell_eigenvalue"]) for each in known]),
        )

    def eigenvalues(self, sizes: Floats, part: Floats) -> Floats:
        """(S,) N/mm, of the nearest cell of each star, linear between its flat and its natural state; infinite if the
        table has no cells.

        Parameters
        ----------
        sizes : (S, A) of the stars.
        part : (S,) curvature of the sheet over the natural curvature, limited to 0 to 1.
        """
        if not len(self.sizes):
            return np.full(len(sizes), np.inf)
        known, asked = coordinates(self.sizes), coordinates(sizes)
        span = np.maximum(np.ptp(known, axis=0), 1e-9)
        nearest = np.linalg.norm((asked[:, None] - known) / span, axis=2).argmin(axis=1)
        flat, rolled = self.flat[nearest], self.rolled[nearest]
        return np.asarray(flat + np.clip(part, 0.0, 1.0) * (rolled - flat))
