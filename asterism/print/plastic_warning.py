"""Warning of a plastic that is not the one whose stiffness the design has."""

from __future__ import annotations

from collections.abc import Iterator

from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Plastic
from asterism.print.plastic_profile import PlasticProfile
from asterism.print.profiles import load_plastic

# the plastic of the paper, whose stiffness is the default of designs
PAPER_PLASTIC = "tpu95a"


def plastic_warning(design: Design, plastic: PlasticProfile) -> Iterator[str]:
    """Yield a line if another plastic than the paper's is printed with the stiffness of the paper's."""
    ratio, paper = Plastic().modulus_ratio, load_plastic(PAPER_PLASTIC)
    if design.plastic.modulus_ratio == ratio and plastic.name != paper.name:
        yield (
            f"{plastic.name} is printed, but plastic.modulus_ratio = {ratio:g} of the design is that of {paper.name}: "
            "measure strips (asterism strips new), and give their --material"
        )
