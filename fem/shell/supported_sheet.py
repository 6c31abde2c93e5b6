"""Kinematics of a supported sheet: states that meet the supports, and the rigid motions that the supports leave free.

A state is `x` (N, 3), the coefficients of the position in the basis of the space. The supports write it as
`x = T q + c(progress)` with n free unknowns q (`fem.supports.conditions.Reduction`). In a space with derivatives among
its dofs only some rows of `x` are positions: those whose coefficient in the constant function one is not zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.elements.plain_maps import constant, flat_positions
from asterism.fem.elements.space import Space
from asterism.fem.supports.conditions import Condition, Reduction, impose_conditions
from asterism.fem.supports.rigid import admissible_motions, span_a_plane


class SupportedSheet:
    """States of a printed sheet that meet its supports.

    Parameters
    ----------
    space : discretisation of the printed sheet.
    conditions : supports, see `fem.supports.conditions`.

    Attributes
    ----------
    flat : (N, 3) mm, the printed sheet.
    reduction : map from the free unknowns to the states.
    progress : share of the way from the printed to the target positions that moved supports have gone, 0 to 1.

    Raises
    ------
    fem.supports.conditions.ConditionError
        A support cannot be met.
    """

    def __init__(self, space: Space, conditions: Sequence[Condition] = ()) -> None:
        self.space = space
        self.flat = flat_positions(space)
        self._ones = constant(space)
        self.reduction: Reduction = impose_conditions(space, conditions)
        self.progress = 1.0

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
