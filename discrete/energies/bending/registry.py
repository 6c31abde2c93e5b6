"""The registry of the fabric's bending energies, by their names in the design file.

A new energy takes three changes: a file with its `FabricBending` next to this one, an entry in `FABRIC_BENDING`, and
its name in `pattern.design.materials`.
"""

from __future__ import annotations

from asterism.discrete.energies.bending.consistent import CONSISTENT
from asterism.discrete.energies.bending.fabric_bending import FabricBending
from asterism.discrete.energies.bending.paper import PAPER

NO_BENDING = FabricBending(
    "none", (), lambda mesh, plate: {}, lambda parts, plate, area_ratio, shape: None, crease_factor=0.0
)

FABRIC_BENDING = {bending.name: bending for bending in (PAPER, CONSISTENT, NO_BENDING)}
