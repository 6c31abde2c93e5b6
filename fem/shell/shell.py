"""Shell problem: discretisation, rest state, supports and loads.

The total energy of a state x, over the printed domain, is

    Pi(x) = int W(E, K) dA  -  progress sum(loads * x)  +  progress sum_i P_i(x)  +  jumps(x),

with the strains E and K of `fem.shell.koiter`, the density W of `fem.shell.density`, dead loads, further conservative
potentials P_i, and a penalty on slope jumps if the space is not C1 (`fem.elements.lifted`). An equilibrium is a zero
of the gradient over the free unknowns q of `fem.shell.supported_sheet`; it is stable if the Hessian over q is positive
definite.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.errors import BackendError
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.rigid_support import independent_dofs
from asterism.equilibrium.linear.sparse_pattern import SparsePattern
from asterism.fem.elements.space import Space
from asterism.fem.shell.assembly import Assembly
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.matrix_reduction import MatrixReduction
from asterism.fem.shell.reduced_mass import ReducedMass
from asterism.fem.shell.supported_sheet import SupportedSheet
from asterism.fem.shell.tension import tensile_part
from asterism.fem.supports.conditions import Condition
from asterism.fem.supports.rigid import neutral_motions

# 1: stiffness of a rigid motion over the sum of its absolute terms, below which the motion is neutral. Rounding leaves
# 1e-13, and up to 1e-10 on nearly degenerate triangles; the weight gives a swinging sheet about 1e-6.
MAX_NEUTRAL_STIFFNESS = 3e-10
QUADRATURE_ORDER = (
    6  # degree, exact for the linear bending energy of quintic triangles; avoids locking of thin triangles
)
PRINTED_REST = np.array([0.5, 0.5, 0.0, 0.0, 0.0, 0.0])  # rest values (a/2, b) of the printed sheet


class Potential(Protocol):
    """Conservative load whose force depends on the state, such as `fem.supports.end_moment.EndMoment`."""

    def energy(self, positions: Floats) -> float:
        """N mm, at a state (N, 3)."""

    def gradient(self, positions: Floats) -> Floats:
        """(N, 3) N."""

    def hessian(self, positions: Floats) -> sp.csr_matrix:
        """(3N, 3N) N/mm."""


class Shell(SupportedSheet):
    """Total energy of a supported and loaded shell, with its gradient and Hessian over the free unknowns.

    A shell is never changed: `with_fields`, `at_progress` and `with_target` return another one, which shares the
    discretisation and the pattern of the Hessian.

    Parameters
    ----------
    space : discretisation of the printed sheet.
    fields : rest metric, rest curvature and density.
    conditions : supports, see `fem.supports.conditions`.
    loads : (N, 3) N, dead loads of `fem.supports.loads`.
    potentials : further conservative loads.
    order : polynomial degree that the quadrature integrates exactly.

    Attributes
    ----------
    points : (T, Q, 2) mm, quadrature points, where the fields are evaluated.
    density : energy density at these points.
    gaussian_modulus : (T, Q) N mm, see `fem.shell.fields.Fields`.
    pattern : sparsity pattern of the Hessian over the free unknowns.
    force_scale : N, membrane stiffness times the square root of the area; tolerances refer to it.
    progress : share of fields, loads and moved supports that acts; 1 unless they are applied in steps.

    Raises
    ------
    fem.shell.fields.FieldError
        A field is not finite, or the rest metric or the density is not admissible.
    fem.supports.conditions.ConditionError
        A support cannot be met.
    ValueError
        The loads have another shape, or are not finite.

    Examples
    --------
    A unit square that shrinks to 0.9 of its size: at the shrunken state energy and gradient vanish.

    >>> import numpy as np
    >>> from skfem import MeshTri
    >>> from asterism.fem.elements.argyris import Argyris
    >>> from asterism.fem.shell.density import Density, isotropic
    >>> from asterism.fem.shell.fields import of_stretch
    >>> sheet = Density(isotropic(membrane=20.0, bending=10.0, poisson=0.3))
    >>> shell = Shell(Argyris(MeshTri()), of_stretch(sheet, 0.9))
    >>> x = 0.9 * shell.flat
    >>> bool(shell.energy(x) < 1e-12 and np.abs(shell.gradient(x)).max() < 1e-12)
    True
    """

    def __init__(
        self,
        space: Space,
        fields: Fields,
        conditions: Sequence[Condition] = (),
        loads: Floats | None = None,
        potentials: Sequence[Potential] = (),
        order: int = QUADRATURE_ORDER,
    ) -> None:
        super().__init__(space, conditions)
        self.potentials, self.order = tuple(potentials), order
        tabulation = space.tabulate(order)
        self.assembly = Assembly(tabulation, space.size)
        self.points = self.assembly.points
        self._reduced = MatrixReduction(self.assembly.pattern, self.reduction.map)
        self.pattern: SparsePattern = self._reduced.pattern
        self.loads = self._checked_loads(np.zeros((space.size, 3)) if loads is None else loads)
        self._set_fields(fields)

    def with_fields(self, fields: Fields, loads: Floats | None = None) -> Shell:
        """The shell with other fields and, if given, other loads (N, 3) N; this shell is unchanged.

        Space, assembly, supports and the pattern of the Hessian are shared, so a factor of one serves both.

        Raises
        ------
        fem.shell.fields.FieldError
            A field is not admissible.
        ValueError
            The loads have another shape, or are not finite.
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
            raise ValueError(
                f"loads must be finite, shape ({self.space.size}, 3), as of fem.supports.loads: got {loads.shape}"
            )
        return loads

    def _set_fields(self, fields: Fields) -> None:
        """Evaluate the fields at the quadrature points; all of them are checked before one is set."""
        target, gaussian = fields.rest(self.points), fields.gaussian_modulus(self.points)
        density: Density = fields.densities(self.points)
        penalty = self.space.penalty(density.stiffness[..., 3, 3].mean(axis=1))
        self._target, self.density, self.gaussian_modulus = target, density, gaussian
        self._penalty = None if penalty is None else (penalty, self.assembly.expand(penalty))
        for name in ("_flat_tangent", "_flat_lower", "flat_stiffness"):  # cached properties of the old fields
            self.__dict__.pop(name, None)
        stretch = self.density.stiffness[..., [0, 1], [0, 1]].max(axis=-1).mean()
        self.force_scale = float(stretch * np.sqrt(self.assembly.weights.sum()))

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

        `sheet`: strain energy; `loads`: potential of the dead loads, zero at `support_level`; `potentials`; `jumps`:
        penalty of the discretisation. Parts that the problem does not have are left out.
        """
        out = {"sheet": float((self.assembly.weights * self.density.energies(self.strains(x))).sum())}
        if self.loads.any():
            out["loads"] = -self.progress * float((self.loads * self.translated(x, -self.support_level)).sum())
        if self.potentials:
            out["potentials"] = self.progress * sum(each.energy(x) for each in self.potentials)
        if self._penalty is not None:
            out["jumps"] = 0.5 * float((x * (self._penalty[0] @ x)).sum())
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

    def external_gradient(self, x: Floats) -> Floats:
        """(N, 3) N, gradient of all parts of the energy except the strain energy."""
        out = self._load_gradient(x)
        return out if self._penalty is None else out + self._penalty[0] @ x

    def _load_gradient(self, x: Floats) -> Floats:
        """(N, 3) N, gradient of dead loads and potentials."""
        out = -self.progress * self.loads
        for potential in self.potentials:
            out = out + self.progress * potential.gradient(x)
        return np.asarray(out)

    def gradient(self, x: Floats) -> Floats:
        """(n,) N, gradient of the total energy over the free unknowns."""
        _, stress, _ = self.density(self.strains(x))
        return self.restrict(self.assembly.forces(x, stress) + self.external_gradient(x))

    def tangent(self, x: Floats, stiffness: Floats, stress: Floats) -> Floats:
        """(nnz,) N/mm, tangent over the free unknowns for a given stiffness (T, Q, 6, 6) and stress (T, Q, 6)."""
        data = self.assembly.tangent(x, stiffness, stress)
        for potential in self.potentials:
            data += self.progress * self.assembly.gather(potential.hessian(x))
        if self._penalty is not None:
            data += self._penalty[1]
        return self._reduced(data)

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
    def mass(self) -> ReducedMass:
        """Mass matrix of the printed sheet over the free unknowns, with unit density: mm^2."""
        return ReducedMass(self.assembly.mass, self.reduction)

    @cached_property
    def mass_entries(self) -> Floats:
        """(nnz,) mm^2, the mass matrix in the pattern of the Hessian."""
        return self._reduced(self.assembly.expand(self.assembly.mass))

    @cached_property
    def _flat_tangent(self) -> Floats:
        stress = np.zeros((*self.assembly.weights.shape, 6))
        data = self.assembly.tangent(self.flat, self.density.stiffness, stress)
        return data if self._penalty is None else data + self._penalty[1]

    @cached_property
    def _flat_lower(self) -> sp.csc_matrix:
        return self.assembly.pattern.lower(self._flat_tangent)

    @cached_property
    def _flat_upper(self) -> sp.csr_matrix:
        return self._flat_lower.T

    @cached_property
    def flat_stiffness(self) -> Floats:
        """(nnz,) N/mm, linear stiffness of the printed sheet without stress, over the free unknowns."""
        return self._reduced(self._flat_tangent)

    def flat_forces(self, moves: Floats) -> Floats:
        """(n,) N, forces over the free unknowns of the printed sheet under small displacements (N, 3) mm."""
        low, x = self._flat_lower, moves.ravel()
        return self.restrict(low @ x + self._flat_upper @ x - self._flat_tangent[self.assembly.pattern.diagonal] * x)

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
        return self.is_free and not self.loads.any() and not self.potentials

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
        min_stiffness += MAX_NEUTRAL_STIFFNESS * largest
        return neutral_motions(
            motions, self.pattern.product(data, motions), self.restrict(self._load_gradient(x)), min_stiffness
        )

    def support(self, x: Floats) -> Ints:
        """(k,) free unknowns of an isostatic support: fixing them stops `rigid_modes` and causes no forces."""
        return independent_dofs(self.rigid_modes(x))

    def factor(self, backend: str = "auto") -> Factor:
        """Sparse direct solver for matrices in the pattern of this shell.

        Raises
        ------
        BackendError
            The backend is not installed, or it is multigrid, which does not prove that a matrix is definite.
        """
        if backend == "amg":
            raise BackendError("backend: 'amg' does not work with a shell; use auto, pardiso, cholmod or superlu")
        return make_factor(self.pattern, backend)
