"""One measurement of one strip."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Reading:
    """The measured arc of a strip, with fabric or peeled.

    Attributes
    ----------
    strip : name of the strip.
    row : row of the table; the header is row 1.
    thickness_mm, length_mm : thickness and length of the plastic.
    stretch, fabric_thickness_mm : stretch and released thickness of the fabric.
    peeled : measured without fabric.
    curvature_per_mm : positive if the plastic is outside; None for a strip that looks flat.
    left_out : why this reading is not used; None if it is used.
    step_mm : step of the ruler to which the sides of the box are rounded; 0 if unknown.
    """

    strip: str
    row: int
    thickness_mm: float
    length_mm: float
    stretch: float
    fabric_thickness_mm: float
    peeled: bool
    curvature_per_mm: float | None
    left_out: str | None = None
    step_mm: float = 0.0

    @property
    def name(self) -> str:
        """Name of the reading in messages."""
        return f"strip {self.strip} {'peeled' if self.peeled else 'with fabric'}"
