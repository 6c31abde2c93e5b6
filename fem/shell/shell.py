"""Shell problem: discretisation, rest state, supports and loads.

The total energy of a state x, over the printed domain, is

    Pi(x) = int W(E, K) dA  -  progress sum(loads * x),

with the strains E and K of `fem.shell.koiter`, the density W of `fem.shell.density`, and dead loads. An equilibrium is
a zero of the gradient over the free unknowns q; it is stable if the Hessian over q is positive definite.

A state is `x` (N, 3), the coefficients of the position in the basis of the space. The supports write it as
`x = T q + c(progress)` with n free unknowns q (`fem.supports.conditions.Reduction`). Only some rows of `x` are
positions: those whose coefficient in the constant function one is not zero. The others are derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.errors import BackendError
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern, independent_dofs
from asterism.fem.elements.argyris import Argyris
from asterism.fem.shell.assembly import Assembly, MatrixReduction
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields
from asterism.fem.supports.conditions import Condition, Reduction, impose_conditions
from asterism.fem.supports.rigid import admissible_motions, neutral_motions, span_a_plane

# degree, exact for the linear bending energy of quintic triangles; avoids locking of thin triangles
QUADRATURE_ORDER = 6
PRINTED_REST = np.array([0.5, 0.5, 0.0, 0.0, 0.0, 0.0])  # rest values (a/2, b) of the printed sheet


class Shell:
    """Total energy of a supported and loaded shell, with its gradient and Hessian over the free unknowns.

    A shell is never changed: `with_fields`, `at_progress` and `with_target` return another one, which shares the
    discretisation and the pattern of the Hessian. Raises `fem.shell.fields.FieldError` if a field is not finite, or the
    rest metric or the density is not admissible. Raises `fem.supports.conditions.ConditionError` if a support cannot be
    met. Raises `ValueError` if the loads have another shape, or are not finite.

    Parameters
    ----------
    space : discretisation of the printed sheet.
    fields : rest metric, rest curvature and density.
    conditions : supports, see `fem.supports.conditions`.
    loads : (N, 3) N, dead loads, as of `fem.elements.argyris.area_load`.
    order : polynomial degree that the quadrature integrates exactly.

    A unit square that shrinks to 0.9 of its size: at the shrunken state energy and gradient vanish.

    >>> from skfem import MeshTri
    >>> from asterism.fem.shell.density import isotropic
    >>> from asterism.fem.shell.fields import of_stretch
    >>> sheet = Density(isotropic(membrane=20.0, bending=10.0, poisson=0.3))
    >>> shell = Shell(Argyris(MeshTri()), of_stretch(sheet, 0.9))
    >>> x = 0.9 * shell.flat
    >>> bool(shell.energy(x) < 1e-12 and np.abs(shell.gradient(x)).max() < 1e-12)
    True
    """

    def __init__(
        self,
        space: Argyris,
        fields: Fields,
        conditions: Sequence[Condition] = (),
        loads: Floats | None = None,
        order: int = QUADRATURE_ORDER,
    ) -> None:
        self.space, self.order = space, order
        self.progress = 1.0  # share of fields, loads and moved supports that acts; 1 unless they are applied in steps
        self.flat, self._ones = space.flat, space.ones  # `flat`: (N, 3) mm, the printed sheet
        self.reduction: Reduction = impose_conditions(space, conditions)  # map from the free unknowns to the states
        tabulation = space.tabulate(order)
        self.assembly = Assembly(tabulation, space.size)
        self.points = self.assembly.points  # (T, Q, 2) mm, quadrature points, where the fields are evaluated
        self._reduced = MatrixReduction(self.assembly.pattern, self.reduction.map)
        self.pattern: SparsePattern = self._reduced.pattern  # of the Hessian over the free unknowns
        self.loads = self._checked_loads(np.zeros((space.size, 3)) if loads is None else loads)
        self._set_fields(fields)

    def with_fields(self, fields: Fields, loads: Floats | None = None) -> Shell:
        """The shell with other fields and, if given, other loads (N, 3) N; this shell is unchanged.

        Space, assembly, supports and the pattern of the Hessian are shared, so a factor of one serves both. Raises
        `fem.shell.fields.FieldError` if a field is not admissible. Raises `ValueError` if the loads have another shape,
        or are not finite.
        """
        new = copy(self)
        if loads is not None:
            new.loads = self._checked_loads(loads)
        new._set_fields(fields)
        return new

    def at_progress(self, progress: float) -> Shell:
        """The shell with this share of its fields, loads and moved supports, 0 to 1; this shell is unchanged."""
        new = copy(self)
        new.progress = progress
        return new

    def with_target(self, target: Floats) -> Shell:
        """The shell with another target (3N,) mm of its supports, see `Reduction.target`; this shell is unchanged."""
        new = copy(self)
        new.reduction = replace(self.reduction, target=target)
        return new

    def _checked_loads(self, loads: Floats) -> Floats:
        loads = np.asarray(loads, dtype=float)
        if loads.shape != (self.space.size, 3) or not np.isfinite(loads).all():
            raise ValueError(f"loads must be finite, shape ({self.space.size}, 3), as of area_load: got {loads.shape}")
        return loads

    def _set_fields(self, fields: Fields) -> None:
        """Evaluate the fields at the quadrature points; all of them are checked before one is set."""
        target, gaussian = fields.rest(self.points), fields.gaussian_modulus(self.points)
        density: Density = fields.densities(self.points)
        # density and modulus (T, Q) N mm at the quadrature points
        self._target, self.density, self.gaussian_modulus = target, density, gaussian
        for name in ("_flat_tangent", "flat_stiffness"):  # cached properties of the old fields
            self.__dict__.pop(name, None)
        stretch = self.density.stiffness[..., [0, 1], [0, 1]].max(axis=-1).mean()
        # N, membrane stiffness times the square root of the area; tolerances refer to it
        self.force_scale = float(stretch * np.sqrt(self.assembly.weights.sum()))

    def constrain(self, x: Floats) -> Floats:
        """(N, 3) the state with the free unknowns of x that meets the supports at this progress."""
        return self.reduction.positions(self.reduction.project(x), self.progress)

    def restrict(self, forces: Floats) -> Floats:
        """(n,) forces on the free unknowns, from forces (N, 3) on the dofs."""
        return np.asarray(self.reduction.transposed @ forces.ravel())

    def move(self, x: Floats, direction: Floats) -> Floats:
        """(N, 3) the state x moved along a direction (n,) of the free unknowns."""
        return np.asarray(x + (self.reduction.map @ direction).reshape(-1, 3))

    def translated(self, x: Floats, by: Floats) -> Floats:
        """(N, 3) the state x translated by (3,) mm."""
        return np.asarray(x + self._ones[:, None] * by)

    def node_positions(self, x: Floats) -> Floats:
        """(k, 3) mm, the rows of x that are positions."""
        return np.asarray(x[self._ones != 0.0])

    @cached_property
    def extent(self) -> float:
        """Longer side of the printed sheet's bounding box in mm."""
        return float(np.ptp(self.node_positions(self.flat), axis=0).max())

    @cached_property
    def fixed_points(self) -> Ints:
        """(k,) dofs that are positions with all three components fixed."""
        return np.flatnonzero(self._fixed.all(axis=1))

    @cached_property
    def _fixed(self) -> NDArray[np.bool_]:
        """(N, 3) whether a component of a position is fixed."""
        free = np.diff(self.reduction.map.indptr).reshape(-1, 3) > 0
        return np.asarray(~free & (self._ones != 0.0)[:, None])

    @property
    def is_free(self) -> bool:
        """Whether the sheet has no supports at all."""
        return bool(self.reduction.map.shape[1] == self.flat.size)

    @property
    def support_level(self) -> Floats:
        """(3,) mm, mean target of the fixed components; 0 for a component that is free everywhere."""
        fixed = self._fixed * self.reduction.target.reshape(-1, 3)
        return np.asarray(fixed.sum(axis=0) / np.maximum(self._fixed.sum(axis=0), 1))

    def shifted_to_ground(self, x: Floats) -> Floats:
        """(N, 3) the state x with its lowest supported point at z = 0 if the supports leave the height free."""
        supported = self._fixed.any(axis=1)
        if self._fixed[:, 2].any() or not supported.any():
            return x
        return self.translated(x, np.array([0.0, 0.0, -x[supported, 2].min()]))

    def rigid_motions(self, x: Floats) -> Floats:
        """(n, k) orthonormal rigid motions of the state x that the supports leave free, k from 0 to 6."""
        if span_a_plane(x[self.fixed_points]):
            return np.empty((self.reduction.map.shape[1], 0))
        motions = admissible_motions(x, self._ones, self.reduction.map, self.reduction.free)
        return np.asarray(np.linalg.qr(motions)[0])

    @property
    def rest(self) -> Floats:
        """(T, Q, 6) rest values of `(a/2, b)` at this progress; those of the printed sheet at progress 0."""
        if self.progress == 1.0:
            return self._target
        return np.asarray(PRINTED_REST + self.progress * (self._target - PRINTED_REST))

    def strains(self, x: Floats) -> Floats:
        """(T, Q, 6) strains of the state x at the quadrature points; curvature components per mm."""
        return self.assembly.strains(x, self.rest)

    def energies(self, x: Floats) -> dict[str, float]:
        """Parts of the total energy, N mm.

        `sheet`: strain energy; `loads`: potential of the dead loads, zero at `support_level`, if there are any.
        """
        out = {"sheet": float((self.assembly.weights * self.density.energies(self.strains(x))).sum())}
        if self.loads.any():
            out["loads"] = -self.progress * float((self.loads * self.translated(x, -self.support_level)).sum())
        return out

    def gaussian_energy(self, x: Floats) -> float:
        """Part of the strain energy that is due to the modulus of Gaussian curvature, N mm; often negative."""
        if not self.gaussian_modulus.any():
            return 0.0
        b11, b22, b12 = np.moveaxis((self.strains(x) + self.rest)[..., 3:] * [1.0, 1.0, 0.5], -1, 0)
        return float((self.assembly.weights * self.gaussian_modulus * (b11 * b22 - b12**2)).sum())

    def energy(self, x: Floats) -> float:
        """Total energy in N mm; not finite if the surface is degenerate somewhere."""
        return sum(self.energies(x).values())

    @property
    def load_gradient(self) -> Floats:
        """(N, 3) N, gradient of the potential of the dead loads."""
        return -self.progress * self.loads

    def gradient(self, x: Floats) -> Floats:
        """(n,) N, gradient of the total energy over the free unknowns."""
        _, stress, _ = self.density(self.strains(x))
        return self.restrict(self.assembly.forces(x, stress) + self.load_gradient)

    def tangent(self, x: Floats, stiffness: Floats, stress: Floats) -> Floats:
        """(nnz,) N/mm, tangent over the free unknowns for a given stiffness (T, Q, 6, 6) and stress (T, Q, 6)."""
        return self._reduced(self.assembly.tangent(x, stiffness, stress))

    def hessian(self, x: Floats, blend: float = 0.0) -> Floats:
        """(nnz,) N/mm, Hessian over the free unknowns.

        `blend` 0 gives the exact one. `blend` 1 keeps only the tensile part of the stress, which makes the geometric
        stiffness positive semidefinite.
        """
        _, stress, stiffness = self.density(self.strains(x))
        if blend > 0.0:
            stress = (1.0 - blend) * stress + blend * tensile_part(stress)
        return self.tangent(x, stiffness, stress)

    @cached_property
    def mass(self) -> sp.csc_matrix:
        """(n, n) mm^2, mass matrix of the printed sheet over the free unknowns, with unit density."""
        return self.pattern.full(self.mass_entries)

    @cached_property
    def mass_entries(self) -> Floats:
        """(nnz,) mm^2, the mass matrix in the pattern of the Hessian."""
        return self._reduced(self.assembly.mass)

    @cached_property
    def _flat_tangent(self) -> Floats:
        stress = np.zeros((*self.assembly.weights.shape, 6))
        return self.assembly.tangent(self.flat, self.density.stiffness, stress)

    @cached_property
    def flat_stiffness(self) -> Floats:
        """(nnz,) N/mm, linear stiffness of the printed sheet without stress, over the free unknowns."""
        return self._reduced(self._flat_tangent)

    def flat_forces(self, moves: Floats) -> Floats:
        """(n,) N, forces over the free unknowns of the printed sheet under small displacements (N, 3) mm."""
        return self.restrict(self.assembly.product(self._flat_tangent, moves))

    def path(self, x: Floats, direction: Floats) -> tuple[Callable[[float], Floats], float]:
        """States along a straight line from x, as a function of the step, and the longest step."""
        step = (self.reduction.map @ direction).reshape(-1, 3)
        return (lambda a: x + a * step), 1.0

    def linear_stress(self, strains: Floats) -> Floats:
        """(T, Q, 6) stress of the quadratic part of the density."""
        return np.asarray(self.density.prestress + np.matmul(self.density.stiffness, strains[..., None])[..., 0])

    @property
    def is_rigid_invariant(self) -> bool:
        """Whether every rigid motion leaves the energy unchanged: there are neither supports nor loads."""
        return self.is_free and not self.loads.any()

    def rigid_modes(self, x: Floats) -> Floats:
        """(n, k) orthonormal: the rigid motions that leave the energy unchanged to second order."""
        motions = self.rigid_motions(x)
        if motions.shape[1] == 0 or self.is_rigid_invariant:
            return motions
        data = self.hessian(x)
        # a smaller stiffness is an effect of the gradient or of rounding; nearly degenerate triangles have stiff dofs
        min_stiffness = 10.0 * float(np.linalg.norm(self.gradient(x)))
        min_stiffness += 1e-10 * float(np.median(np.abs(data[self.pattern.diagonal])))
        largest = float(np.linalg.norm(self.pattern.product(np.abs(data), np.abs(motions)), axis=0).max())
        # a motion is neutral if its stiffness is below this part of the sum of its absolute terms. Rounding leaves
        # 1e-13, and up to 1e-10 on nearly degenerate triangles; the weight gives a swinging sheet about 1e-6.
        min_stiffness += 3e-10 * largest
        return neutral_motions(
            motions, self.pattern.product(data, motions), self.restrict(self.load_gradient), min_stiffness
        )

    def support(self, x: Floats) -> Ints:
        """(k,) free unknowns of an isostatic support: fixing them stops `rigid_modes` and causes no forces."""
        return independent_dofs(self.rigid_modes(x))

    def factor(self, backend: str = "auto") -> Factor:
        """Sparse direct solver for matrices in the pattern of this shell.

        Raises `BackendError` if the backend is not installed, or it is multigrid, which does not prove that a matrix is
        definite.
        """
        if backend == "amg":
            raise BackendError("backend: 'amg' does not work with a shell; use auto, pardiso, cholmod or superlu")
        return make_factor(self.pattern, backend)


def tensile_part(stress: Floats) -> Floats:
    """(..., 6) stress with the positive parts of the principal membrane stresses, and without moments.

    Pure shear is tension and compression at 45 degrees; the tension remains:

    >>> tensile_part(np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0]))
    array([0.5, 0.5, 0.5, 0. , 0. , 0. ])
    """
    mean = 0.5 * (stress[..., 0] + stress[..., 1])
    radius = np.hypot(0.5 * (stress[..., 0] - stress[..., 1]), stress[..., 2])
    high, low = mean + radius, mean - radius
    # the result is p I + q S; q = 1 if both principal stresses are positive, 0 if both are negative
    share = np.where(low >= 0.0, 1.0, np.where(high <= 0.0, 0.0, high / np.maximum(high - low, 1e-300)))
    lift = np.where((low < 0.0) & (high > 0.0), -low * share, 0.0)
    out = np.zeros_like(stress)
    out[..., :3] = share[..., None] * stress[..., :3]
    out[..., :2] += lift[..., None]
    return out
