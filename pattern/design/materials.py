"""The sections `[fabric]` and `[plastic]`, residual curvature of plastic, and the rest curvature of both layers."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Discriminator, Field, Tag, model_validator

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import MassDensity, Number, NumberOrPair, Section, within

CurvaturePerMm = Annotated[Number, Field(ge=-1, le=1)]
HINGES_POISSON = -1.0 / 3.0  # Poisson's ratio of the paper's hinges as a plate
_DEFAULT_MODULUS_MPA = 7.1875  # of the paper's fabric
# exponents of the membrane energy of orthotropic fabric: from the first on it is polyconvex (Itskov and Aksel 2004),
# and beyond the second it stiffens more than knits do
MIN_EXPONENT, MAX_EXPONENT = 0.5, 6.0


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
    def orthotropic(cls, d11: float, d22: float, poisson: float, shear: float = 1.0) -> BendingStiffness:
        """From the stiffness in two directions, the geometric mean of both Poisson's ratios, and D66 over Huber's.

        >>> BendingStiffness.orthotropic(1.0, 1.0, -0.5)
        BendingStiffness(d11=1.0, d12=-0.5, d22=1.0, d66=0.75)
        """
        mean = float(np.sqrt(d11 * d22))
        return cls(d11, poisson * mean, d22, 0.5 * (1.0 - poisson) * mean * shear)

    @property
    def turned(self) -> BendingStiffness:
        """The sheet turned by 90 degrees."""
        return self._replace(d11=self.d22, d22=self.d11)

    @property
    def mean(self) -> float:
        """Geometric mean of the stiffness in both directions."""
        return float(np.sqrt(self.d11 * self.d22))


def _both(value: float | tuple[float, float]) -> tuple[float, float]:
    """A value for two directions, from one number for both or one for each."""
    one, other = np.broadcast_to(value, 2)
    return float(one), float(other)


class Fabric(Section):
    """The stretched fabric, the same in all directions or orthotropic: with moduli along and across its grain."""

    # printed length over released length, the same in x and y or one for each
    stretch: Annotated[NumberOrPair, within(1.0, 3.0, " (printed length over released length)")] = 1.35
    # thickness_mm, density_kg_m3: of the released fabric; the density is used by gravity only.
    thickness_mm: Number = Field(0.8, ge=0.01, le=10)
    # Young's modulus, or one along and one across the grain. Without gravity only its ratio to the plastic's matters
    # for the shape.
    modulus_mpa: Annotated[NumberOrPair, within(1e-3, 1e5)] = _DEFAULT_MODULUS_MPA
    # of shear between along and across; by default Huber's `sqrt(E1 E2)/(2 (1 + poisson))`, but at most the largest of
    # `shear_range`.
    shear_modulus_mpa: Number | None = Field(None, ge=1e-4, le=1e5)
    # Poisson's ratio; of orthotropic fabric the geometric mean of both, so that `nu12 = poisson sqrt(E1/E2)` is the
    # contraction across of a strip that is pulled along.
    poisson: Number = Field(0.3, ge=0, le=0.49)
    # direction along the grain on the released fabric, counterclockwise from x; 0 by default.
    grain_deg: Number | None = Field(None, ge=-360, le=360)
    model: Literal["neo-hookean", "incompressible"] = "neo-hookean"  # energy of the membrane
    # bending energy: `plate` is the plate that bends like the paper's hinges, `consistent` the plate of this thickness,
    # `paper` the hinges themselves, which depend on the mesh.
    bending: Literal["paper", "plate", "consistent", "none"] = "plate"
    # measured bending stiffness of a plate for each mm of width, in place of those; or of strips along and across the
    # grain.
    bending_stiffness_n_mm: Annotated[NumberOrPair, within(1e-6, 1e4)] | None = None
    density_kg_m3: MassDensity = 400.0

    @model_validator(mode="after")
    def _is_stable(self) -> Self:
        if not self.is_orthotropic:
            return self
        if self.model != "neo-hookean":
            raise DesignError("model", 'must be "neo-hookean" for fabric that has a grain', self.model)
        if self.bending_follows_mesh:
            problem = (
                'must be "plate", "consistent" or "none" for fabric that has a grain: hinges bend alike everywhere'
            )
            raise DesignError("bending", problem, self.bending)
        low, high = self.shear_range
        if low > high:
            problem = f"must have a ratio of at most {self._largest_ratio:.3g} with poisson = {self.poisson:g}"
            raise DesignError("modulus_mpa", problem, list(self.moduli))
        if not 0.995 * low <= self.shear_modulus <= 1.005 * high:  # the limits as the message rounds them
            problem = f"must be from {low:.3g} to {high:.3g} for these moduli"
            raise DesignError("shear_modulus_mpa", problem, self.shear_modulus_mpa)
        return self

    @model_validator(mode="after")
    def _measured_bending(self) -> Self:
        if self.bending_stiffness_n_mm is None:
            return self
        if not self.bends_as_plate:
            message = 'needs fabric.bending = "plate": other bending energies have no stiffness of their own'
            raise DesignError("bending_stiffness_n_mm", message, self.bending_stiffness_n_mm)
        if not self.has_scale:
            message = "must be given with bending_stiffness_n_mm: the default, and strips, only give a ratio"
            raise DesignError("modulus_mpa", message)
        return self

    @property
    def stretch_xy(self) -> tuple[float, float]:
        """Stretch along x and along y."""
        return _both(self.stretch)

    @property
    def is_orthotropic(self) -> bool:
        """Whether any of its stiffnesses depends on the direction of the grain."""
        pairs = (self.modulus_mpa, self.bending_stiffness_n_mm)
        return self.shear_modulus_mpa is not None or any(
            isinstance(each, tuple) and each[0] != each[1] for each in pairs
        )

    @property
    def is_directional(self) -> bool:
        """Whether the stretch or a stiffness depends on the direction."""
        return self.is_orthotropic or len(set(self.stretch_xy)) > 1

    def keeps(self, motions: Floats) -> NDArray[np.bool_]:
        """(...) whether orthogonal matrices (..., 2, 2) map the stretch and the grain onto themselves.

        >>> mirror = np.diag([1.0, -1.0])
        >>> [bool(Fabric(modulus_mpa=(2.0, 1.0), grain_deg=grain).keeps(mirror)) for grain in (0.0, 45.0, 90.0)]
        [True, False, True]
        """

        def turns(tensor: Floats, sign: float) -> NDArray[np.bool_]:
            """Whether they turn a tensor into itself, times a sign."""
            off = motions @ tensor - sign * tensor @ motions
            # of tensors that a motion keeps
            return np.asarray(np.abs(off).max(axis=(-2, -1)) < 1e-6)

        kept = turns(np.diag(self.stretch_xy), 1.0)
        if self.is_orthotropic:
            grain = np.outer(self.axes[:, 0], self.axes[:, 0]) - 0.5 * np.eye(2)
            pairs = (self.moduli, _both(self.bending_stiffness_n_mm or 1.0))
            is_fourfold = all(along == across for along, across in pairs)
            kept &= turns(grain, 1.0) | (is_fourfold & turns(grain, -1.0))
        return kept

    @property
    def moduli(self) -> tuple[float, float]:
        """MPa, Young's moduli E1 along and E2 across the grain."""
        return _both(self.modulus_mpa)

    @property
    def modulus(self) -> float:
        """MPa, geometric mean of the moduli: the one to which the plastic's is a ratio."""
        along, across = self.moduli
        return float(np.sqrt(along * across))

    @property
    def shear_modulus(self) -> float:
        """MPa, shear modulus G between along and across."""
        huber = self.modulus / (2.0 * (1.0 + self.poisson))
        return self.shear_modulus_mpa or min(huber, self.shear_range[1])

    @property
    def shear_range(self) -> tuple[float, float]:
        """MPa, shear moduli for which both exponents are from `MIN_EXPONENT` to `MAX_EXPONENT`."""
        low, high = sorted(self._exponents_by_shear)
        return high / MAX_EXPONENT, low / MIN_EXPONENT

    @property
    def exponents(self) -> tuple[float, float]:
        """Exponents `(Q11 - Q12)/(2 G)` and `(Q22 - Q12)/(2 G)` of the membrane energy, with the plane stiffness Q.

        >>> Fabric().exponents, [round(p, 3) for p in Fabric(modulus_mpa=(10.0, 5.0)).exponents]
        ((1.0, 1.0), [1.592, 0.582])
        """
        if not self.is_orthotropic:
            return 1.0, 1.0
        along, across = self._exponents_by_shear
        return along / self.shear_modulus, across / self.shear_modulus

    @property
    def _exponents_by_shear(self) -> tuple[float, float]:
        """MPa, the exponents times G."""
        along, across = ((e - self.poisson * self.modulus) / (2.0 * (1.0 - self.poisson**2)) for e in self.moduli)
        return along, across

    @property
    def _largest_ratio(self) -> float:
        """Ratio of the moduli up to which there is a shear modulus within `shear_range`."""
        part = MIN_EXPONENT / MAX_EXPONENT  # (1/q - nu) part = q - nu with q^2 = E2/E1
        half = 0.5 * self.poisson * (1.0 - part)
        return float((half + np.sqrt(half**2 + part)) ** -2)

    @property
    def axes(self) -> Floats:
        """(2, 2) unit vectors along and across the grain on the released fabric, as columns."""
        angle = np.radians(self.grain_deg or 0.0)
        return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    @property
    def has_scale(self) -> bool:
        """Whether its modulus was given. The default only sets the scale of a ratio.

        Two moduli in the scale of the default are those of strips, which measure their ratio only.

        >>> Fabric().has_scale, Fabric(modulus_mpa=5.0).has_scale, Fabric(modulus_mpa=(14.375, 3.59375)).has_scale
        (False, True, False)
        """
        is_ratio = isinstance(self.modulus_mpa, tuple) and self._has_default_scale
        return "modulus_mpa" in self.model_fields_set and not is_ratio

    @property
    def has_forces(self) -> bool:
        """Whether forces are known: its modulus is not the default, which files of results give too."""
        return self.has_scale and not self._has_default_scale

    @property
    def _has_default_scale(self) -> bool:
        return abs(self.modulus / _DEFAULT_MODULUS_MPA - 1.0) < 1e-3

    @property
    def modulus_text(self) -> str:
        """The moduli for people.

        >>> Fabric(modulus_mpa=7.0).modulus_text, Fabric(modulus_mpa=(8.0, 4.0), grain_deg=30.0).modulus_text
        ('7 MPa', '8 MPa along and 4 MPa across the grain at 30 deg')
        """
        along, across = self.moduli
        if not self.is_orthotropic:
            return f"{along:g} MPa"
        grain = f"the grain at {self.grain_deg or 0:g} deg"
        return (
            f"{along:g} MPa, {grain}" if along == across else f"{along:g} MPa along and {across:g} MPa across {grain}"
        )

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
        poisson, plates = self.poisson, 1.0
        if self.bending_stiffness_n_mm is not None:
            along, across = _both(self.bending_stiffness_n_mm)
        else:
            if self.bending != "consistent":
                poisson, plates = HINGES_POISSON, 3.0
            along, across = (
                plates * (e * self.thickness_mm**3 / (12.0 * (1.0 - self.poisson**2))) for e in self.moduli
            )
        shear = self.shear_modulus * 2.0 * (1.0 + self.poisson) / self.modulus if self.is_orthotropic else 1.0
        return BendingStiffness.orthotropic(along, across, poisson, shear)

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
    """The printed plastic."""

    # Young's modulus of the plastic over the fabric's, E1/E2; it goes with `rest_curvature`, which was used to measure
    # it. Of orthotropic fabric the geometric mean of both moduli counts.
    modulus_ratio: Number = Field(3200.0, ge=1, le=1e7)
    poisson: Number = Field(0.3, ge=0, le=0.49)
    rest_curvature: Literal["paper", "timoshenko", "none"] = "paper"  # formula for the curvature of a released arm
    # residual curvature of plastic peeled off its fabric, one number or a table over the thickness.
    kappa_bar_per_mm: KappaBar = 0.0
    density_kg_m3: MassDensity = 1220.0  # used by gravity only


