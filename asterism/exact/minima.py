"""Summary entries on the minima of a design: which one is the result, and how far apart they are."""

from __future__ import annotations

from typing import Any

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.equilibrium import Equilibrium, roll_axis_deg
from asterism.discrete.release.forms import ExactForm, Minima
from asterism.results.records.exact import MinimumRecord

# values of the key `result_is`: the reason why this minimum is the result
FROM_DEFAULT_START = "the default start's"
FROM_GIVEN_SHAPE = "from a shape that was given"
BY_ENERGY = "lowest energy"
BY_ENERGY_ON_BRANCH = "lowest energy of those whose stars are all on their branch"


def one_minimum(model: DiscreteModel, equilibrium: Equilibrium, near: bool = False) -> dict[str, Any]:
    """Entries for a single start: the default one, or, if `near`, a shape that the caller gave."""
    axis = roll_axis_deg(model, equilibrium.state)
    entry = MinimumRecord(energy_n_mm=equilibrium.energy, stars_up=equilibrium.stars_up, roll_axis_deg=axis, starts=1)
    return {
        "starts": 1,
        "result_is": FROM_GIVEN_SHAPE if near else FROM_DEFAULT_START,
        "minima_seen": 1,
        "minima": [entry],
        "next_minimum_percent": None,
    }


def many_minima(minima: Minima, starts: int) -> dict[str, Any]:
    """Entries for many starts.

    `minima` holds the minima on the fine mesh; the first one is the result. `minima_coarse` holds the minima of the
    coarse exploration, of which the lowest are carried to the fine mesh. Distances are in % of the diameter, modulo
    the symmetries of the design.
    """
    fine, coarse = minima.fine, minima.coarse
    not_carried = minima.refined.count(False)
    other_energies = sorted(b.equilibrium.energy for b in fine[1:])
    lowest = fine[0].equilibrium.energy
    # energies are compared relative to the elastic part: the potential of gravity depends on an arbitrary zero level
    elastic = lowest - fine[0].equilibrium.energies.get("gravity", 0.0)
    by_energy = all(lowest <= energy for energy in other_energies)
    return {
        "starts": starts,
        "starts_lost": minima.lost_starts,
        "result_is": BY_ENERGY if by_energy else BY_ENERGY_ON_BRANCH,
        "minima_seen": len(fine) + not_carried,
        "minima_not_carried": not_carried,
        "next_minimum_percent": 100.0 * (other_energies[0] - lowest) / elastic if other_energies else None,
        "next_minimum_n_mm": other_energies[0] - lowest if other_energies else None,
        "symmetries": len(minima.symmetries),
        "minima": [_entry(b, minima).changed(file=f"minimum-{k}" if k > 1 else "shape") for k, b in enumerate(fine, 1)],
        "minima_distance_percent": [[minima.distance_percent(a, b) for b in fine] for a in fine],
        "minima_coarse": [
            _entry(b, minima).changed(carried=kept) for b, kept in zip(coarse, minima.refined, strict=True)
        ],
    }


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
