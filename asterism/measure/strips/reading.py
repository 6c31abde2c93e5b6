"""A strip as it was measured."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Reading:
    """One arc of one strip.

    Attributes
    ----------
    strip : its name.
    row : of the table, as a spreadsheet counts.
    thickness_mm, length_mm : of the plastic.
    stretch, fabric_thickness_mm : of the fabric it was printed on.
    peeled : without its fabric.
    curvature_per_mm : positive with the plastic outside; None for a strip that looks flat.
    left_out : why this reading cannot be used, if it cannot.
    step_mm : of the ruler, to which the sides of its box were rounded; 0 where that is not seen.
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
        """For messages."""
        return f"strip {self.strip} {'peeled' if self.peeled else 'with fabric'}"
