"""Fabric bending `paper`: the hinge energy of the paper. Its stiffness depends on the mesh."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from asterism.discrete.energies.bending.fabric_bending import BendingMesh, FabricBending, FabricPlate
from asterism.discrete.energies.bending.hinges import Hinges, paper_coefficients
from asterism.discrete.energies.elements import Elements
from asterism.equilibrium.arrays import Array


def _build(mesh: BendingMesh, plate: FabricPlate) -> dict[str, Elements]:
    hinges = mesh.hinges
    return {"hinges": Hinges(hinges, paper_coefficients(hinges, mesh.printed, *plate))}


def _set_rest(parts: Mapping[str, Elements], plate: FabricPlate, area_ratio: float, shape: Array | None) -> None:
    if shape is not None:
        hinges = cast(Hinges, parts["hinges"])
        hinges.params[:, 0] = paper_coefficients(hinges.vertices, shape, *plate)


# on equilateral triangles bent to a cylinder these hinges are three times as stiff as the plate
PAPER = FabricBending("paper", ("hinges",), _build, _set_rest, crease_factor=3.0)
