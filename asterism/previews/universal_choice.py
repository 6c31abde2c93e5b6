"""The universal law for a design without a law of its own material: whether it serves, and how accurate it is."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from functools import cache, lru_cache

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.axes import law_coordinates
from asterism.homogenize.law.law import Law
from asterism.homogenize.universal.material_law import law_edge, material_law, universal_law_errors
from asterism.homogenize.universal.universal_law import UniversalLaw, load_universal_law
from asterism.pattern.design.design import Design
from asterism.pattern.design.stars import MIN_ARM_MM
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout

# Share of the stars outside the law, above which it does not serve; fewer are named by the preview, as of every law. Up
# to this share, nine in ten previews move by at most 1 % of the width.
MAX_UNCOVERED_SHARE = 0.2
# rms of the left-out errors of the nearest cells, %, above which the law does not serve. With these bounds 99 % of the
# served cells are within 0.3 % in lam_n, and 95 % within 8 % in kappa and bending.
MAX_SERVING_ERRORS_PERCENT = {"lam_n": 0.3, "kappa": 12.0, "bending": 12.0}
_IN_WORDS = {"lam_n": "contraction", "kappa": "natural curvature", "bending": "bending stiffness"}
_OTHERWISE = "; asterism simulate needs no law"
# materials whose tables are kept
_KEPT_LAWS = 16


@dataclass(frozen=True)
class UniversalChoice:
    """The universal law for one design.

    Attributes
    ----------
    law : None if it does not serve.
    statement : for which stars it serves and how accurate it is, or why it does not serve; one sentence.
    """

    law: Law | None
    statement: str


def universal_choice(design: Design, sizes: Floats) -> UniversalChoice:
    """The universal law for a design with stars of these sizes (S, A)."""
    if not len(sizes):
        return UniversalChoice(None, "no universal law is available")
    edge = law_edge(design)
    try:
        errors = universal_law_errors(packaged_universal_law(), design, sizes, edge)
    except LawError as error:
        return UniversalChoice(None, str(error))
    if (~errors.covered).mean() > MAX_UNCOVERED_SHARE:
        count = f"{int((~errors.covered).sum())} of {len(sizes)} stars"
        return UniversalChoice(None, f"the universal law does not serve for {count}: {errors.outside}{_OTHERWISE}")
    typical = errors.typical_percent
    numbers = ", ".join(f"{_IN_WORDS[name]} {percent:.2g} %" for name, percent in typical.items())
    if any(typical[name] > most for name, most in MAX_SERVING_ERRORS_PERCENT.items()):
        return UniversalChoice(
            None, f"the universal law does not serve such fabric and stars: it is off by {numbers}{_OTHERWISE}"
        )
    statement = (
        f"the universal law stands in for a law of this material: it is off by {numbers} (rms over the left-out cells "
        "nearest to these stars); asterism calibrate makes a law of the design's own stars"
    )
    return UniversalChoice(replace(_kept_table(_material_of(design), edge), statement=statement), statement)


def _material_of(design: Design) -> str:
    """Fabric, plastic and lattice of a design, as text."""
    data = design.to_dict()
    return json.dumps({name: data[name] for name in ("fabric", "plastic", "lattice")}, sort_keys=True)


@lru_cache(maxsize=_KEPT_LAWS)
def _kept_table(material: str, edge_mm: float) -> Law:
    """The law of a material, made once: an edit of a design asks for it again."""
    any_sheet = {"stars": {"length_mm": MIN_ARM_MM}, "border": {"rings": 0}}
    design = Design.from_dict(json.loads(material) | any_sheet)
    return material_law(packaged_universal_law(), design, edge_mm)


def sizes_of_stars(design: Design, plan: Layout | None = None) -> Floats:
    """(S, A) sizes of the stars of a design, in the order of `homogenize.law.axes.AXES`."""
    return law_coordinates(plan if plan is not None else layout(design), design.lattice.arms)


@cache
def packaged_universal_law() -> UniversalLaw:
    """The universal law of the package, read once."""
    return load_universal_law()
