"""The exact model with self-contact: its states are free of intersections."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asterism.discrete.energies.contact import ContactBarrier
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.linear.extended_pattern import ExtendedPattern, entry_keys, sorted_union
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.reanalysing_factor import ReanalysingFactor
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh

# 1: distance at which contact begins over the spacing, at most; it is the fabric's thickness if that is smaller
MAX_CONTACT_DISTANCE_FRACTION = 0.1
SAFE_STEP_FRACTION = 0.9  # 1: step taken over the largest step without intersections
# 1: entries of the pattern from earlier states over those of the present state, up to which they are kept
MAX_STALE_ENTRIES_RATIO = 3


def is_intersection_free(model: DiscreteModel, state: State) -> bool:
    """True if no parts of the state intersect, or if the model has no contact."""
    return not isinstance(model, ContactModel) or model.contact.is_intersection_free(state.positions)


class ContactModel(DiscreteModel):
    """`DiscreteModel` with a contact barrier, and paths without intersections. Parameters as there.

    Attributes
    ----------
    contact : the barrier.
    pattern : sparsity pattern of the last Hessian; another object after new pairs have come into contact.
    """

    def __init__(self, design: Design, layout: Layout, mesh: Mesh) -> None:
        super().__init__(design, layout, mesh)
        fabric = design.fabric
        distance = min(fabric.thickness_mm, MAX_CONTACT_DISTANCE_FRACTION * self.spacing)
        self.contact = ContactBarrier(mesh, distance, max(fabric.stretch_xy), fabric.modulus_mpa)
        self._base_pattern = self.pattern
        self._contact_keys: Array = np.empty(0, dtype=np.int64)
        self._pattern_positions: Array | None = None  # positions for whose contacts the pattern has entries
        self._free_index = np.full(self.n_dofs, -1, dtype=np.int64)
        self._free_index[self.free] = np.arange(len(self.free))

    def factor(self, backend: str = "auto") -> Factor:
        """A factorisation that is analysed anew when the pattern changes.

        Raises
        ------
        BackendError
            The backend is multigrid, which needs a constant pattern.
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
        needed = sorted_union(keys, nearby)
        if len(self._contact_keys) < MAX_STALE_ENTRIES_RATIO * len(needed):
            needed = sorted_union(needed, self._contact_keys)
        self._contact_keys = needed
        self.pattern = ExtendedPattern(self._base_pattern, self._contact_keys)

    def _keys(self, rows: Array, columns: Array, values: Array | None = None) -> tuple[Array, Array]:
        """(K,) keys of the entries in the lower triangle over the free dofs, and their values."""
        row, column = self._free_index[rows], self._free_index[columns]
        inside = (column >= 0) & (row >= column)
        keys = entry_keys(row[inside], column[inside], len(self.free))
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

        Raises
        ------
        DesignError
            The pins push the sheet through itself.
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
