"""The exact model of a sheet that does not pass through itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from discrete.energies.contact import ContactBarrier
from discrete.energies.elements import Array
from discrete.model.discrete_model import DiscreteModel
from discrete.model.state import State, moved_state
from equilibrium.linear.extended_pattern import ExtendedPattern, entry_keys, sorted_union
from equilibrium.linear.factor import Factor
from equilibrium.linear.reanalysing_factor import ReanalysingFactor
from pattern.design.design import Design
from pattern.design.errors import DesignError
from pattern.geometry.rigid_fit import rigid_fit
from pattern.layout.layout import Layout
from pattern.mesh.mesh import Mesh

# Contact begins at the thickness of the fabric, or at this fraction of the spacing if that is smaller.
MAX_CONTACT_DISTANCE_FRACTION = 0.1
SAFE_STEP_FRACTION = 0.9  # of a step without intersections


def is_intersection_free(model: DiscreteModel, state: State) -> bool:
    """Whether no parts of a state pass through each other, where the model has contact."""
    return not isinstance(model, ContactModel) or model.contact.is_intersection_free(state.positions)


class ContactModel(DiscreteModel):
    """`DiscreteModel` with a contact barrier. Its paths are free of intersections. Parameters as there.

    Attributes
    ----------
    contact : the barrier.
    pattern : of the Hessian; another object when new pairs have come into contact.
    """

    def __init__(self, design: Design, layout: Layout, mesh: Mesh, compiled: bool = True) -> None:
        super().__init__(design, layout, mesh, compiled)
        fabric = design.fabric
        distance = min(fabric.thickness_mm, MAX_CONTACT_DISTANCE_FRACTION * self.spacing)
        self.contact = ContactBarrier(mesh, distance, max(fabric.stretch_xy), fabric.modulus_mpa)
        self._base_pattern = self.pattern
        self._contact_keys: Array = np.empty(0, dtype=np.int64)
        self._pattern_positions: Array | None = None  # positions whose contacts the pattern holds
        self._free_index = np.full(self.n_dofs, -1, dtype=np.int64)
        self._free_index[self.free] = np.arange(len(self.free))

    def factor(self, backend: str = "auto") -> Factor:
        """A factorisation that follows the pattern.

        Raises
        ------
        BackendError
            The backend is multigrid, which knows one pattern only.
        """
        return ReanalysingFactor(self, backend)

    def energies(self, state: State) -> dict[str, float]:
        """N mm, by part."""
        return super().energies(state) | {"contact": self.contact.energy(state.positions)}

    def full_gradient(self, state: State) -> Array:
        """(3 V + R,) N and N mm over all dofs."""
        total = super().full_gradient(state)
        total[: 3 * self.n_vertices] += self.contact.gradient(state.positions)
        return total

    def hessian(self, state: State, blend: float) -> Array:
        """(nnz,) entries of the lower triangle in `pattern`, which belongs to this state from now on."""
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
        """Make room for these entries and those that may follow soon: every new pattern is analysed anew."""
        soon, _ = self._keys(*self.contact.hessian_pattern_nearby(state.positions))
        wanted = sorted_union(keys, soon)
        self._contact_keys = (
            sorted_union(wanted, self._contact_keys) if len(self._contact_keys) < 3 * len(wanted) else wanted
        )
        self.pattern = ExtendedPattern(self._base_pattern, self._contact_keys)

    def _keys(self, rows: Array, columns: Array, values: Array | None = None) -> tuple[Array, Array]:
        """(K,) keys in the lower triangle over the free dofs, and their values."""
        row, column = self._free_index[rows], self._free_index[columns]
        inside = (column >= 0) & (row >= column)
        keys = entry_keys(row[inside], column[inside], len(self.free))
        return keys, np.empty(0) if values is None else values[inside]

    def path(self, state: State, direction: Array, straight: bool = False) -> tuple[Callable[[float], State], float]:
        """Curve of states leaving `state` in `direction`; all of them can be reached without passing through anything.

        A state of the model's own curve that cannot be reached straight is replaced by one on the straight way to it.
        """
        curve, longest = super().path(state, direction, straight)
        known: dict[float, State] = {}

        def safe(a: float) -> State:
            if a not in known:
                known[a] = self.reachable_state(state, curve(a))
            return known[a]

        a = min(1.0, longest)
        for _ in range(8):
            target = curve(a)
            free = self._free_fraction(state, target)
            if free >= 1.0:
                known[a] = target
                break
            # shorter steps along the curve, which turns where a straight way would stretch
            a *= max(SAFE_STEP_FRACTION * free, 0.1)
        return safe, a

    def reachable_state(self, state: State, target: State) -> State:
        """The target if it can be reached straight, else most of the way that is free."""
        free = self._free_fraction(state, target)
        if free >= 1.0:
            return target
        aligned = self._rigidly_aligned(state.positions, target.positions)
        positions = state.positions + SAFE_STEP_FRACTION * free * (aligned - state.positions)
        return moved_state(state, self.edges, positions, np.zeros(len(self.edges)))

    def apply_supports(self, state: State) -> State:
        """As in `DiscreteModel`.

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
        """Target turned and shifted onto the positions: how a free sheet moves as a whole makes no difference."""
        if self.held.any():
            return target
        rotation, shift = rigid_fit(target, positions)
        return target @ rotation.T + shift
