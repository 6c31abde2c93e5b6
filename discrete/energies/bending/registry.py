"""The registry of the fabric's bending energies.

A new energy needs three files: a file with its `FabricBending` beside this one, a line in `FABRIC_BENDING`, and its
name in `pattern.design.materials`.
"""

from __future__ import annotations

from discrete.energies.bending.consistent import CONSISTENT
from discrete.energies.bending.fabric_bending import FabricBending
from discrete.energies.bending.paper import PAPER

NO_BENDING = FabricBending(
    "none", (), lambda mesh, plate, compiled: {}, lambda parts, plate, area_ratio, shape: None, crease_factor=0.0
)

FABRIC_BENDING = {bending.name: bending for bending in (PAPER, CONSISTENT, NO_BENDING)}
