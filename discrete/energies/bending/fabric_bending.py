"""What the model needs from a bending energy of the fabric."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from discrete.energies.bending.hinges import interior_edges
from discrete.energies.elements import Array, Elements


class FabricPlate(NamedTuple):
    """Thickness (mm), Young's modulus (MPa) and Poisson's ratio of the fabric."""

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
    closed_hinges : (H, 4) hinges of a periodic mesh, which the triangles alone do not show; None for a plain mesh.
    surrounding : (R, 3) triangles around a periodic mesh, which have no energy of their own; None for a plain mesh.
    """

    triangles: Array
    printed: Array
    closed_hinges: Array | None = None
    surrounding: Array | None = None

    @property
    def hinges(self) -> Array:
        """(H, 4) vertices of each interior edge and of the two triangles beside it."""
        return interior_edges(self.triangles) if self.closed_hinges is None else self.closed_hinges


@dataclass(frozen=True)
class FabricBending:
    """A bending energy of the fabric; `discrete.energies.bending.registry` lists all of them.

    Attributes
    ----------
    name : as in the design file, `fabric.bending`.
    parts : names of its energies in the model.
    build : makes these energies; its last argument is True for compiled loops.
    set_rest : sets them for a rest area over printed area and, if the rest shape is not similar to the print, for the
        rest shape (V, 2) mm, whose size does not matter.
    crease_factor : its stiffness at a straight crease over that of the plate of the fabric's thickness.
    needs_neighbours : an element reaches beyond its triangle's vertices, so a periodic mesh needs triangles around it.
    """

    name: str
    parts: tuple[str, ...]
    build: Callable[[BendingMesh, FabricPlate, bool], dict[str, Elements]]
    set_rest: Callable[[Mapping[str, Elements], FabricPlate, float, Array | None], None]
    crease_factor: float
    needs_neighbours: bool = False

    def energy(self, energies: Mapping[str, float]) -> float:
        """Bending energy of the fabric, N mm, from the energies of the model by part."""
        return sum(energies.get(part, 0.0) for part in self.parts)