def rest_curvature(
    thickness_mm: ArrayLike, fabric: Fabric, plastic: Plastic, direction: ArrayLike | None = None
) -> NDArray[np.float64]:
    """Curvature (1/mm) about the width axis of a released arm without neighbours; positive bends the tips down.

    The sum of `bilayer_curvature` and `kappa_bar`; `none` is `kappa_bar` alone. Along an arm of direction t on a fabric
    stretched by sx and sy, `1/s^2` is the fabric's released metric `tx^2/sx^2 + ty^2/sy^2`. E2 is the fabric's modulus
    along the arm, see `_strip`.

    Parameters
    ----------
    thickness_mm : (...) h1, thickness of the plastic.
    direction : (..., 2) unit vectors along the arms in print coordinates; needed if it makes a difference.
    """
    h1 = np.asarray(thickness_mm, dtype=float)
    residual = residual_curvature(h1, plastic.kappa_bar_per_mm)
    if direction is None:
        if fabric.is_directional:
            raise ValueError("a fabric that differs by direction needs the direction of the arm")
        direction = (1.0, 0.0)
    along = _strip(fabric, direction)
    if plastic.rest_curvature == "none":
        return residual + np.zeros(np.shape(along.tension))
    ratio = plastic.modulus_ratio * fabric.modulus / along.modulus
    return bilayer_curvature(h1, fabric.thickness_mm, ratio, along.tension, plastic.rest_curvature) + residual


