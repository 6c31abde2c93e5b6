"""What a summary says about the minima of a design: which one is the result, and how far apart they are."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.equilibrium import Equilibrium, roll_axis_deg
from asterism.discrete.release.forms import ExactForm, Minima
from asterism.results.records.exact import MinimumRecord, StartsRecord

# values of the key `result_is`: the reason why this minimum is the result
FROM_DEFAULT_START = "the default start's"
BY_ENERGY = "lowest energy"
BY_ENERGY_ON_BRANCH = "lowest energy of those whose stars are all on their branch"


def one_minimum(model: DiscreteModel, equilibrium: Equilibrium, near: bool = False) -> StartsRecord:
    """The record of a single start: the default one, or, if `near`, a shape that the caller gave."""
    axis = roll_axis_deg(model, equilibrium.state)
    entry = MinimumRecord(energy_n_mm=equilibrium.energy, stars_up=equilibrium.stars_up, roll_axis_deg=axis, starts=1)
    return StartsRecord(
        starts=1,
        result_is="from a shape that was given" if near else FROM_DEFAULT_START,
        minima_seen=1,
        minima=[entry],
        next_minimum_percent=None,
    )


def many_minima(minima: Minima, starts: int) -> StartsRecord:
    """The record of many starts."""
    fine, coarse = minima.fine, minima.coarse
    not_carried = minima.refined.count(False)
    return several_minima(
        [_entry(each, minima) for each in fine],
        [[minima.distance_percent(a, b) for b in fine] for a in fine],
        fine[0].equilibrium.energies.get("gravity", 0.0),
        not_carried,
        starts=starts,
        starts_lost=minima.lost_starts,
        symmetries=len(minima.symmetries),
        minima_coarse=[_entry(b, minima) | {"carried": kept} for b, kept in zip(coarse, minima.refined, strict=True)],
    )


def several_minima(
    entries: Sequence[MinimumRecord],
    distances_percent: list[list[float]],
    gravity_n_mm: float,
    not_carried: int = 0,
    **more: Any,
) -> StartsRecord:
    """The record of distinct minima, of which the first is the result.

    Parameters
    ----------
    gravity_n_mm : the part of gravity in the energy of the result. Its zero level is arbitrary, so that energies are
        compared relative to the rest.
    more : keys about the starts.
    """
    lowest, others = entries[0].energy_n_mm, [each.energy_n_mm for each in entries[1:]]
    higher, elastic = min(others) - lowest if others else None, lowest - gravity_n_mm
    return StartsRecord(
        result_is=BY_ENERGY if higher is None or higher >= 0.0 else BY_ENERGY_ON_BRANCH,
        minima_seen=len(entries) + not_carried,
        minima_not_carried=not_carried,
        next_minimum_percent=None if higher is None else 100.0 * higher / elastic if elastic else math.inf,
        next_minimum_n_mm=higher,
        minima=[each | {"file": f"minimum-{k}" if k > 1 else "shape"} for k, each in enumerate(entries, 1)],
        minima_distance_percent=distances_percent,
        **more,
    )


def _entry(branch: ExactForm, minima: Minima) -> MinimumRecord:
    equilibrium = branch.equilibrium
    return MinimumRecord(
        energy_n_mm=equilibrium.energy,
        is_minimum=equilibrium.is_minimum,
        stars_up=equilibrium.stars_up,
        stars_off_branch=len(branch.stars_off_branch),
        roll_axis_deg=branch.roll_axis_deg,
        starts=len(branch.starts),
        start_names=list(branch.starts),
        default=branch.default,
        distance_percent=minima.distance_percent(minima.fine[0], branch),
        smallest_eigenvalue=equilibrium.smallest_eigenvalue,
        vertices=branch.model.n_vertices,
    )
