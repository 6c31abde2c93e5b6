"""The shell: a discretisation, what the sheet wants to be, what holds it and what pulls it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from equilibrium.factor import Factor, make_factor
from equilibrium.sparse_pattern import SparsePattern
from equilibrium.support import independent_dofs
from fem.assembly import Assembly
from fem.conditions import Condition, reduce
from fem.density import Density
from fem.fields import Fields
from fem.reduced import Reduced
from fem.space import Space
from fem.tabulation import Floats, Ints

ORDER = 6  # of the quadrature: exact for the bending of quintic triangles, and frees thin ones from locking


class Potential(Protocol):
    """A load whose force depends on the position, such as `fem.end_moment.EndMoment`."""

    def energy(self, positions: Floats) -> float: ...

    def gradient(self, positions: Floats) -> Floats: ...

    def hessian(self, positions: Floats) -> sp.csr_matrix: ...


class Shell:
    """Energy of a shell over positions x (N, 3) of the dofs of a space, in N mm; conditions are met exactly.

    Parameters
    ----------
    space : discretisation of the printed sheet.
    fields : rest metric, rest curvature and density.
    conditions : see `fem.conditions`.
    loads : (N, 3) N, dead loads of `fem.loads`.
    moments : further potentials.
    order : of the quadrature.

    Attributes
    ----------
    points : (T, Q, 2) mm, where fields are asked for.
    pattern : of the Hessian over the free unknowns.
    progress : part of fields, loads and moved conditions that is there; 1 unless loads are stepped.

    Raises
    ------
    fem.fields.FieldError, fem.conditions.ConditionError
    """

    def __init__(
        self,
        space: Space,
        fields: Fields,
        conditions: Sequence[Condition] = (),
        loads: Floats | None = None,
        moments: Sequence[Potential] = (),
        order: int = ORDER,
    ) -> None:
        self.space, self.moments, self.order = space, tuple(moments), order
        tabulation = space.tabulate(order)
        self.assembly = Assembly(tabulation, space.size)
        self._values = tabulation.values
        self.points = self.assembly.points
        self.flat = flat_positions(space)
        self._shifts = constant(space)
        self.loads = np.zeros((space.size, 3)) if loads is None else np.asarray(loads, dtype=float)
        self.reduction = reduce(space, conditions)
        self._reduced = Reduced(self.assembly.pattern, self.reduction.map)
        self.pattern: SparsePattern = self._reduced.pattern
        self.progress = 1.0
        self.set_fields(fields)

    def set_fields(self, fields: Fields) -> None:
        """Change what the sheet wants to be; everything else, factorisation patterns included, stays."""
        self._target = fields.rest(self.points)
        self.density: Density = fields.densities(self.points).at(self.points.shape[:2])
        modulus = np.asarray(self.density.stiffness)[..., 3, 3]
        penalty = self.space.penalty(modulus if modulus.ndim == 0 else modulus.mean(axis=1))
        self._penalty = None if penalty is None else (penalty, self.assembly.spread(penalty))
        self.__dict__.pop("flat_stiffness", None)
        stretch = np.asarray(self.density.stiffness)[..., [0, 1], [0, 1]].max(axis=-1).mean()
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
        """N mm by part: `sheet`, and where there are any `loads`, `moments`, and `jumps` of the discretisation."""
        out = {"sheet": float((self.assembly.weights * self.density(self.strains(x))[0]).sum())}
        if self.loads.any():
            out["loads"] = -self.progress * float((self.loads * x).sum())
        if self.moments:
            out["moments"] = self.progress * sum(moment.energy(x) for moment in self.moments)
        if self._penalty is not None:
            out["jumps"] = 0.5 * float((x * (self._penalty[0] @ x)).sum())
        return out

    def energy(self, x: Floats) -> float:
        """N mm; not finite where the sheet has collapsed."""
        return sum(self.energies(x).values())

    def outer_forces(self, x: Floats) -> Floats:
        """(N, 3) gradient of everything but the sheet's own energy."""
        out = -self.progress * self.loads
        for moment in self.moments:
            out = out + self.progress * moment.gradient(x)
        return out if self._penalty is None else out + self._penalty[0] @ x

    def restricted(self, forces: Floats) -> Floats:
        """(n,) over the free unknowns, from (N, 3)."""
        return self.reduction.map.T @ forces.ravel()

    def gradient(self, x: Floats) -> Floats:
        """(n,) N over the free unknowns."""
        _, stress, _ = self.density(self.strains(x))
        return self.restricted(self.assembly.forces(x, stress) + self.outer_forces(x))

    def tangent(self, x: Floats, stiffness: Floats, stress: Floats) -> Floats:
        """(nnz,) over the free unknowns, for any stiffness (T, Q, 6, 6) and stress (T, Q, 6)."""
        data = self.assembly.tangent(x, stiffness, stress)
        for moment in self.moments:
            data += self.progress * self.assembly.gather(moment.hessian(x))
        if self._penalty is not None:
            data += self._penalty[1]
        return self._reduced(data)

    def hessian(self, x: Floats, blend: float = 0.0) -> Floats:
        """(nnz,) exact for blend 0; for 1 positive semidefinite: of the stress only what pulls is kept."""
        _, stress, stiffness = self.density(self.strains(x))
        if blend > 0.0:
            stress = (1.0 - blend) * stress + blend * _pulling(stress)
        return self.tangent(x, stiffness, stress)

    @cached_property
    def mass(self) -> sp.csr_matrix:
        """(n, n) mm^2, the printed area as the free unknowns see it."""
        scalar = self.assembly.mass(self._values)
        full = sp.kron(scalar, sp.identity(3), format="csr")
        return sp.csr_matrix(self.reduction.map.T @ full @ self.reduction.map)

    @cached_property
    def flat_stiffness(self) -> Floats:
        """(nnz,) of the printed sheet without stress, over the free unknowns."""
        stress = np.zeros((*self.assembly.weights.shape, 6))
        stiffness = np.ascontiguousarray(np.broadcast_to(self.density.stiffness, (*stress.shape, 6)))
        data = self.assembly.tangent(self.flat, stiffness, stress)
        return self._reduced(data if self._penalty is None else data + self._penalty[1])

    def move(self, x: Floats, direction: Floats) -> Floats:
        """(N, 3) x moved by a direction (n,) of the free unknowns."""
        return x + (self.reduction.map @ direction).reshape(-1, 3)

    def path(self, x: Floats, direction: Floats, straight: bool) -> tuple[Callable[[float], Floats], float]:
        """Straight line of states, and the longest step along it."""
        step = (self.reduction.map @ direction).reshape(-1, 3)
        return (lambda a: x + a * step), 1.0

    def held(self, x: Floats) -> Floats:
        """(N, 3) the state with the free unknowns of x that meets the conditions at this progress."""
        return self.reduction.positions(self.reduction.project(x), self.progress)

    def shifted(self, x: Floats, by: Floats) -> Floats:
        """(N, 3) x moved by (3,) mm."""
        return x + self._shifts[:, None] * by

    def linear_stress(self, strains: Floats) -> Floats:
        """(T, Q, 6) by the quadratic part of the density."""
        return np.matmul(self.density.stiffness, strains[..., None])[..., 0]

    @property
    def held_points(self) -> Ints:
        """(k,) dofs that are positions and do not move."""
        free = np.diff(self.reduction.map.indptr).reshape(-1, 3).any(axis=1)
        return np.flatnonzero(~free & (self._shifts != 0.0))

    @property
    def is_free(self) -> bool:
        """Nothing is held."""
        return self.reduction.map.shape[1] == self.flat.size

    def rigid_modes(self, x: Floats) -> Floats:
        """(n, k) orthonormal rigid motions that the conditions leave free, and that cost nothing.

        Motions on which loads act like springs stay in the spectrum.
        """
        centred = x - self._shifts[:, None] * x[self._shifts != 0.0].mean(axis=0)
        centred /= np.sqrt((centred**2).mean()) + 1e-30
        motions = np.zeros((*x.shape, 6))
        for i in range(3):  # shifts, and turns about the axes
            j, k = (i + 1) % 3, (i + 2) % 3
            motions[:, i, i] = self._shifts
            motions[:, j, 3 + i], motions[:, k, 3 + i] = -centred[:, k], centred[:, j]
        motions = motions.reshape(x.size, 6)[:, : 3 if self.moments else 6]
        free = motions[self.reduction.free]
        if not self.is_free:
            _, blocked, rows = np.linalg.svd(motions - self.reduction.map @ free, full_matrices=False)
            free = free @ rows[blocked < 1e-9 * np.sqrt(x.size)].T
        if self.loads.any() and free.shape[1]:
            work = self.restricted(self.loads) @ free
            rows = np.linalg.svd(work[None, :])[2]
            free = free @ rows[1 if np.linalg.norm(work) > 1e-9 * np.linalg.norm(self.loads) else 0 :].T
        return np.linalg.qr(free)[0]

    def support(self, x: Floats) -> Ints:
        """(k,) free unknowns that, held, stop the rigid motions and cause no forces."""
        return independent_dofs(self.rigid_modes(x))

    def factor(self, backend: str = "auto") -> Factor:
        """A solver for the Hessians of this shell."""
        return make_factor(self.pattern, backend)


