"""The shape on one mesh of a search from coarse to fine, and its effort."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from asterism.equilibrium.arrays import Array


@dataclass(frozen=True)
class MeshLevel:
    """The shape on one mesh, and its effort.

    Attributes
    ----------
    vertices, iterations, factorisations : their numbers.
    seconds : wall time by stage.
    printed, positions : (V, 2) and (V, 3) mm, the shape.
    """

    vertices: int
    iterations: int
    factorisations: int
    seconds: dict[str, float]
    printed: Array = field(repr=False)
    positions: Array = field(repr=False)

    @property
    def cost(self) -> dict[str, Any]:
        """All attributes but the shape, for the summary."""
        names = ("vertices", "iterations", "factorisations", "seconds")
        return {name: getattr(self, name) for name in names}
