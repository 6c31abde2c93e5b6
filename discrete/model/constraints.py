"""The supports on the mesh: which components of which vertices are held, and where."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Array
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh


@dataclass(frozen=True)
class Constraints:
    """Held components of vertices and their prescribed motion.

    Attributes
    ----------
    held : (V, 3) bool.
    printed : (V, 3) mm, positions before the release; for pins that act after it, positions at which they take hold.
    target : (V, 3) mm, positions of the held components at the end.
    """

    held: Array
    printed: Array
    target: Array

    def positions_at(self, progress: float) -> Array:
        """(V, 3) mm, positions of held components at a progress from 0 (printed) to 1 (target), on a straight line."""
        return self.printed + progress * (self.target - self.printed)

    @property
    def mean_support(self) -> Array:
        """(3,) mm, mean target of the held components along x, y and z; 0 along an axis without supports."""
        total = np.where(self.held, self.target, 0.0).sum(axis=0)
        return np.asarray(total / np.maximum(self.held.sum(axis=0), 1))


def pin_constraints(layout: Layout, mesh: Mesh) -> Constraints:
    """The supports of a layout on the vertices of its mesh."""
    printed = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    held = np.zeros(printed.shape, dtype=bool)
    target = printed.copy()
    for pin, vertices in zip(layout.pins, mesh.pin_vertices, strict=True):
        fixed = np.asarray(pin.fixed)
        places = pin.places(mesh.points[vertices])
        held[vertices] |= fixed
        target[vertices] = np.where(fixed, places, target[vertices])
    return Constraints(held, printed, target)
