"""The law of a motif over the sheet of a design."""

from __future__ import annotations

from dataclasses import dataclass

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.motif_law import MotifLaw, MotifValues
from asterism.pattern.design.design import Design
from asterism.pattern.design.sizing.profile import Profile
from asterism.pattern.layout.layout import Layout


@dataclass(frozen=True, eq=False)
class MotifFieldValues:
    """The law of a design's motif, evaluated with the sizes that the rods have at each place.

    Attributes
    ----------
    design, law : as given.
    outside : one line for each of the compared places on rods where sizes leave the range of the law. The nearest sizes
        in the range replace them.
    places : number of these compared places.
    """

    design: Design
    law: MotifLaw
    outside: tuple[str, ...]
    places: int

    @classmethod
    def of(cls, design: Design, layout: Layout, law: MotifLaw) -> MotifFieldValues:
        """The values of a design with its layout.

        Raises
        ------
        LawError
            The law is for another material, lattice or motif.
        """
        points = layout.points_on_rods
        return cls(design, law, law.evaluate_at(design, points).outside, len(points))

    def at(self, points: Floats) -> MotifValues:
        """The law at printed points (n, 2) mm."""
        return self.law.evaluate_at(self.design, points)

    @property
    def has_tight_curls(self) -> bool:
        """Whether much of the sheet is not scale-separated: never, since such cells have no law."""
        return False

    @property
    def is_uniform(self) -> bool:
        """Whether all copies of the motif are equal."""
        return not any(isinstance(field, Profile) for field in self.law.plan.sources(self.design))
