"""The sections `[fabric]` and `[plastic]`, residual curvature of plastic, and the rest curvature of both layers."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import MassDensity, Number, NumberOrPair, Section

CurvaturePerMm = Annotated[Number, Field(ge=-1, le=1)]
HINGES_POISSON = -1.0 / 3.0  # Poisson's ratio of the paper's hinges as a plate


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


class BendingStiffness(NamedTuple):
    """Stiffness D of a sheet against bending, N mm.

    Twice the energy per area is `D11 k11^2 + 2 D12 k11 k22 + D22 k22^2 + 4 D66 k12^2` for the curvatures k.
    """

    d11: float
    d12: float
    d22: float
    d66: float

    @classmethod
    def isotropic(cls, stiffness: float, poisson: float) -> BendingStiffness:
        """The same in all directions.

        >>> BendingStiffness.isotropic(1.0, -0.5)
        BendingStiffness(d11=1.0, d12=-0.5, d22=1.0, d66=0.75)
        """
        return cls(stiffness, poisson * stiffness, stiffness, 0.5 * (1.0 - poisson) * stiffness)


class Fabric(Section):
    """The stretched fabric.

    Attributes
    ----------
    stretch : printed length over released length, the same in x and y or one for each.
    modulus_mpa : Young's modulus. Without gravity only its ratio to the plastic's matters for the shape.
    model : energy of the membrane.
    bending : bending energy: `plate` is the plate that bends like the paper's hinges, `consistent` the plate of this
        thickness, `paper` the hinges themselves, which depend on the mesh.
    bending_stiffness_n_mm : measured bending stiffness of a plate for each mm of width, in place of those.
    thickness_mm, density_kg_m3 : of the released fabric; the density is used by gravity only.
    """

    stretch: NumberOrPair = 1.35
    thickness_mm: Number = Field(0.8, ge=0.01, le=10)
    modulus_mpa: Number = Field(7.1875, ge=1e-3, le=1e5)
    poisson: Number = Field(0.3, ge=0, le=0.49)
    model: Literal["neo-hookean", "incompressible"] = "neo-hookean"
    bending: Literal["paper", "plate", "consistent", "none"] = "plate"
    bending_stiffness_n_mm: Number | None = Field(None, ge=1e-6, le=1e4)
    density_kg_m3: MassDensity = 400.0

    @field_validator("stretch")
    @classmethod
    def _in_range(cls, stretch: float | tuple[float, float]) -> float | tuple[float, float]:
        if not all(1 <= s <= 3 for s in np.atleast_1d(stretch)):
            raise DesignError("", "must be from 1 to 3 (printed length over released length)", stretch)
        return stretch

    @model_validator(mode="after")
    def _measured_bending(self) -> Self:
        if self.bending_stiffness_n_mm is None:
            return self
        if not self.bends_as_plate:
            message = 'needs fabric.bending = "plate": other bending energies have no stiffness of their own'
            raise DesignError("bending_stiffness_n_mm", message, self.bending_stiffness_n_mm)
        if "modulus_mpa" not in self.model_fields_set:
            message = "must be given with bending_stiffness_n_mm: the default only sets the scale of a ratio"
            raise DesignError("modulus_mpa", message)
        return self

    @property
    def stretch_xy(self) -> tuple[float, float]:
        """Stretch along x and along y."""
        x, y = np.broadcast_to(self.stretch, 2)
        return float(x), float(y)

    @property
    def has_bending(self) -> bool:
        """The fabric resists bending."""
        return self.bending != "none"

    @property
    def bending_tensor(self) -> BendingStiffness:
        """The fabric's stiffness against bending. On equilateral triangles, the paper's hinges bend like `plate`.

        >>> [round(Fabric(bending=each).bending_tensor.d11, 3) for each in ("paper", "plate", "consistent", "none")]
        [1.011, 1.011, 0.337, 0.0]
        """
        if not self.has_bending:
            return BendingStiffness(0.0, 0.0, 0.0, 0.0)
        if self.bending_stiffness_n_mm is not None:
            return BendingStiffness.isotropic(self.bending_stiffness_n_mm, self.poisson)
        of_thickness = self.modulus_mpa * self.thickness_mm**3 / (12.0 * (1.0 - self.poisson**2))
        if self.bending == "consistent":
            return BendingStiffness.isotropic(of_thickness, self.poisson)
        return BendingStiffness.isotropic(3.0 * of_thickness, HINGES_POISSON)

    @property
    def bends_as_plate(self) -> bool:
        """The fabric bends like a plate, whose shape does not depend on the mesh."""
        return self.has_bending and not self.bending_follows_mesh

    @property
    def bending_follows_mesh(self) -> bool:
        """The bending stiffness depends on the mesh, so the mesh must be even."""
        return self.bending == "paper"

    @property
    def printed_mass(self) -> float:
        """kg per printed mm^2: the released area of a printed mm^2 is 1/(sx sy)."""
        sx, sy = self.stretch_xy
        # kg/m^3 times mm is 1e-9 kg/mm^2
        return 1e-9 * self.density_kg_m3 * self.thickness_mm / (sx * sy)


class Plastic(Section):
    """The printed plastic.

    Attributes
    ----------
    modulus_ratio : Young's modulus of the plastic over the fabric's, E1/E2; it goes with `rest_curvature`,
        which was used to measure it.
    rest_curvature : formula for the curvature of a released arm.
    kappa_bar_per_mm : residual curvature of plastic peeled off its fabric, one number or a table over the thickness.
    density_kg_m3 : used by gravity only.
    """

    modulus_ratio: Number = Field(3200.0, ge=1, le=1e7)
    poisson: Number = Field(0.3, ge=0, le=0.49)
    rest_curvature: Literal["paper", "timoshenko", "none"] = "paper"
    kappa_bar_per_mm: KappaBar = 0.0
    density_kg_m3: MassDensity = 1220.0


def rest_curvature(
    thickness_mm: ArrayLike, fabric: Fabric, plastic: Plastic, direction: ArrayLike | None = None
) -> NDArray[np.float64]:
    """Curvature (1/mm) about the width axis of a released arm without neighbours; positive bends the tips down.

    Parameters
    ----------
    thickness_mm : (...) h1, thickness of the plastic.
    direction : (..., 2) unit vectors along the arms in print coordinates; needed if the stretches differ.

    Notes
    -----
    The sum of `bilayer_curvature` and `kappa_bar`; `none` is `kappa_bar` alone. Along an arm of direction t on a fabric
    stretched by sx and sy, `1/s^2` is the fabric's released metric `tx^2/sx^2 + ty^2/sy^2`.
    """
    h1 = np.asarray(thickness_mm, dtype=float)
    mismatch = _metric_mismatch(fabric.stretch_xy, direction)
    residual = residual_curvature(h1, plastic.kappa_bar_per_mm)
    if plastic.rest_curvature == "none":
        return residual + np.zeros(np.shape(mismatch))
    return (
        bilayer_curvature(h1, fabric.thickness_mm, plastic.modulus_ratio, mismatch, plastic.rest_curvature) + residual
    )


def rest_twist(thickness_mm: ArrayLike, fabric: Fabric, plastic: Plastic, direction: ArrayLike) -> NDArray[np.float64]:
    """Twist (1/mm) of a released arm without neighbours: the off-diagonal part of the rest curvature's tensor.

    It is 0 on a fabric that is stretched equally, and for arms along x or y.

    Parameters
    ----------
    thickness_mm : (...) h1, thickness of the plastic.
    direction : (..., 2) unit vectors t along the arms in print coordinates.

    Notes
    -----
    With `n` the direction 90 degrees to the left of t, the released metric has the shear component
    `t . diag(1/sx^2, 1/sy^2) . n`. The shear force of the fabric acts at the same distance from the middle of the
    plastic as its tension does, and a thin strip of plastic resists the twisting moment as it resists the bending
    moment, with shear moduli in place of Young's moduli. Hence it is `bilayer_curvature` with the ratio of the shear
    moduli. A positive twist turns the plastic's normal clockwise about t, by this angle for each mm along t.

    Examples
    --------
    >>> along = np.array([[1.0, 0.0], [np.sqrt(0.5), np.sqrt(0.5)], [np.sqrt(0.5), -np.sqrt(0.5)]])
    >>> (1e5 * rest_twist(0.3, Fabric(stretch=(1.35, 1.2)), Plastic(), along)).round().astype(int).tolist()
    [0, -445, 445]
    """
    if plastic.rest_curvature == "none":
        return np.zeros(np.broadcast_shapes(np.shape(thickness_mm), np.shape(direction)[:-1]))
    metric = 1.0 / np.square(fabric.stretch_xy)
    t = np.asarray(direction, dtype=float)
    mismatch = (metric[0] - metric[1]) * t[..., 0] * t[..., 1]
    ratio = plastic.modulus_ratio * (1.0 + fabric.poisson) / (1.0 + plastic.poisson)
    return bilayer_curvature(thickness_mm, fabric.thickness_mm, ratio, mismatch, plastic.rest_curvature)


def bilayer_curvature(
    h1: ArrayLike, h2: ArrayLike, ratio: ArrayLike, mismatch: ArrayLike, formula: Literal["paper", "timoshenko"]
) -> NDArray[np.float64]:
    """Curvature (1/mm) of a strip of plastic and fabric, without residual curvature; arrays that broadcast.

    Parameters
    ----------
    h1, h2 : thickness of plastic and fabric, mm.
    ratio : E1/E2.
    mismatch : of the two metrics, `1 - 1/s^2`.
    formula : `paper` is Eq. (1), `6 h2 (h1 + h2) / h1^3  E2/E1  (1 - 1/s^2)`. `timoshenko` is the strip of
        Timoshenko (1925), `6 eps (1+m)^2 / (H (3 (1+m)^2 + (1 + m n) (m^2 + 1/(m n))))` with `m = h1/h2`,
        `n = E1/E2`, `H = h1 + h2` and mismatch strain `eps = (1 - 1/s^2)/2`; for stiff plastic it is half of Eq. (1).
    """
    h1, h2, n, mismatch = (np.asarray(value, dtype=float) for value in (h1, h2, ratio, mismatch))
    if formula == "paper":
        return np.asarray(6 * h2 * (h1 + h2) / (h1**3 * n) * mismatch)
    m = h1 / h2
    stiffness = 3 * (1 + m) ** 2 + (1 + m * n) * (m**2 + 1 / (m * n))
    return np.asarray(6 * (mismatch / 2) * (1 + m) ** 2 / ((h1 + h2) * stiffness))


def _metric_mismatch(stretch: tuple[float, float], direction: ArrayLike | None) -> NDArray[np.float64]:
    if direction is None:
        if stretch[0] != stretch[1]:
            raise ValueError("a fabric stretched differently in x and y needs the direction of the arm")
        return np.asarray(1 - 1 / stretch[0] ** 2)
    return np.asarray(1 - np.sum((np.asarray(direction, dtype=float) / stretch) ** 2, axis=-1))
