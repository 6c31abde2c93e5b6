"""The shell: a discretisation, what the sheet wants to be, what holds it and what pulls it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from equilibrium.errors import BackendError
from equilibrium.linear.factor import Factor, make_factor
from equilibrium.linear.rigid_support import independent_dofs
from equilibrium.linear.sparse_pattern import SparsePattern
from fem.elements.plain_maps import constant, flat_positions
from fem.elements.space import Space
from fem.elements.tabulation import Floats, Ints
from fem.shell.assembly import Assembly
from fem.shell.density import Density
from fem.shell.fields import Fields
from fem.shell.matrix_reduction import MatrixReduction
from fem.shell.reduced_mass import ReducedMass
from fem.shell.tension import tensile_part
from fem.supports.conditions import Condition, impose_conditions
from fem.supports.rigid import admissible_motions, neutral_motions, span_a_plane

# over the sum of absolute values, a sum that should be nothing: 1e-13, and up to 1e-10 on flat triangles. The weight
# of a sheet that swings is 1e-6 of it
ROUNDING = 3e-10
QUADRATURE_ORDER = 6  # of the quadrature: exact for the bending of quintic triangles, and frees thin ones from locking


class Potential(Protocol):
    """A load whose force depends on the position, such as `fem.supports.end_moment.EndMoment`."""

    def energy(self, positions: Floats) -> float: ...

    def gradient(self, positions: Floats) -> Floats: ...

    def hessian(self, positions: Floats) -> sp.csr_matrix: ...


class Shell:
    """Energy of a shell over positions x (N, 3) of the dofs of a space, in N mm; conditions are met exactly.

    Parameters
    ----------
    space : discretisation of the printed sheet.
    fields : rest metric, rest curvature and density.
    conditions : see `fem.supports.conditions`.
    loads : (N, 3) N, dead loads of `fem.supports.loads`.
    moments : further potentials.
    order : of the quadrature.

    Attributes
    ----------
    points : (T, Q, 2) mm, where fields are asked for.
    gaussian_modulus : (T, Q) N mm, see `fem.shell.fields.Fields`.
    pattern : of the Hessian over the free unknowns.
    progress : part of fields, loads and moved conditions that is there; 1 unless loads are stepped.

    Raises
    ------
    fem.shell.fields.FieldError, fem.supports.conditions.ConditionError
    ValueError
        Loads of another shape, or not finite.
    """

    def __init__(
        self,
        space: Space,
        fields: Fields,
        conditions: Sequence[Condition] = (),
        loads: Floats | None = None,
        moments: Sequence[Potential] = (),
        order: int = QUADRATURE_ORDER,
    ) -> None:
        self.space, self.potentials, self.order = space, tuple(moments), order
        tabulation = space.tabulate(order)
        self.assembly = Assembly(tabulation, space.size)
        self._values = tabulation.values
        self.points = self.assembly.points
        self.flat = flat_positions(space)
        self._shifts = constant(space)
        self.loads = self._checked_loads(np.zeros((space.size, 3)) if loads is None else loads)
        self.reduction = impose_conditions(space, conditions)
        self._reduced = MatrixReduction(self.assembly.pattern, self.reduction.map)
        self.pattern: SparsePattern = self._reduced.pattern
        self.progress = 1.0
        self.set_fields(fields)

    def with_fields(self, fields: Fields, loads: Floats | None = None) -> Shell:
        """The same shell with other fields, and other loads if they are given; this shell stays as it is.

        Space, assembly, supports and the pattern of the Hessian are shared: a factor of this shell serves the new one.

        Raises
        ------
        fem.shell.fields.FieldError
        ValueError
            Loads of another shape, or not finite.
        """
        new = copy(self)
        if loads is not None:
            new.loads = self._checked_loads(loads)
        new.set_fields(fields)
        return new

    def at_progress(self, progress: float) -> Shell:
        """The same shell with this part of its fields, loads and moved supports; this shell stays as it is."""
        new = copy(self)
        new.progress = progress
        return new

    def with_target(self, target: Floats) -> Shell:
        """The same shell with supports that end at other places: (3N,) mm, `Reduction.target`; this one stays."""
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

    def set_fields(self, fields: Fields) -> None:
        """Change what the sheet wants to be; everything else, factorisation patterns included, stays."""
        # all of them before any is set: each may be refused
        target, gaussian = fields.rest(self.points), fields.gaussian_modulus(self.points)
        density: Density = fields.densities(self.points)
        penalty = self.space.penalty(density.stiffness[..., 3, 3].mean(axis=1))
        self._target, self.density, self.gaussian_modulus = target, density, gaussian
        self._penalty = None if penalty is None else (penalty, self.assembly.spread(penalty))
        for name in ("_flat_tangent", "_flat_lower", "flat_stiffness"):
            self.__dict__.pop(name, None)
        stretch = self.density.stiffness[..., [0, 1], [0, 1]].max(axis=-1).mean()
        self.force_scale = float(stretch * np.sqrt(self.assembly.weights.sum()))

    @property
    def rest(self) -> Floats:
        """(T, Q, 6) what the strains are measured from, at this progress; without any it is the printed sheet."""
        printed = np.array([0.5, 0.5, 0.0, 0.0, 0.0, 0.0])
        return self._target if self.progress == 1.0 else printed + self.progress * (self._target - printed)

    def strains(self, x: Floats) -> Floats:
        """(T, Q, 6)."""
        return self.assembly.strains(x, self.rest)

    def energies(self, x: Floats) -> dict[str, float]:
        """N mm by part: `sheet`, and where there are any `loads` (what they save, from `level` on), `moments`, and
        `jumps` of the discretisation."""
        out = {"sheet": float((self.assembly.weights * self.density.energies(self.strains(x))).sum())}
        if self.loads.any():
            out["loads"] = -self.progress * float((self.loads * self.translated(x, -self.support_level)).sum())
        if self.potentials:
            out["moments"] = self.progress * sum(moment.energy(x) for moment in self.potentials)
        if self._penalty is not None:
            out["jumps"] = 0.5 * float((x * (self._penalty[0] @ x)).sum())
        return out

    def gaussian_energy(self, x: Floats) -> float:
        """N mm, the part of the sheet's energy that is due to its Gaussian curvature; often negative."""
        if not self.gaussian_modulus.any():
            return 0.0
        b11, b22, b12 = np.moveaxis((self.strains(x) + self.rest)[..., 3:] * [1.0, 1.0, 0.5], -1, 0)
        return float((self.assembly.weights * self.gaussian_modulus * (b11 * b22 - b12**2)).sum())

    def energy(self, x: Floats) -> float:
        """N mm; not finite where the sheet has collapsed."""
        return sum(self.energies(x).values())

    def external_gradient(self, x: Floats) -> Floats:
        """(N, 3) gradient of everything but the sheet's own energy."""
        out = self._push(x)
        return out if self._penalty is None else out + self._penalty[0] @ x

    def _push(self, x: Floats) -> Floats:
        """(N, 3) gradient of loads and moments."""
        out = -self.progress * self.loads
        for moment in self.potentials:
            out = out + self.progress * moment.gradient(x)
        return out

    def restrict(self, forces: Floats) -> Floats:
        """(n,) over the free unknowns, from (N, 3)."""
        return self.reduction.transposed @ forces.ravel()

    def gradient(self, x: Floats) -> Floats:
        """(n,) N over the free unknowns."""
        _, stress, _ = self.density(self.strains(x))
        return self.restrict(self.assembly.forces(x, stress) + self.external_gradient(x))

    def tangent(self, x: Floats, stiffness: Floats, stress: Floats) -> Floats:
        """(nnz,) over the free unknowns, for any stiffness (T, Q, 6, 6) and stress (T, Q, 6)."""
        data = self.assembly.tangent(x, stiffness, stress)
        for moment in self.potentials:
            data += self.progress * self.assembly.gather(moment.hessian(x))
        if self._penalty is not None:
            data += self._penalty[1]
        return self._reduced(data)

    def hessian(self, x: Floats, blend: float = 0.0) -> Floats:
        """(nnz,) exact for blend 0; for 1 positive semidefinite: of the stress only what pulls is kept."""
        _, stress, stiffness = self.density(self.strains(x))
        if blend > 0.0:
            stress = (1.0 - blend) * stress + blend * tensile_part(stress)
        return self.tangent(x, stiffness, stress)

    @cached_property
    def mass(self) -> ReducedMass:
        """mm^2, the printed area as the free unknowns see it."""
        return ReducedMass(self._scalar_mass, self.reduction)

    @cached_property
    def _scalar_mass(self) -> sp.csr_matrix:
        return self.assembly.mass(self._values)

    @cached_property
    def mass_entries(self) -> Floats:
        """(nnz,) mm^2, the mass in the pattern of the Hessian."""
        return self._reduced(self.assembly.spread(self._scalar_mass))

    @cached_property
    def _flat_tangent(self) -> Floats:
        stress = np.zeros((*self.assembly.weights.shape, 6))
        data = self.assembly.tangent(self.flat, self.density.stiffness, stress)
        return data if self._penalty is None else data + self._penalty[1]

    @cached_property
    def _flat_lower(self) -> sp.csc_matrix:
        return self.assembly.pattern.lower(self._flat_tangent)

    @cached_property
    def flat_stiffness(self) -> Floats:
        """(nnz,) of the printed sheet without stress, over the free unknowns."""
        return self._reduced(self._flat_tangent)

    def flat_forces(self, moves: Floats) -> Floats:
        """(n,) forces over the free unknowns by which the printed sheet resists small moves (N, 3)."""
        low, x = self._flat_lower, moves.ravel()
        return self.restrict(low @ x + low.T @ x - self._flat_tangent[self.assembly.pattern.diagonal] * x)

    def move(self, x: Floats, direction: Floats) -> Floats:
        """(N, 3) x moved by a direction (n,) of the free unknowns."""
        return x + (self.reduction.map @ direction).reshape(-1, 3)

    def path(self, x: Floats, direction: Floats, straight: bool) -> tuple[Callable[[float], Floats], float]:
        """Straight line of states, and the longest step along it."""
        step = (self.reduction.map @ direction).reshape(-1, 3)
        return (lambda a: x + a * step), 1.0

    def constrain(self, x: Floats) -> Floats:
        """(N, 3) the state with the free unknowns of x that meets the conditions at this progress."""
        return self.reduction.positions(self.reduction.project(x), self.progress)

    def translated(self, x: Floats, by: Floats) -> Floats:
        """(N, 3) x moved by (3,) mm."""
        return x + self._shifts[:, None] * by

    def linear_stress(self, strains: Floats) -> Floats:
        """(T, Q, 6) by the quadratic part of the density."""
        return self.density.prestress + np.matmul(self.density.stiffness, strains[..., None])[..., 0]

    @cached_property
    def extent(self) -> float:
        """mm, the larger side of the print."""
        return float(np.ptp(self.node_positions(self.flat), axis=0).max())

    @cached_property
    def fixed_points(self) -> Ints:
        """(k,) dofs that are positions and do not move."""
        return np.flatnonzero(self._fixed.all(axis=1))

    @cached_property
    def _fixed(self) -> NDArray[np.bool_]:
        """(N, 3) components of positions that do not move."""
        free = np.diff(self.reduction.map.indptr).reshape(-1, 3) > 0
        return np.asarray(~free & (self._shifts != 0.0)[:, None])

    def shifted_to_ground(self, x: Floats) -> Floats:
        """(N, 3) the state x, where conditions leave heights open with the lowest place that they hold at z = 0."""
        held = self._fixed.any(axis=1)
        if self._supports_height or not held.any():
            return x
        return self.translated(x, np.array([0.0, 0.0, -x[held, 2].min()]))

    def node_positions(self, x: Floats) -> Floats:
        """(k, 3) mm, of the dofs that are positions."""
        return np.asarray(x[self._shifts != 0.0])

    @property
    def support_level(self) -> Floats:
        """(3,) mm, where positions are held, in the mean; 0 for components that nothing holds."""
        held = self._fixed * self.reduction.target.reshape(-1, 3)
        return np.asarray(held.sum(axis=0) / np.maximum(self._fixed.sum(axis=0), 1))

    @property
    def _supports_height(self) -> bool:
        """Something is held along z."""
        return bool(self._fixed[:, 2].any())

    @property
    def is_free(self) -> bool:
        """Nothing is held."""
        return self.reduction.map.shape[1] == self.flat.size

    @property
    def is_rigid_invariant(self) -> bool:
        """Nothing holds or pulls the sheet: wherever it is, all rigid motions are free."""
        return self.is_free and not self.loads.any() and not self.potentials

    def rigid_motions(self, x: Floats) -> Floats:
        """(n, k) orthonormal rigid motions that the conditions leave free."""
        if span_a_plane(x[self.fixed_points]):
            return np.empty((self.pattern.size, 0))
        return np.linalg.qr(admissible_motions(x, self._shifts, self.reduction.map, self.reduction.free))[0]

    def rigid_modes(self, x: Floats) -> Floats:
        """(n, k) of `motions`, those that cost nothing."""
        motions = self.rigid_motions(x)
        if motions.shape[1] == 0 or self.is_rigid_invariant:
            return motions
        data = self.hessian(x)
        # stiffness that is the gradient's own, or rounding: flat triangles have stiff dofs
        least = 10.0 * float(np.linalg.norm(self.gradient(x)))
        least += 1e-10 * float(np.median(np.abs(data[self.pattern.diagonal])))
        least += ROUNDING * float(np.linalg.norm(self.pattern.product(np.abs(data), np.abs(motions)), axis=0).max())
        return neutral_motions(motions, self.pattern.product(data, motions), self.restrict(self._push(x)), least)

    def support(self, x: Floats) -> Ints:
        """(k,) free unknowns that, held, stop the rigid motions and cause no forces."""
        return independent_dofs(self.rigid_modes(x))

    def factor(self, backend: str = "auto") -> Factor:
        """A solver for the Hessians of this shell.

        Raises
        ------
        BackendError
            The backend is not installed, or multigrid, which takes longer here and proves less.
        """
        if backend == "amg":
            raise BackendError("backend: 'amg' does not work with a shell; use auto, pardiso, cholmod or superlu")
        return make_factor(self.pattern, backend)
