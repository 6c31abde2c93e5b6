"""A sum of energies over positions and directors, with some dofs held: what Newton walks on."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from discrete.energies.elements import Array, Elements
from discrete.model.rigid import rigid_modes, rigid_motions
from discrete.model.state import State, moved_state
from equilibrium.linear.backends import make_solver
from equilibrium.linear.factor import Factor
from equilibrium.linear.rigid_support import independent_dofs
from equilibrium.linear.sparse_pattern import SparsePattern

HESSIAN_ROUNDING = 1e-13  # of the Hessian's largest entry: what it does to a rigid motion where no force acts
ELEMENTS_PER_BATCH = 8192  # elements whose Hessians are in memory, and in the processor's cache, at a time


class System:
    """Energies and dead loads of a set of vertices and rod edges.

    Parameters
    ----------
    parts : the energies by name.
    n_vertices : V.
    edges : (R, 2) vertices of the rod edges; their twists are dofs 3 V .. 3 V + R.
    held : (3 V + R,) bool, dofs that do not move.
    load : (3 V,) N, dead load; none by default.

    Attributes
    ----------
    level : (3,) mm, from where on the dead load does its work; the origin, if nothing else is said.
    free : indices of the dofs that move.
    pattern : of the Hessian over them.
    """

    def __init__(
        self, parts: dict[str, Elements], n_vertices: int, edges: Array, held: Array, load: Array | None = None
    ) -> None:
        self.parts, self.n_vertices, self.edges, self.held = parts, n_vertices, edges, held
        self.n_dofs = len(held)
        self.load = np.zeros(3 * n_vertices) if load is None else load
        self.load_datum = np.zeros(3)
        self.free = np.flatnonzero(~held)
        self.pattern = SparsePattern([part.dofs for part in parts.values()], self.n_dofs, self.free)

    def energies(self, state: State) -> dict[str, float]:
        """N mm, by part; the potential of the dead load is called gravity."""
        packed = state.packed
        with np.errstate(all="ignore"):  # a collapsed triangle is an infinite energy, not a warning
            out = {name: float(part.energies(packed).sum()) for name, part in self.parts.items()}
        if self.load.any():
            out["gravity"] = -float(self.load @ (state.positions - self.load_datum).ravel())
        return out

    def energy(self, state: State) -> float:
        """N mm; not finite where the fabric has collapsed."""
        return sum(self.energies(state).values())

    def full_gradient(self, state: State) -> Array:
        """(3 V + R,) N and N mm over all dofs; at held ones it is the reaction of what holds them."""
        packed = state.packed
        total = np.zeros(self.n_dofs)
        for part in self.parts.values():
            total += np.bincount(part.dofs.ravel(), part.gradients(packed).ravel(), self.n_dofs)
        total[: 3 * self.n_vertices] -= self.load
        return total

    def gradient(self, state: State) -> Array:
        """(free,) N and N mm."""
        return self.full_gradient(state)[self.free]

    def hessian(self, state: State, blend: float) -> Array:
        """(nnz,) entries of the lower triangle in `pattern`; see `Elements.hessians` for `blend`."""
        packed = state.packed
        return self.pattern.assemble(
            part.hessians(packed, blend, slice(start, start + ELEMENTS_PER_BATCH))
            for part in self.parts.values()
            for start in range(0, len(part), ELEMENTS_PER_BATCH)
        )

    def displacements_and_twists(self, direction: Array) -> tuple[Array, Array]:
        """Moves (V, 3) and turns (R,) of a vector over the free dofs."""
        full = np.zeros(self.n_dofs)
        full[self.free] = direction
        return full[: 3 * self.n_vertices].reshape(-1, 3), full[3 * self.n_vertices :]

    def path(self, state: State, direction: Array, straight: bool) -> tuple[Callable[[float], State], float]:
        """Curve of states leaving `state` in `direction` (free,), and the longest step along it."""
        move, turn = self.displacements_and_twists(direction)
        return (lambda a: moved_state(state, self.edges, state.positions + a * move, a * turn)), 1.0

    def rigid_modes(self, state: State) -> Array:
        """(free, k) orthonormal rigid motions that what is held leaves free, and that cost nothing.

        Where pins allow a motion to first order only (a sheet that tilts between two vertical slides), their forces
        give it a stiffness, which may be negative: such a motion is not rigid, and stays in the spectrum. So does one
        that weight gives a stiffness, however small, as to a pendulum.
        """
        modes = rigid_modes(state, self.edges, self.held, self.free)
        if modes.shape[1] == 0 or not self.held.any():
            return modes
        data = self.hessian(state, 0.0)
        stiffness = self.pattern.product(data, modes)
        size_mm = float(np.linalg.norm(state.positions - state.positions.mean(axis=0)))
        tiny = (
            HESSIAN_ROUNDING * np.abs(data[self.pattern.diagonal]).max()
            + np.linalg.norm(self.gradient(state)) / size_mm
        )
        _, size, rows = np.linalg.svd(stiffness, full_matrices=False)
        return np.asarray(modes @ rows[size < tiny].T)

    def factor(self, backend: str = "auto") -> Factor:
        """A solver for the Hessians of this system."""
        return make_solver(self.pattern, backend)

    def reachable_state(self, state: State, target: State) -> State:
        """The target, or the last state on the way to it if something is in the way; here nothing is."""
        return target

    def near_nullspace(self, state: State) -> tuple[Array, Array]:
        """What multigrid coarsens: the vertex of every free dof (free,) and the six rigid motions (free, 6).

        A twist goes with the first vertex of its rod edge. What is held is ignored: away from it the motions still
        cost nearly nothing.
        """
        vertex = np.concatenate([np.repeat(np.arange(self.n_vertices), 3), self.edges[:, 0]])[self.free]
        nodes = np.unique(vertex, return_inverse=True)[1]
        return nodes, rigid_motions(state, self.edges, np.zeros_like(self.held), self.free)

    def support(self, state: State) -> Array:
        """(k,) positions among the free dofs of an isostatic support; empty if what is held suffices."""
        motions = rigid_motions(state, self.edges, self.held, self.free)
        if motions.shape[1] and self.held.any():
            # a motion on which forces do work is not rigid (see rigid_modes), and must not be stopped
            work = motions.T @ self.gradient(state)
            rows = np.linalg.svd(work[None, :])[2]
            motions = motions @ rows[1 if np.linalg.norm(work) > 1e-12 else 0 :].T
        return independent_dofs(motions)
