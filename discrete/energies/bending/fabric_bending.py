"""The bending energies of the fabric, by their names in the design file.

A new energy takes a class of elements, an entry in `FABRIC_BENDING`, and its name and stiffness in
`pattern.design.materials`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import cast

from asterism.discrete.energies.bending.hinges import Hinges, fold_coefficients, hinge_coefficients, interior_edges
from asterism.discrete.energies.bending.plate import Plate
from asterism.discrete.energies.elements import Elements
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.materials import BendingStiffness


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


def _hinges(mesh: BendingMesh, stiffness: BendingStiffness) -> dict[str, Elements]:
    hinges = mesh.hinges
    return {"hinges": Hinges(hinges, hinge_coefficients(hinges, mesh.printed, stiffness.d11))}


def _set_rest_of_hinges(
    parts: Mapping[str, Elements], stiffness: BendingStiffness, area_ratio: float, shape: Array | None
) -> None:
    if shape is not None:
        hinges = cast(Hinges, parts["hinges"])
        hinges.params[:, 0] = hinge_coefficients(hinges.vertices, shape, stiffness.d11)


def _plate(mesh: BendingMesh, stiffness: BendingStiffness) -> dict[str, Elements]:
    hinges = mesh.hinges
    return {
        "plate": Plate(mesh.triangles, mesh.printed, stiffness, mesh.surrounding),
        "folds": Hinges(hinges, 0.0, fold_coefficients(hinges, mesh.printed, stiffness.mean)),
    }


def _set_rest_of_plate(
    parts: Mapping[str, Elements], stiffness: BendingStiffness, area_ratio: float, shape: Array | None
) -> None:
    cast(Plate, parts["plate"]).set_rest_area(area_ratio)
    if shape is not None:
        folds = cast(Hinges, parts["folds"])
        folds.params[:, 1] = fold_coefficients(folds.vertices, shape, stiffness.mean)


PLATE = FabricBending(("plate", "folds"), _plate, _set_rest_of_plate, needs_neighbours=True)
FABRIC_BENDING = {
    "paper": FabricBending(("hinges",), _hinges, _set_rest_of_hinges),
    "plate": PLATE,
    "consistent": PLATE,
    "none": FabricBending((), lambda mesh, stiffness: {}, lambda parts, stiffness, area_ratio, shape: None),
}
