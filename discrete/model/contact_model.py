"""The exact model with self-contact: its states are free of intersections."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from asterism.discrete.energies.contact import ContactBarrier
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array, Floats, Ints
from asterism.equilibrium.errors import BackendError
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh

SAFE_STEP_FRACTION = 0.9  # 1: step taken over the largest step without intersections


def is_intersection_free(model: DiscreteModel, state: State) -> bool:
    """True if no parts of the state intersect, or if the model has no contact."""
    return not isinstance(model, ContactModel) or model.contact.is_intersection_free(state.positions)


class ContactModel(DiscreteModel):
    """`DiscreteModel` with a contact barrier, and paths without intersections. Parameters as there."""

    def __init__(self, design: Design, layout: Layout, mesh: Mesh) -> None:
        super().__init__(design, layout, mesh)
        fabric = design.fabric
        # distance at which contact begins over the spacing, at most; it is the fabric's thickness if that is smaller
        distance = min(fabric.thickness_mm, 0.1 * self.spacing)
        self.contact = ContactBarrier(mesh, distance, max(fabric.stretch_xy), fabric.modulus)
        self._base_pattern = self.pattern
        self._contact_keys: Array = np.empty(0, dtype=np.int64)
        self._pattern_positions: Array | None = None  # positions for whose contacts the pattern has entries
        self._free_index = np.full(self.n_dofs, -1, dtype=np.int64)
        self._free_index[self.free] = np.arange(len(self.free))

    def factor(self, backend: str = "auto") -> Factor:
        """A factorisation that is analysed anew when the pattern changes.

        Raises `BackendError` if the backend is multigrid, which needs a constant pattern.
        """
        return ReanalysingFactor(self, backend)

    def energies(self, state: State) -> dict[str, float]:
        """N mm, by part; the barrier has the name contact."""
        return super().energies(state) | {"contact": self.contact.energy(state.positions)}

    def full_gradient(self, state: State) -> Array:
        """(3 V + R,) N and N mm, gradient by all dofs."""
        total = super().full_gradient(state)
        total[: 3 * self.n_vertices] += self.contact.gradient(state.positions)
        return total

    def hessian(self, state: State, blend: float) -> Array:
        """(nnz,) entries of the lower triangle of the Hessian in `pattern`, which is adapted to this state."""
        if self._pattern_positions is not state.positions:  # once a state: its Hessians are added to each other
            entries, _ = self._keys(*self.contact.hessian_pattern(state.positions))
            if len(entries) and not (isinstance(self.pattern, ExtendedPattern) and self.pattern.contains(entries)):
                self._extend_pattern(state, entries)
            self._pattern_positions = state.positions
        keys, values = self._keys(*self.contact.hessian(state.positions, blend))
        data = super().hessian(state, blend)
        if isinstance(self.pattern, ExtendedPattern):
            self.pattern.add(data, keys, values)
        return data

    def _extend_pattern(self, state: State, keys: Array) -> None:
        """Add these entries to the pattern, and those of pairs nearby, since a new pattern costs a new analysis."""
        nearby, _ = self._keys(*self.contact.hessian_pattern_nearby(state.positions))
        needed = np.union1d(keys, nearby)
        # entries of the pattern from earlier states over those of the present state, up to which they are kept
        if len(self._contact_keys) < 3 * len(needed):
            needed = np.union1d(needed, self._contact_keys)
        self._contact_keys = needed
        # sparsity pattern of the last Hessian; another object after new pairs have come into contact
        self.pattern = ExtendedPattern(self._base_pattern, self._contact_keys)

    def _keys(self, rows: Array, columns: Array, values: Array | None = None) -> tuple[Array, Array]:
        """(K,) keys `column * size + row` of the entries in the lower triangle over the free dofs, and their values."""
        row, column = self._free_index[rows], self._free_index[columns]
        inside = (column >= 0) & (row >= column)
        keys = column[inside] * len(self.free) + row[inside]
        return keys, np.empty(0) if values is None else values[inside]

    def path(self, state: State, direction: Array) -> tuple[Callable[[float], State], float]:
        """Curve of states that leaves `state` in `direction`, without intersections, and the largest step along it.

        If a state of the curve of `DiscreteModel` cannot be reached on a straight line, `reachable_state` replaces it.
        """
        curve, longest = super().path(state, direction)
        computed: dict[float, State] = {}

        def safe_state_at(a: float) -> State:
            if a not in computed:
                computed[a] = self.reachable_state(state, curve(a))
            return computed[a]

        a = min(1.0, longest)
        for _ in range(8):
            target = curve(a)
            free = self._free_fraction(state, target)
            if free >= 1.0:
                computed[a] = target
                break
            # shorten the step along the curve, which rotates elements where a straight line would stretch them
            a *= max(SAFE_STEP_FRACTION * free, 0.1)
        return safe_state_at, a

    def reachable_state(self, state: State, target: State) -> State:
        """The target if the straight way to it is free of contact, else the state at most of the free way."""
        free = self._free_fraction(state, target)
        if free >= 1.0:
            return target
        aligned = self._rigidly_aligned(state.positions, target.positions)
        positions = state.positions + SAFE_STEP_FRACTION * free * (aligned - state.positions)
        return self.moved_to(state, positions)

    def apply_supports(self, state: State) -> State:
        """The state with its held components in place, as in `DiscreteModel`.

        Raises `DesignError` if the pins push the sheet through itself.
        """
        target = super().apply_supports(state)
        if target is not state and self._free_fraction(state, target) < 1.0:
            raise DesignError("solver.contact", "the pins push the sheet through itself; it cannot follow them")
        return target

    def _free_fraction(self, state: State, target: State) -> float:
        if not np.isfinite(target.positions).all():
            return 0.0
        return self.contact.collision_free_fraction(
            state.positions, self._rigidly_aligned(state.positions, target.positions)
        )

    def _rigidly_aligned(self, positions: Array, target: Array) -> Array:
        """The target, for a free sheet moved rigidly onto the positions, since rigid motions cause no contact."""
        if self.held.any():
            return target
        rotation, shift = rigid_fit(target, positions)
        return target @ rotation.T + shift


class ExtendedPattern(SparsePattern):
    """A fixed pattern and further entries. The base pattern assembles, and its entries are copied into place.

    Parameters
    ----------
    base : the fixed pattern.
    extra : (K,) keys `column * size + row` of the further entries of the lower triangle.
    """

    def __init__(self, base: SparsePattern, extra: Ints) -> None:
        self._base = base
        self.free, self.size = base.free, base.size
        column = np.repeat(np.arange(base.size, dtype=np.int64), np.diff(base.indptr))
        fixed = column * base.size + base.indices
        self._keys = np.union1d(fixed, extra)
        self._places = np.searchsorted(self._keys, fixed)
        self.indices = (self._keys % self.size).astype(np.int32)
        self.indptr = np.searchsorted(self._keys, np.arange(self.size + 1) * self.size).astype(np.int32)
        self.diagonal = self.indptr[:-1]

    def contains(self, keys: Ints) -> bool:
        """The pattern has an entry for each of the keys (K,)."""
        places = np.minimum(np.searchsorted(self._keys, keys), self.nnz - 1)
        return bool((self._keys[places] == keys).all())

    def assemble(self, element_values: Iterable[Floats]) -> Floats:
        """Sum (nnz,) of the element matrices of the base pattern; further entries are zero."""
        data = np.zeros(self.nnz)
        data[self._places] = self._base.assemble(element_values)
        return data

    def add(self, data: Floats, keys: Ints, values: Floats) -> None:
        """Add values (K,) at unique keys (K,) to `data` (nnz,), in place."""
        data[np.searchsorted(self._keys, keys)] += values


class ReanalysingFactor:
    """A `Factor` that analyses the model's sparsity pattern again when another object takes its place.

    Raises `BackendError` if the backend is multigrid: its coarse level cannot follow a changing pattern.
    """

    def __init__(self, problem: ContactModel, backend: str) -> None:
        if backend == "amg":
            raise BackendError("backend: 'amg' does not work with contact; use auto, pardiso, cholmod or superlu")
        self._problem, self._backend = problem, backend
        self._pattern = problem.pattern
        self._factor = make_factor(self._pattern, backend)
        self.name = self._factor.name

    def factorise(self, data: Floats) -> bool:
        """As in `Factor`, for entries (nnz,) in the present pattern of the problem."""
        if self._problem.pattern is not self._pattern:
            self._factor.close()
            self._pattern = self._problem.pattern
            self._factor = make_factor(self._pattern, self._backend)
        return self._factor.factorise(data)

    def solve(self, b: Floats) -> Floats:
        """As in `Factor`."""
        return self._factor.solve(b)

    def close(self) -> None:
        """As in `Factor`."""
        self._factor.close()