def flat_positions(space: Space) -> Floats:
    """(N, 3) the printed sheet."""

    def gradient(p: Floats) -> Floats:
        return np.broadcast_to(np.eye(3)[:, :2], (len(p), 3, 2))

    return space.interpolate(lambda p: np.column_stack([p, np.zeros(len(p))]), gradient, _none)


def constant(space: Space) -> Floats:
    """(N,) the function one."""
    one = space.interpolate(lambda p: np.ones((len(p), 3)), lambda p: np.zeros((len(p), 3, 2)), _none)
    return np.ascontiguousarray(one[:, 0])


def _none(points: Floats) -> Floats:
    return np.zeros((len(points), 3, 3))


def _pulling(stress: Floats) -> Floats:
    """(..., 6) positive part of the membrane stress, no bending."""
    middle = 0.5 * (stress[..., 0] + stress[..., 1])
    radius = np.hypot(0.5 * (stress[..., 0] - stress[..., 1]), stress[..., 2])
    high, low = middle + radius, middle - radius
    # a symmetric matrix with these principal values is p + q S; both positive: itself, both negative: nothing
    share = np.where(low >= 0.0, 1.0, np.where(high <= 0.0, 0.0, high / np.maximum(high - low, 1e-300)))
    lift = np.where((low < 0.0) & (high > 0.0), -low * share, 0.0)
    out = np.zeros_like(stress)
    out[..., :3] = share[..., None] * stress[..., :3]
    out[..., :2] += lift[..., None]
    return out
