"""What a picture needs of a shape. `Shape` has it, and draws itself by this room."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, Self

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.layout.layout import Layout


class Drawable(Protocol):
    """A sheet in space with its arms, supports and numbers; attributes as of `asterism.shape.shape.Shape`."""

    @property
    def printed(self) -> np.ndarray:
        """(V, 2) mm."""

    @property
    def positions(self) -> np.ndarray:
        """(V, 3) mm."""

    @property
    def triangles(self) -> np.ndarray:
        """(T, 3)."""

    @property
    def rods(self) -> Sequence[np.ndarray]:
        """Vertices of each arm."""

    @property
    def rod_fields(self) -> Mapping[str, np.ndarray]:
        """Arrays over the edges of all rods."""

    @property
    def summary(self) -> Mapping[str, Any]:
        """The numbers of the caption."""

    @property
    def held(self) -> bool:
        """Whether pins support the sheet."""

    @property
    def layout(self) -> Layout | None:
        """The layout with the pins."""

    @property
    def height_mm(self) -> float:
        """Extent along z."""

    @property
    def extent_mm(self) -> tuple[float, float, float]:
        """Size of the bounding box."""

    def at(self, printed_points: Floats, off_sheet_mm: float = 0.0) -> Floats:
        """Positions in space of printed points."""

    def aligned(self) -> Self:
        """A copy turned to its principal axes."""
