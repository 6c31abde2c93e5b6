"""Fabric bending `consistent`: a plate of the fabric's thickness, and a fold energy at its edges.

The fold energy bounds the angle between adjacent triangles; it vanishes on a fine mesh (`fold_coefficients`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from asterism.discrete.energies.bending.fabric_bending import BendingMesh, FabricBending, FabricPlate
from asterism.discrete.energies.bending.hinges import Hinges, fold_coefficients
from asterism.discrete.energies.bending.plate import Plate
from asterism.discrete.energies.elements import Elements
from asterism.equilibrium.arrays import Array


def _build(mesh: BendingMesh, plate: FabricPlate) -> dict[str, Elements]:
    hinges = mesh.hinges
    return {
        "plate": Plate(mesh.triangles, mesh.printed, *plate, surrounding=mesh.surrounding),
        "folds": Hinges(hinges, 0.0, fold_coefficients(hinges, mesh.printed, *plate)),
    }


def _set_rest(parts: Mapping[str, Elements], plate: FabricPlate, area_ratio: float, shape: Array | None) -> None:
    cast(Plate, parts["plate"]).set_rest_area(area_ratio)
    if shape is not None:
        folds = cast(Hinges, parts["folds"])
        folds.params[:, 1] = fold_coefficients(folds.vertices, shape, *plate)


CONSISTENT = FabricBending(
    "consistent", ("plate", "folds"), _build, _set_rest, crease_factor=1.0, needs_neighbours=True
)
