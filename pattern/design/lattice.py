"""The section `[lattice]`: where stars stand, and which way their arms point."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import Number, Point, Section, Whole, within
from asterism.pattern.geometry.plane_lattice import PlaneLattice, shortest_basis

DEFAULT_SPACING_MM = 10 * np.sqrt(3.0)


class Lattice(Section):
    """The lattice of star centres, and the arms of one star.

    >>> Lattice(kind="square", spacing_mm=20.0).vectors.tolist()
    [[20.0, 0.0], [0.0, 20.0]]
    """

    # `triangular` has neighbours at 30, 90, ... 330 deg, `square` at 0, 90, 180, 270 deg. `custom` is spanned by
    # `vectors_mm`.
    kind: Literal["triangular", "square", "custom"] = "triangular"
    # distance of nearest neighbours. It follows from `vectors_mm` if those are given.
    spacing_mm: Number = Field(float(DEFAULT_SPACING_MM), ge=1, le=500)
    vectors_mm: Annotated[tuple[Point, Point], within(-1000, 1000, " mm")] | None = None
    origin_mm: Annotated[Point, within(-10_000, 10_000, " mm")] = (0.0, 0.0)  # place of one star
    arms: Whole = Field(3, ge=3, le=8)  # number of arms of a star, equally spaced
    # turns all stars counterclockwise. At 0 the first arm points to -90 deg.
    orientation_deg: Number = Field(0.0, ge=-360, le=360)

    @model_validator(mode="after")
    def _one_description(self) -> Lattice:
        if self.kind == "custom" and self.vectors_mm is None:
            raise DesignError("vectors_mm", 'is missing: kind = "custom" needs two vectors')
        if self.kind != "custom" and self.vectors_mm is not None:
            raise DesignError("vectors_mm", f'goes with kind = "custom", not with "{self.kind}"')
        if self.vectors_mm is None:
            return self
        basis = np.asarray(self.vectors_mm)
        if abs(np.linalg.det(basis)) < 1:
            raise DesignError("vectors_mm", "must span at least 1 mm2, not a line", self.vectors_mm)
        shortest = float(np.linalg.norm(shortest_basis(basis), axis=1).min())
        if shortest < 1:
            raise DesignError("vectors_mm", "must leave at least 1 mm between stars", self.vectors_mm)
        if "spacing_mm" in self.model_fields_set and not np.isclose(self.spacing_mm, shortest, rtol=1e-6):
            raise DesignError("spacing_mm", f"follows from vectors_mm ({shortest:g}): leave it out", self.spacing_mm)
        object.__setattr__(self, "spacing_mm", shortest)  # sections are frozen once they are complete
        return self

    @property
    def vectors(self) -> Floats:
        """(2, 2) mm, rows: the shortest two that span the lattice, the second 60 to 90 degrees left of the first."""
        if self.vectors_mm is not None:
            return shortest_basis(np.asarray(self.vectors_mm))
        if self.kind == "square":
            return self.spacing_mm * np.eye(2)
        return self.spacing_mm * np.array([[np.sqrt(0.75), 0.5], [0.0, 1.0]])

    @property
    def sites(self) -> PlaneLattice:
        """All places where stars can stand."""
        return PlaneLattice(self.vectors, np.asarray(self.origin_mm))

    @property
    def arm_directions(self) -> Floats:
        """(arms, 2) unit vectors, counterclockwise."""
        angle = np.radians(self.orientation_deg - 90 + 360 / self.arms * np.arange(self.arms))
        return np.column_stack([np.cos(angle), np.sin(angle)])
