"""Other forms of a sheet: minima that a preview met on its way to the one that it shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pattern.layout.likeness import distances

if TYPE_CHECKING:
    from asterism.previews.session import Preview

FEWEST = 3  # star centres that tell forms apart
EQUAL = 2.0  # % of the diameter within which two are one form


@dataclass(frozen=True)
class OtherForm:
    """A minimum of the sheet that is not the one shown.

    Attributes
    ----------
    start : name of the start that led to it.
    energy_n_mm : its energy.
    gap : by how much that is above the energy of the form that is shown, as a part of what is at stake there.
    distance_percent : rms over the star centres from the form that is shown, after the rigid motion and the symmetry of
        the design that bring them together, in % of the diameter.
    """

    start: str
    energy_n_mm: float
    gap: float
    distance_percent: float


def other_forms(preview: Preview, diameter_mm: float) -> list[OtherForm]:
    """The lowest one first; each is further than `EQUAL` from the form that is shown and from the ones before it."""
    shown, plan = preview.equilibrium, preview.sheet.layout
    met = sorted((trial for trial in shown.trials if trial.is_minimum), key=lambda trial: trial.energy)
    if len(met) < 2 or len(plan.centres) < FEWEST:
        return []
    stars = preview.sheet.space.locate(plan.centres).value
    known, found = [stars @ shown.x], []
    for trial in met:
        centres = stars @ trial.x
        apart = [100.0 / diameter_mm * distances(form, centres, preview.symmetries).min() for form in known]
        if min(apart) > EQUAL:
            gap = (trial.energy - shown.energy) / shown.absolute_energy
            found.append(OtherForm(trial.name, trial.energy, gap, float(apart[0])))
            known.append(centres)
    return found
