"""The registry of the fabric's bending energies: each module of this folder registers its own.

A new energy takes a module with its elements, and its name and stiffness in `pattern.design.materials`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from asterism.discrete.energies.elements import Elements
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.registries import load_all
from asterism.pattern.design.materials import BendingStiffness, Fabric


@dataclass(frozen=True)
class BendingMesh:
    """The printed mesh of the fabric."""

    triangles: Array  # (T, 3) vertices, counterclockwise
    printed: Array  # (V, 2) mm; of fabric with a grain the released shape, see `fabric_energies`
    # (H, 4) hinges of a periodic mesh, also those across its borders; None for a plain mesh.
    closed_hinges: Array | None = None
    # (R, 3) triangles around a periodic mesh that have no energy; None for a plain mesh.
    surrounding: Array | None = None

    @property
    def hinges(self) -> Array:
        """(H, 4) vertices of each interior edge, then the apexes of the triangles on its left and right."""
        return interior_edges(self.triangles) if self.closed_hinges is None else self.closed_hinges


@dataclass(frozen=True)
class FabricBending:
    """A bending energy of the fabric."""

    parts: tuple[str, ...]  # names of its energies in the model
    # builds these energies from the mesh and the stiffness.
    build: Callable[[BendingMesh, BendingStiffness], dict[str, Elements]]
    # sets the ratio of rest area to printed area and, if the rest shape is not similar to the print, the rest shape (V,
    # 2) mm up to its size.
    set_rest: Callable[[Mapping[str, Elements], BendingStiffness, float, Array | None], None]
    # an element uses vertices beyond its triangle, so a periodic mesh needs surrounding triangles.
    needs_neighbours: bool = False

    def energy(self, energies: Mapping[str, float]) -> float:
        """Bending energy of the fabric in N mm, from the energies of the model by part."""
        return sum(energies.get(part, 0.0) for part in self.parts)


# by their names in the design file; read it by `bending_of`
FABRIC_BENDING = {
    "none": FabricBending((), lambda mesh, stiffness: {}, lambda parts, stiffness, area_ratio, shape: None),
}


def bending_of(fabric: Fabric) -> FabricBending:
    """The bending energy of a fabric.

    >>> bending_of(Fabric(bending="paper")).parts
    ('hinges',)
    """
    load_all(__package__)
    return FABRIC_BENDING[fabric.bending]


def interior_edges(triangles: Array) -> Array:
    """(H, 4) hinges of counterclockwise triangles (T, 3), sorted by the vertices of their edges.

    >>> interior_edges(np.array([[0, 1, 2], [0, 2, 3]])).tolist()
    [[2, 0, 1, 3]]
    """
    start = triangles.ravel()
    end = np.roll(triangles, -1, axis=1).ravel()
    apex = np.roll(triangles, -2, axis=1).ravel()
    key = np.minimum(start, end).astype(np.int64) * (int(triangles.max()) + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    pair = np.flatnonzero(key[order][1:] == key[order][:-1])
    left, right = order[pair], order[pair + 1]
    return np.column_stack([start[left], end[left], apex[left], apex[right]])
