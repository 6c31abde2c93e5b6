"""The interface of a bending energy of the fabric: how it is built, and how its rest state is set."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from asterism.discrete.energies.bending.hinges import interior_edges
from asterism.discrete.energies.elements import Elements
from asterism.equilibrium.arrays import Array


class FabricPlate(NamedTuple):
    """The fabric as a plate: thickness (mm), Young's modulus (MPa) and Poisson's ratio."""

    thickness: float
    modulus: float
    poisson: float


@dataclass(frozen=True)
class BendingMesh:
    """The printed mesh of the fabric.

    Attributes
    ----------
    triangles : (T, 3) vertices, counterclockwise.
    printed : (V, 2) mm.
    closed_hinges : (H, 4) hinges of a periodic mesh, also those across its borders; None for a plain mesh.
    surrounding : (R, 3) triangles around a periodic mesh that have no energy; None for a plain mesh.
    """

    triangles: Array
    printed: Array
    closed_hinges: Array | None = None
    surrounding: Array | None = None

    @property
    def hinges(self) -> Array:
        """(H, 4) vertices of each interior edge, then the apexes of the triangles on its left and right."""
        return interior_edges(self.triangles) if self.closed_hinges is None else self.closed_hinges


@dataclass(frozen=True)
class FabricBending:
    """A bending energy of the fabric; `discrete.energies.bending.registry` lists all of them.

    Attributes
    ----------
    name : value of `fabric.bending` in the design file.
    parts : names of its energies in the model.
    build : builds these energies from the mesh and the plate.
    set_rest : sets the ratio of rest area to printed area and, if the rest shape is not similar to the print, the rest
        shape (V, 2) mm up to its size.
    crease_factor : stiffness at a straight crease over that of a plate of the fabric's thickness.
    needs_neighbours : an element uses vertices beyond its triangle, so a periodic mesh needs surrounding triangles.
    """

    name: str
    parts: tuple[str, ...]
    build: Callable[[BendingMesh, FabricPlate], dict[str, Elements]]
    set_rest: Callable[[Mapping[str, Elements], FabricPlate, float, Array | None], None]
    crease_factor: float
    needs_neighbours: bool = False

    def energy(self, energies: Mapping[str, float]) -> float:
        """Bending energy of the fabric in N mm, from the energies of the model by part."""
        return sum(energies.get(part, 0.0) for part in self.parts)
