"""The choice of the result among several exact shapes of a design."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from asterism.shape.shape import Shape

# two minima are equal if their energies differ by at most this part
MAX_EQUAL_ENERGY_GAP = 1e-6
# another mesh may exchange the order of two minima whose energies differ by at most this part of the elastic energy
MIN_CERTAIN_GAP = 0.005


def same_energy(one: float, other: float) -> bool:
    """Whether the energies (N mm) of two minima are equal up to the accuracy of the solver.

    Examples
    --------
    >>> same_energy(1808.98, 1808.9801), same_energy(1808.98, 1809.98)
    (True, False)
    """
    return abs(one - other) <= MAX_EQUAL_ENERGY_GAP * abs(one)


def gap(one: Mapping[str, Any], other: Mapping[str, Any]) -> float:
    """Difference of the energies of two minima over the elastic energy of the first; gravity has an arbitrary zero.

    Parameters
    ----------
    one : summary of an exact shape.
    other : summary of another one; only its energy is used.
    """
    elastic = one["energy_n_mm"] - one.get("gravity", 0.0)
    return float(abs(other["energy_n_mm"] - one["energy_n_mm"]) / elastic) if elastic else math.inf


def right_shape(exact: Mapping[str, Shape]) -> str:
    """The name of the certified shape; among several, the one of lowest energy, and among equal energies the first.

    A shape whose stars are all on the side that the design asks for comes before shapes with stars on the other side.
    """

    def rank(name: str) -> tuple[bool, bool]:
        return not exact[name].summary["is_minimum"], bool(exact[name].summary["stars_off_branch"])

    def energy(name: str) -> float:
        return float(exact[name].summary["energy_n_mm"])

    best = [name for name in exact if rank(name) == min(map(rank, exact))]
    lowest = min(map(energy, best))
    return next(name for name in best if same_energy(lowest, energy(name)))
