"""A sum of energies over positions and directors with some dofs held: the problem that Newton's method minimises."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from asterism.discrete.energies.elements import Elements
from asterism.discrete.model.state import State, edge_tangents, moved_state
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.linear.backends import make_solver
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern, independent_dofs

# elements whose Hessians are in memory at a time; so many fit in the cache of the processor
ELEMENTS_PER_BATCH = 1024


class System:
    """Energies and dead loads over vertices and rod edges: an `equilibrium.newton.problem.Problem`.

    Parameters
    ----------
    parts : the energies by name.
    n_vertices : number V of vertices.
    edges : (R, 2) vertices of the rod edges; their twists are the dofs 3 V to 3 V + R.
    held : (3 V + R + 3 J,) bool, dofs that do not move. The last 3 J are the spins of the joints.
    load : (3 V,) N, dead load; zero by default.
    joint_vertices : (J,) vertices of the joints; none by default.

    A spring of one rod edge (EA = 100 N, 10 mm) that carries 1 N at its end, with only that end free to move along x:

    >>> from asterism.discrete.energies.rods.rod import RodStretch
    >>> from asterism.equilibrium.newton.minimise import minimise
    >>> spring = RodStretch(np.arange(6)[None], np.arange(6)[None], np.array([[100.0, 10.0]]))
    >>> edges, held = np.array([[0, 1]]), np.array([True, True, True, False, True, True, True])
    >>> system = System({"spring": spring}, 2, edges, held, load=np.array([0, 0, 0, 1.0, 0, 0]))
    >>> start = State(np.array([[0, 0, 0], [10, 0, 0.0]]), np.array([[0, 0, 1.0]]))
    >>> result = minimise(system, start, system.factor("superlu"), tolerance=1e-9)
    >>> round(float(result.state.positions[1, 0]), 6)
    10.1
    """

    def __init__(
        self,
        parts: dict[str, Elements],
        n_vertices: int,
        edges: Array,
        held: Array,
        load: Array | None = None,
        joint_vertices: Array | None = None,
    ) -> None:
        self.parts, self.n_vertices, self.edges, self.held = parts, n_vertices, edges, held
        self.n_dofs = len(held)
        self.load = np.zeros(3 * n_vertices) if load is None else load
        self.joint_vertices = np.empty(0, dtype=np.int64) if joint_vertices is None else joint_vertices
        # (3,) mm, position at which the potential of the dead load is zero; the origin by default
        self.load_datum = np.zeros(3)
        self.free = np.flatnonzero(~held)  # indices of the dofs that move
        # a unit cell is initialised again with other parts
        vars(self).pop("pattern", None)

    @cached_property
    def pattern(self) -> SparsePattern:
        """Sparsity pattern of the Hessian over the free dofs; made at the first use."""
        return SparsePattern([part.dofs for part in self.parts.values()], self.n_dofs, self.free)

    def energies(self, state: State) -> dict[str, float]:
        """N mm, by part. The potential of a dead load has the name gravity."""
        packed = state.packed
        with np.errstate(all="ignore"):  # a collapsed triangle is an infinite energy, not a warning
            out = {name: float(part.energies(packed).sum()) for name, part in self.parts.items()}
        if self.load.any():
            out["gravity"] = -float(self.load @ (state.positions - self.load_datum).ravel())
        return out

    def energy(self, state: State) -> float:
        """N mm; not finite if a triangle has collapsed."""
        return sum(self.energies(state).values())

    def full_gradient(self, state: State) -> Array:
        """(3 V + R + 3 J,) N and N mm, gradient by all dofs; at held dofs it is the reaction of the supports."""
        packed = state.packed
        total = np.zeros(self.n_dofs)
        for part in self.parts.values():
            total += np.bincount(part.dofs.ravel(), part.gradients(packed).ravel(), self.n_dofs)
        total[: 3 * self.n_vertices] -= self.load
        return total

    def gradient(self, state: State) -> Array:
        """(free,) N and N mm, gradient by the free dofs."""
        return self.full_gradient(state)[self.free]

    def hessian(self, state: State, blend: float) -> Array:
        """(nnz,) entries of the lower triangle of the Hessian in `pattern`; `blend` as in `Elements.hessians`."""
        packed = state.packed
        return self.pattern.assemble(
            part.hessians(packed, blend, slice(start, start + ELEMENTS_PER_BATCH))
            for part in self.parts.values()
            for start in range(0, len(part), ELEMENTS_PER_BATCH)
        )

    def motions(self, direction: Array) -> tuple[Array, Array, Array]:
        """Displacements (V, 3), twists (R,) and spins (J, 3) of a vector over the free dofs; zero at held dofs."""
        full = np.zeros(self.n_dofs)
        full[self.free] = direction
        move, turn, spin = np.split(full, [3 * self.n_vertices, 3 * self.n_vertices + len(self.edges)])
        return move.reshape(-1, 3), turn, spin.reshape(-1, 3)

    def path(self, state: State, direction: Array) -> tuple[Callable[[float], State], float]:
        """Curve of states that leaves `state` in `direction` (free,), and the largest step along it. Here: straight."""
        move, turn, spin = self.motions(direction)
        return (lambda a: moved_state(state, self.edges, state.positions + a * move, a * turn, a * spin)), 1.0

    def rigid_modes(self, state: State) -> Array:
        """(free, k) orthonormal rigid motions that the supports allow and that cost no energy.

        Supports may allow a rigid motion only to first order, as a sheet may tilt between two vertical slides. Then the
        support forces give it a stiffness, possibly a negative one, and it stays in the spectrum. The same holds for a
        motion that gets a stiffness from the weight, as a pendulum does.
        """
        modes = np.linalg.qr(rigid_motions(state, self.edges, self.held, self.free))[0]
        if modes.shape[1] == 0 or not self.held.any():
            return modes
        data = self.hessian(state, 0.0)
        stiffness = self.pattern.product(data, modes)
        size_mm = float(np.linalg.norm(state.positions - state.positions.mean(axis=0)))
        # by rounding alone, the product of Hessian and rigid motion over the largest entry of the Hessian is 1e-13
        rounding = 1e-13 * np.abs(data[self.pattern.diagonal]).max() + np.linalg.norm(self.gradient(state)) / size_mm
        _, size, rows = np.linalg.svd(stiffness, full_matrices=False)
        return np.asarray(modes @ rows[size < rounding].T)

    def factor(self, backend: str = "auto") -> Factor:
        """Linear solver for the Hessians of this system; backends as in `equilibrium.linear.backends`."""
        return make_solver(self.pattern, backend)

    def reachable_state(self, state: State, target: State) -> State:
        """The target, or the last state on the straight way to it without intersections. Here: the target."""
        return target

    @property
    def vertex_of_dofs(self) -> Array:
        """(n_dofs,) vertex that each dof belongs to: a twist to the first of its rod edge, a spin to its joint."""
        own = np.repeat(np.arange(self.n_vertices), 3)
        return np.concatenate([own, self.edges[:, 0], np.repeat(self.joint_vertices, 3)])

    def near_nullspace(self, state: State) -> tuple[Array, Array]:
        """Vertex of every free dof (free,) and the six rigid motions (free, 6), for multigrid.

        Supports are ignored, since away from them rigid motions still cost almost no energy.
        """
        nodes = np.unique(self.vertex_of_dofs[self.free], return_inverse=True)[1]
        return nodes, rigid_motions(state, self.edges, np.zeros_like(self.held), self.free)

    def support(self, state: State) -> Array:
        """(k,) positions among the free dofs of an isostatic support; empty if the supports prevent rigid motions."""
        motions = rigid_motions(state, self.edges, self.held, self.free)
        if motions.shape[1] and self.held.any():
            # a motion on which forces do work is not a rigid mode (see `rigid_modes`) and stays free
            work = motions.T @ self.gradient(state)
            rows = np.linalg.svd(work[None, :])[2]
            motions = motions @ rows[1 if np.linalg.norm(work) > 1e-12 else 0 :].T
        return independent_dofs(motions)


def rigid_motions(state: State, edges: Array, held: Array, free: Array) -> Array:
    """(free, k) linearly independent rigid motions that move no held dof, k from 0 to 6.

    A rotation `w` of the body twists an edge with tangent t by `w . t` relative to parallel transport, and spins joints
    by `w`.

    Parameters
    ----------
    edges : (R, 2) vertices of the rod edges.
    held : (3 V + R + 3 J,) bool, dofs that do not move.
    free : indices of the other dofs.
    """
    n = len(state.positions)
    x = state.positions - state.positions.mean(axis=0)
    size = np.sqrt((x**2).sum(axis=1).mean()) + 1e-30  # scales rotations to the length of translations
    n_twists, n_joints = len(edges), len(state.frames)
    # one motion a row: short rows of a large array are slow
    modes = np.zeros((6, 3 * n + n_twists + 3 * n_joints))
    moves, twists = modes[:, : 3 * n].reshape(6, n, 3), modes[:, 3 * n : 3 * n + n_twists]
    spins = modes[:, 3 * n + n_twists :].reshape(6, n_joints, 3)
    twists[3:] = edge_tangents(state.positions, edges).T / size
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        moves[i, :, i] = 1.0
        # the cross product of axis i and the position
        moves[3 + i, :, j], moves[3 + i, :, k] = -x[:, k] / size, x[:, j] / size
        spins[3 + i, :, i] = 1.0 / size
    blocked = modes[:, held]
    if blocked.shape[1]:
        values, vectors = np.linalg.eigh(blocked @ blocked.T)
        modes = vectors[:, values < 1e-12 * blocked.shape[1]].T @ modes
    return modes[:, free].T
