"""The law of the sheet: what a cell's star makes of it, as smooth functions of the star's sizes.

A law belongs to one material, lattice and edge length, and has a table (`homogenize.law.law_table`) for each stretch.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from homogenize.cell.corrugation_waves import CorrugationWaves
from homogenize.errors import ForeignLaw, LawError
from homogenize.law.law_table import QUANTITIES, LawTable, LawValues
from homogenize.law.material import Material
from pattern.design.design import Design
from pattern.design.lattice import Lattice
from pattern.geometry.arrays import Floats

# parts by which numbers of a design may differ from the law's: rounding of the machine's, and of what is printed of a
# measured material, whose curvature a law knows less well
LATTICE_TOLERANCE, MATERIAL_TOLERANCE = 1e-6, 2e-3
# tried: bare fabric then has no stiffness or no answer at all, and the natural curvature of the paper's star is .027 to
# .079 per mm at edges from 3.5 to .8 mm, in no order
WITHOUT_BENDING = (
    "no law can hold it: bare fabric has no stiffness against bending then, and what a cell does depends on its mesh; "
    "the exact model can: asterism simulate"
)
WITH_TWO_STRETCHES = "a law is for equal stretch in x and y; the exact model takes both: asterism simulate"


@dataclass(frozen=True)
class Law:
    """Tables for one material, and everything needed to make them again.

    Attributes
    ----------
    material : with the plan.
    tables : one per stretch.
    samples : all records of the campaign as plain data, in the plan's order.
    residuals : see `homogenize.law.law_residuals`.
    made : versions, command, machine, seconds.
    """

    material: Material
    tables: tuple[LawTable, ...]
    samples: Sequence[dict[str, Any]]
    residuals: dict[str, Any]
    made: dict[str, Any] = field(default_factory=dict)

    @property
    def edge_mm(self) -> float:
        """Edge length of the cells' mesh; sheets to be compared should have the same."""
        return self.material.plan.edge_mm

    @cached_property
    def waves(self) -> CorrugationWaves:
        """Of which `Table.relief` gives the amplitudes."""
        return CorrugationWaves.of(self.material.lattice)

    def at(self, stretch: float) -> LawTable:
        """The table of a stretch."""
        for table in self.tables:
            if _same(table.stretch, stretch):
                return table
        raise ForeignLaw(f"fabric.stretch = {stretch:g}: the law was made for {_list(self.stretches)}")

    @property
    def stretches(self) -> tuple[float, ...]:
        """Those of the tables."""
        return tuple(table.stretch for table in self.tables)

    def check(self, design: Design) -> LawTable:
        """The table for a design.

        Moduli and densities may differ: without gravity only the ratio of the moduli matters, see `evaluate`.

        Raises
        ------
        ForeignLaw
            The law is for something else; says what differs.
        LawError
            No law can hold the design's fabric.
        """
        if not design.fabric.has_bending:
            raise LawError(f"fabric.bending = {design.fabric.bending}: {WITHOUT_BENDING}")
        sx, sy = design.fabric.stretch_xy
        if not _same(sx, sy):
            raise LawError(f"fabric.stretch = {[sx, sy]}: {WITH_TWO_STRETCHES}")
        free = {"fabric": {"stretch", "modulus_mpa", "density_kg_m3"}, "plastic": {"density_kg_m3"}}
        for section in ("fabric", "plastic", "lattice"):
            ours, theirs = (getattr(thing, section).model_dump(mode="json") for thing in (self.material, design))
            if section == "lattice":
                ours, theirs = (_lattice(thing.lattice, thing_data) for thing, thing_data in
                                ((self.material, ours), (design, theirs)))  # fmt: skip
                if _same_sites(self.material.lattice, design.lattice):
                    ours |= {key: theirs[key] for key in ("kind", "spacing_mm", "vectors_mm")}
            for key in ours:
                part = LATTICE_TOLERANCE if section == "lattice" else MATERIAL_TOLERANCE
                if key not in free.get(section, ()) and not _same(ours[key], theirs[key], part):
                    other = "lattice" if section == "lattice" else "material"
                    raise ForeignLaw(f"{section}.{key} = {theirs[key]}: the law is for another {other}, of {ours[key]}")
        return self.at(sx)

    def relief(self, design: Design, length_mm: ArrayLike, thickness_mm: ArrayLike, width_mm: ArrayLike) -> Floats:
        """(N, 2, W) mm and mm^2, `Table.relief` for a design's stars, which may be turned by half a turn."""
        found = self.check(design).relief(length_mm, thickness_mm, width_mm)
        arms = design.lattice.arms
        turned = (design.lattice.orientation_deg - self.material.lattice.orientation_deg) * arms / 180.0
        return np.where(self.waves.odd, -found, found) if arms % 2 and round(turned) % 2 else found

    def anisotropy(self, design: Design, length_mm: ArrayLike, thickness_mm: ArrayLike, width_mm: ArrayLike) -> Floats:
        """(N, K) `Table.anisotropy` for a design's stars, which is the same after half a turn."""
        return self.check(design).anisotropy(length_mm, thickness_mm, width_mm)

    def evaluate(self, design: Design, length_mm: ArrayLike, thickness_mm: ArrayLike, width_mm: ArrayLike) -> LawValues:
        """The law for a design's material at stars of these sizes, stiffnesses in the design's own moduli."""
        values = self.check(design)(length_mm, thickness_mm, width_mm)
        scale = design.fabric.modulus_mpa / self.material.fabric.modulus_mpa
        if scale == 1.0:
            return values
        factor = {name: scale if quantity.per_modulus else 1.0 for name, quantity in QUANTITIES.items()}
        return LawValues(
            {name: value * factor[name] for name, value in values.value.items()},
            {name: slope * factor[name] for name, slope in values.slope.items()},
            values.inside,
            values.outside,
            values.tight,
        )


def _lattice(lattice: Lattice, data: dict[str, Any]) -> dict[str, Any]:
    """What of a lattice shapes its cells: not where its origin lies, and turns up to the symmetry of star and sites.

    Sites repeat after half a turn: stars that are turned by it make the same sheet.
    """
    turn = (lattice.orientation_deg + 1e-7) % (360 / lattice.arms / (1 + lattice.arms % 2)) - 1e-7
    return {
        "arms": data["arms"],
        "kind": data["kind"],
        "spacing_mm": data["spacing_mm"],
        "vectors_mm": data["vectors_mm"],
        "orientation_deg": round(turn, 6),
    }


def _same_sites(one: Lattice, other: Lattice) -> bool:
    """Whether both are one lattice, in whatever basis and wherever its origin lies."""
    steps = one.vectors @ np.linalg.inv(other.vectors)
    return bool(np.abs(steps - np.rint(steps)).max() < 1e-6 and round(abs(np.linalg.det(steps))) == 1)


def _same(a: Any, b: Any, part: float = LATTICE_TOLERANCE) -> bool:
    """Whether numbers differ by no more than a part of them, also in lists and tables."""
    if isinstance(a, int | float) and isinstance(b, int | float):
        return math.isclose(a, b, rel_tol=part, abs_tol=1e-12)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(_same(one, other, part) for one, other in zip(a, b, strict=True))
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_same(a[key], b[key], part) for key in a)
    return bool(a == b)


def _list(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)
