"""Which dofs the pins hold, and where."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from discrete.energies.elements import Array
from pattern.layout.layout import Layout
from pattern.mesh.mesh import Mesh


@dataclass(frozen=True)
class Constraints:
    """Held components of vertices.

    Attributes
    ----------
    held : (V, 3) bool.
    printed : (V, 3) mm, places before release (of pins that take hold after it: when they do).
    target : (V, 3) mm, places at the end (where held).
    """

    held: Array
    printed: Array
    target: Array

    def positions_at(self, progress: float) -> Array:
        """(V, 3) mm; held components move straight from the printed place to the target."""
        return self.printed + progress * (self.target - self.printed)

    @property
    def mean_support(self) -> Array:
        """(3,) mm, where positions are held at the end, in the mean; 0 for components that nothing holds."""
        places = np.where(self.held, self.target, 0.0).sum(axis=0)
        return np.asarray(places / np.maximum(self.held.sum(axis=0), 1))


def pin_constraints(layout: Layout, mesh: Mesh) -> Constraints:
    """The pins of a layout on the vertices of its mesh."""
    printed = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    held = np.zeros(printed.shape, dtype=bool)
    target = printed.copy()
    for pin, vertices in zip(layout.pins, mesh.pin_vertices, strict=True):
        fixed = np.asarray(pin.fixed)
        places = pin.places(mesh.points[vertices])
        held[vertices] |= fixed
        target[vertices] = np.where(fixed, places, target[vertices])
    return Constraints(held, printed, target)
