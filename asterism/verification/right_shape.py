"""Which of several exact shapes of a design counts as right."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from asterism.shape.shape import Shape

# energies that differ by a smaller part of them are one; and by what part of the elastic one two minima differ on
# another mesh
SAME_ENERGY, SURE = 1e-6, 0.005


def same_energy(one: float, other: float) -> bool:
    """Whether two minima may be one."""
    return abs(one - other) <= SAME_ENERGY * abs(one)


def gap(one: Mapping[str, Any], other: Mapping[str, Any]) -> float:
    """By what part of the elastic energy two minima differ; how high a sheet hangs makes none of them more certain.

    `one`: the summary of an exact shape; of the other its energy is enough.
    """
    elastic = one["energy_n_mm"] - one.get("gravity", 0.0)
    return float(abs(other["energy_n_mm"] - one["energy_n_mm"]) / elastic) if elastic else math.inf


def right_shape(exact: Mapping[str, Shape]) -> str:
    """The name of the certified one, and of several the lowest; of equal ones the first.

    One whose stars are all on their side comes before one that has stars off it.
    """

    def rank(name: str) -> tuple[bool, bool]:
        return not exact[name].summary["is_minimum"], bool(exact[name].summary["stars_off_branch"])

    def energy(name: str) -> float:
        return float(exact[name].summary["energy_n_mm"])

    best = [name for name in exact if rank(name) == min(map(rank, exact))]
    lowest = min(map(energy, best))
    return next(name for name in best if same_energy(lowest, energy(name)))
