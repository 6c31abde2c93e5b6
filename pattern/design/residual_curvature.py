"""Residual curvature: the curvature of plastic that is peeled off its fabric."""

from __future__ import annotations

from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Discriminator, Field, Tag, model_validator

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import Number, Section

CurvaturePerMm = Annotated[Number, Field(ge=-1, le=1)]


class ResidualCurvature(Section):
    """Residual curvature over the thickness of the plastic, linear between the entries, constant beyond them."""

    thickness_mm: tuple[Number, ...] = Field(min_length=1, max_length=100)
    per_mm: tuple[CurvaturePerMm, ...] = Field(min_length=1, max_length=100)

    @model_validator(mode="after")
    def _is_a_table(self) -> Self:
        if len(self.per_mm) != len(self.thickness_mm):
            raise DesignError("per_mm", f"must have {len(self.thickness_mm)} entries, one a thickness", self.per_mm)
        if self.thickness_mm[0] <= 0 or not np.all(np.diff(self.thickness_mm) > 0):
            raise DesignError("thickness_mm", "must be above 0 and increase", self.thickness_mm)
        return self


def _branch(value: Any) -> str:
    return "kind:table" if isinstance(value, dict | Section) else "kind:number"


# a number, or a table over the thickness
KappaBar = Annotated[
    Annotated[CurvaturePerMm, Tag("kind:number")] | Annotated[ResidualCurvature, Tag("kind:table")],
    Discriminator(_branch),
]


def residual_curvature(thickness_mm: ArrayLike, kappa_bar: float | ResidualCurvature) -> Floats:
    """(...) 1/mm, residual curvature of plastic of the thicknesses (...); positive bends the tips down.

    Examples
    --------
    >>> residual_curvature([0.2, 0.3], 0.01).tolist()
    [0.01, 0.01]
    """
    h1 = np.asarray(thickness_mm, dtype=float)
    if isinstance(kappa_bar, ResidualCurvature):
        return np.asarray(np.interp(h1, kappa_bar.thickness_mm, kappa_bar.per_mm))
    return np.full(h1.shape, float(kappa_bar))
