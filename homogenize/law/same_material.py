"""Whether a design has the material that a law was made for, and sites of the same lattice."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from asterism.homogenize.errors import ForeignLaw
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.materials import Fabric

# relative difference between numbers of a design and of the law: rounding of the machine
LATTICE_TOLERANCE = 1e-6
# the same for a measured material, whose numbers people copy from a printed text; the law is less accurate than this
MATERIAL_TOLERANCE = 2e-3
# keys of a material that may differ. Without gravity, shapes depend on the ratio of the moduli only; the bending
# stiffness over the modulus is compared by itself
FREE_KEYS = {
    "fabric": {"stretch", "modulus_mpa", "density_kg_m3", "bending_stiffness_n_mm"},
    "plastic": {"density_kg_m3"},
}


def check_same(
    section: str, ours: Mapping[str, Any], theirs: Mapping[str, Any], tolerance: float, free: Collection[str] = ()
) -> None:
    """Compare the values of a section of the law's design and of another design.

    Raises
    ------
    ForeignLaw
        A value differs that is not free; the message names it.
    """
    kind = section if section == "lattice" else "motif" if section.startswith("rods") else "material"
    for key in ours:
        if key not in free and not same_values(ours[key], theirs[key], tolerance):
            field = f"{section}.{key}"
            if kind == "motif" and isinstance(theirs[key], list):  # places of a line
                raise ForeignLaw(f"{field}: the law is for another motif", field=field)
            raise ForeignLaw(f"{field} = {theirs[key]}: the law is for another {kind}, of {ours[key]}", field=field)


def check_bending(known: Fabric, asked: Fabric) -> None:
    """Compare the bending stiffnesses of two fabrics, each over its modulus.

    Raises
    ------
    ForeignLaw
        They differ.
    """
    ours, theirs = ([d / each.modulus_mpa for d in each.bending_tensor] for each in (known, asked))
    if not same_values(ours, theirs, MATERIAL_TOLERANCE):
        found = f"{theirs[0]:.3g} mm^3: the law is for {ours[0]:.3g} mm^3"
        problem = f"the fabric's bending stiffness over its modulus is {found}"
        raise ForeignLaw(problem, field="fabric.bending_stiffness_n_mm")


def same_sites(one: Lattice, other: Lattice) -> bool:
    """Whether two lattices have the same sites, up to their origins and bases."""
    steps = one.vectors @ np.linalg.inv(other.vectors)
    return bool(np.abs(steps - np.rint(steps)).max() < 1e-6 and round(abs(np.linalg.det(steps))) == 1)


def same_values(a: Any, b: Any, part: float = LATTICE_TOLERANCE) -> bool:
    """Whether numbers, also in lists and tables, differ by no more than this part of them.

    Examples
    --------
    >>> same_values([1.0, 2.0], [1.0, 2.0000001]), same_values({"a": 1.0}, {"a": 1.1})
    (True, False)
    """
    if isinstance(a, int | float) and isinstance(b, int | float):
        return math.isclose(a, b, rel_tol=part, abs_tol=1e-12)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(same_values(one, other, part) for one, other in zip(a, b, strict=True))
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(same_values(a[key], b[key], part) for key in a)
    return bool(a == b)
