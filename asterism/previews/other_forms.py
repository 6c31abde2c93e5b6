"""Other forms of a sheet: minima that the search met besides the one that is shown.

Two minima are one form if a motion that the supports leave free and a symmetry of the design bring their star centres
together, or the sites of the lattice of a motif.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.search.evidence import Trial
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.free_motions import FreeMotions, free_motions
from asterism.pattern.layout.symmetries import distances_of_images
from asterism.previews.solve import PreviewState
from asterism.results.records.preview import OtherFormRecord

# sheets with fewer stars or sites have no list of other forms, because these points cannot distinguish them
MIN_STARS = 3
# two minima have the same form if the rms distance of these points, in % of the diameter, is at most this
EQUAL_FORM_PERCENT = 2.0


def other_forms(state: PreviewState) -> list[tuple[OtherFormRecord, Trial]]:
    """Each form with the trial that found it, the lowest one first.

    It is another form than the last equilibrium, and than those before it.
    """
    shown, layout = state.resting, state.layout
    minima = sorted((trial for trial in shown.trials if trial.is_minimum), key=lambda trial: trial.energy)
    if len(minima) < 2 or len(layout.sample_points) < MIN_STARS:
        return []
    diameter_mm = diameter(state.shell.node_positions(shown.x))
    known, forms = [(shown.x, _free(state, shown.x))], list[tuple[OtherFormRecord, Trial]]()
    for trial in minima:
        apart = [100.0 * _distance(state, form, trial.x, free) / diameter_mm for form, free in known]
        if min(apart) > EQUAL_FORM_PERCENT:
            form = OtherFormRecord(
                start=trial.name,
                energy_n_mm=trial.energy,
                gap=(trial.energy - shown.energy) / shown.absolute_energy,
                distance_percent=float(apart[0]),
            )
            forms.append((form, trial))
            known.append((trial.x, _free(state, trial.x)))
    return forms


def _distance(state: PreviewState, first: Floats, second: Floats, free: FreeMotions) -> float:
    """mm, rms distance of two minima (N, 3) by their dofs, after the nearest symmetry and free motion."""
    points, space = state.layout.sample_points, state.sheet.space
    at = space.locate(points).value

    def second_at(places: Floats) -> Floats:
        return np.asarray(space.locate(places).value @ second)

    return float(distances_of_images(points, at @ first, second_at, state.sheet.symmetries, free).min())


def _free(state: PreviewState, x: Floats) -> FreeMotions:
    """The rigid motions that the supports leave to a minimum."""
    supports = state.layout.support_samples
    if len(supports.printed) == 0:
        return FreeMotions()
    positions = state.sheet.space.locate(supports.printed).value @ x
    return free_motions(supports, positions, state.design.gravity.pull)
