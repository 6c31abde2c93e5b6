"""The curvature that plastic keeps when it is peeled off its fabric: one number, or a table over the thickness."""

from __future__ import annotations

from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Discriminator, Field, Tag, model_validator

from pattern.design.errors import DesignError
from pattern.design.section import Number, Section

PerMm = Annotated[Number, Field(ge=-1, le=1)]


class KeptCurvature(Section):
    """Curvature over the plastic's thickness, linear between the entries, constant beyond them."""

    thickness_mm: tuple[Number, ...] = Field(min_length=1, max_length=100)
    per_mm: tuple[PerMm, ...] = Field(min_length=1, max_length=100)

    @model_validator(mode="after")
    def _is_a_table(self) -> Self:
        if len(self.per_mm) != len(self.thickness_mm):
            raise DesignError("per_mm", f"must have {len(self.thickness_mm)} entries, one a thickness", self.per_mm)
        if self.thickness_mm[0] <= 0 or not np.all(np.diff(self.thickness_mm) > 0):
            raise DesignError("thickness_mm", "must be above 0 and increase", self.thickness_mm)
        return self


def _is_table(value: Any) -> str:
    return "kind:table" if isinstance(value, dict | Section) else "kind:number"


# a number, or a table over the thickness
KappaBar = Annotated[
    Annotated[PerMm, Tag("kind:number")] | Annotated[KeptCurvature, Tag("kind:table")], Discriminator(_is_table)
]


def kept_curvature(thickness_mm: ArrayLike, kappa_bar: float | KeptCurvature) -> NDArray[np.float64]:
    """Curvature (1/mm) of peeled plastic of the given thicknesses (...); positive bends the tips down."""
    h1 = np.asarray(thickness_mm, dtype=float)
    if isinstance(kappa_bar, KeptCurvature):
        return np.asarray(np.interp(h1, kappa_bar.thickness_mm, kappa_bar.per_mm))
    return np.full(h1.shape, float(kappa_bar))