def rest_twist(thickness_mm: ArrayLike, fabric: Fabric, plastic: Plastic, direction: ArrayLike) -> NDArray[np.float64]:
    """Twist (1/mm) of a released arm without neighbours: the off-diagonal part of the rest curvature's tensor.

    It is 0 on fabric that is the same in all directions and stretched equally, and for arms along x or y, if the grain
    lies along x or y.

    The shear force of the fabric acts at the same distance from the middle of the plastic as its tension does, and a
    thin strip of plastic resists the twisting moment as it resists the bending moment, with shear moduli in place of
    Young's moduli. Hence it is `bilayer_curvature` with the ratio of the shear moduli. A positive twist turns the
    plastic's normal clockwise about t, by this angle for each mm along t.

    Parameters
    ----------
    thickness_mm : (...) h1, thickness of the plastic.
    direction : (..., 2) unit vectors t along the arms in print coordinates.

    >>> along = np.array([[1.0, 0.0], [np.sqrt(0.5), np.sqrt(0.5)], [np.sqrt(0.5), -np.sqrt(0.5)]])
    >>> (1e5 * rest_twist(0.3, Fabric(stretch=(1.35, 1.2)), Plastic(), along)).round().astype(int).tolist()
    [0, -445, 445]
    """
    if plastic.rest_curvature == "none":
        return np.zeros(np.broadcast_shapes(np.shape(thickness_mm), np.shape(direction)[:-1]))
    along = _strip(fabric, direction)
    ratio = plastic.modulus_ratio * fabric.modulus / (2.0 * (1.0 + plastic.poisson) * along.shear_modulus)
    return bilayer_curvature(thickness_mm, fabric.thickness_mm, ratio, along.shear, plastic.rest_curvature)


class _Strip(NamedTuple):
    """Fabric that an arm holds: its tension is `modulus tension/2`, its shear stress `shear_modulus shear`."""

    modulus: Floats
    tension: Floats
    shear_modulus: Floats
    shear: Floats


def _strip(fabric: Fabric, direction: ArrayLike) -> _Strip:
    """The fabric below arms of directions t (..., 2) in print coordinates.

    The arm holds the strain of the fabric along t and the shear between t and the direction n to its left. They are
    half of, and all of, the components of `m = I - diag(1/sx^2, 1/sy^2)`. Across, the strip is free. With the
    compliances S11, S16 and S66 in these directions,

        [m_tt/2, m_tn] = [[S11, S16], [S16, S66]] [tension, shear stress].

    For unequal stretches, the compliances are those at the released direction of t, and n is at a right angle to t in
    print.
    """
    t, stretch = np.asarray(direction, dtype=float), np.asarray(fabric.stretch_xy)
    m_tt = 1 - np.sum((t / stretch) ** 2, axis=-1)
    m_tn = (1 / stretch[0] ** 2 - 1 / stretch[1] ** 2) * t[..., 0] * t[..., 1]
    if not fabric.is_orthotropic:
        modulus, shear_modulus = np.asarray(fabric.modulus), np.asarray(fabric.shear_modulus)
        return _Strip(modulus, m_tt, shear_modulus, m_tn)
    released = t / stretch
    c, s = np.moveaxis(released @ fabric.axes / np.linalg.norm(released, axis=-1, keepdims=True), -1, 0)
    along, across = (1 / modulus for modulus in fabric.moduli)
    both, shear = -fabric.poisson / fabric.modulus, 1 / fabric.shear_modulus
    s11 = c**4 * along + s**4 * across + c**2 * s**2 * (2 * both + shear)
    s66 = 4 * c**2 * s**2 * (along + across - 2 * both) + (c**2 - s**2) ** 2 * shear
    s16 = 2 * c * s * (s**2 * across - c**2 * along + (c**2 - s**2) * (both + shear / 2))
    part = s16 / s66
    return _Strip(1 / (s11 - s16 * part), m_tt - 2 * part * m_tn, 1 / (s66 - s16**2 / s11), m_tn - s16 / s11 * m_tt / 2)


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
