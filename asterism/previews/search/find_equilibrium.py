"""The equilibrium that a preview shows: the lowest minimum among those that simple shapes lead to.

1. The initial guesses of `fem.search`: caps, tubes about several axes, saddles; the most promising ones are followed.
2. Where experience shows that other forms are likely, more are tried: caps for free sheets whose stars curl within
   their own spacing; other kinds of guesses for free sheets without symmetry that have two near-zero modes; the flat
   sheet for supported sheets that come out inverted; both sides of the softest mode for supported sheets with
   two soft modes; caps and arcs for supported sheets that are narrower than their natural size, soft or not.
3. If one side is asked for, the lowest minimum on that side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.evidence import ShellEquilibrium, Trial
from asterism.fem.search.initial_guesses import candidate_shapes
from asterism.fem.search.mean_fields import Side, mean_fields, side_of
from asterism.fem.search.relax import factorise, follow, relax, softest_shell_modes
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.fem.shell.shell import Shell
from asterism.previews.search.alternatives import (
    EQUAL_ENERGY,
    buckle,
    buckle_soft,
    is_inverted,
    is_narrow,
    lowest,
    perturb_along_softest_mode,
)
from asterism.previews.search.near_zero_modes import is_equilibrium_near_another

# a free sheet of equal stars whose natural turn from side to side is larger is a tube; caps are not tried
MIN_TUBE_TURN_RAD = 3.0
# curvatures of the caps that are tried, over the curvature of the last cap among the guesses
CAP_CURVATURES = (1.0, 0.7)
# kinds of initial guesses with an axis
ROLLED = {"arc", "bent", "saddle"}
# kinds of initial guesses that are not flat
KINDS = ROLLED | {"cap"}
# supported sheets whose second softest mode has a larger amplitude, in % of the diameter, are perturbed; chosen by hand
PERTURBED_AMPLITUDE_PERCENT = 10.0
# amplitude of the perturbation, over the size of the sheet
PERTURBATION = 0.04


@dataclass(frozen=True)
class SheetTraits:
    """Properties of a sheet that determine the initial guesses.

    Attributes
    ----------
    has_equal_stars : whether all stars have one size.
    has_tight_curls : whether many stars are not scale-separated.
    turns : (2, 2) rotations and mirrors of the design's symmetries; axes that they make equal count once.
    """

    has_equal_stars: bool = False
    has_tight_curls: bool = False
    turns: Sequence[Floats] = ()


def find_equilibrium(shell: Shell, factor: Factor, side: Side, traits: SheetTraits) -> ShellEquilibrium:
    """The lowest minimum that the guesses lead to, on the side that is asked for if one is reached there.

    The factor then holds the exact Hessian at the equilibrium, if that is definite.
    """
    equilibrium = _lowest_on_any_side(shell, factor, side, traits)
    if side == "auto" or side_of(shell, equilibrium.x) == side:
        return equilibrium
    return _lowest_on_side(shell, factor, equilibrium, side, traits.turns)


def _lowest_on_side(
    shell: Shell, factor: Factor, equilibrium: ShellEquilibrium, side: Side, turns: Sequence[Floats]
) -> ShellEquilibrium:
    """The lowest minimum on a side, from guesses there if none was met yet; `equilibrium` if that side has none."""

    def on_side() -> list[Trial]:
        return [trial for trial in equilibrium.trials if trial.is_minimum and side_of(shell, trial.x) == side]

    bent = [shape for shape in candidate_shapes(mean_fields(shell), shell.extent, side) if shape.name != "flat"]
    if not on_side() and bent:
        more = relax(shell, factor, side, bent, len(KINDS), symmetries=turns)
        equilibrium = replace(equilibrium, trials=equilibrium.trials + more.trials)
    best = min(on_side(), key=lambda trial: trial.energy, default=None)
    if best is None:
        factorise(shell, equilibrium.x, factor)
        return equilibrium
    there = follow(shell, best.x, factor, best.name)  # best.x is a minimum; this recomputes evidence and factor
    stiffness = softest_shell_modes(shell, there.x, factor)[0]
    return replace(there, trials=equilibrium.trials, soft_modes=stiffness, iterations=best.iterations)


def _lowest_on_any_side(shell: Shell, factor: Factor, side: Side, traits: SheetTraits) -> ShellEquilibrium:
    """The lowest minimum; the guesses are on the requested side, but may lead to the other one."""
    free = len(shell.fixed_points) == 0
    means, size, turns = mean_fields(shell), shell.extent, traits.turns
    if free and traits.has_equal_stars and abs(means.curvature) * means.stretch * size > MIN_TUBE_TURN_RAD:
        tubes = [shape for shape in candidate_shapes(means, size, side) if shape.name in ("arc", "flat")]
        tube = relax(shell, factor, side, tubes, max_guesses=1, symmetries=turns)
        if tube.is_minimum:
            return tube
    equilibrium = relax(shell, factor, side, symmetries=turns)
    guesses, natural_size = candidate_shapes(means, size, side), means.stretch * size
    if free:
        near_another = is_equilibrium_near_another(shell, equilibrium, natural_size)
        return _lowest_free(shell, factor, equilibrium, side, traits, guesses, near_another)
    right_side = means.side if side == "auto" else side
    if equilibrium.is_minimum and equilibrium.guess != "flat" and is_inverted(shell, equilibrium.x, right_side):
        flat = [shape for shape in guesses if shape.name == "flat"]
        equilibrium = lowest(shell, factor, equilibrium, [relax(shell, factor, side, flat, max_guesses=1)])
    if not equilibrium.is_minimum:
        return equilibrium
    is_soft = is_equilibrium_near_another(shell, equilibrium, natural_size, PERTURBED_AMPLITUDE_PERCENT)
    if is_soft:
        equilibrium = perturb_along_softest_mode(shell, factor, equilibrium, PERTURBATION * size)
    if not is_narrow(means):
        return equilibrium
    return (buckle_soft if is_soft else buckle)(shell, factor, equilibrium, means, guesses)


def _lowest_free(
    shell: Shell,
    factor: Factor,
    equilibrium: ShellEquilibrium,
    side: Side,
    traits: SheetTraits,
    guesses: Sequence[SimpleShape],
    near_another: bool,
) -> ShellEquilibrium:
    """The lowest of a free sheet's equilibrium and of those that further kinds of guesses lead to."""
    tried = {trial.name for trial in equilibrium.trials} - ROLLED | {"flat"}
    if sum(trial.name in ROLLED for trial in equilibrium.trials) > 1:
        tried |= ROLLED  # these have been tried in several directions
    offers: list[list[SimpleShape]] = []
    caps = [shape for shape in guesses if shape.name == "cap"]
    if traits.has_tight_curls and caps and "cap" not in tried:
        offers = [[replace(caps[-1], curvature=share * caps[-1].curvature)] for share in CAP_CURVATURES]
    elif near_another and len(traits.turns) <= 1:
        offers = _by_direction([shape for shape in guesses if shape.name not in tried])
    best, trials = equilibrium, equilibrium.trials
    for offer in filter(None, offers):
        other = relax(shell, factor, side, offer, max_guesses=1, symmetries=traits.turns)
        energies = [trial.energy for trial in trials if trial.is_minimum]
        trials += other.trials
        margin = EQUAL_ENERGY * abs(other.energy)
        if other.is_minimum and all(other.energy < energy - margin for energy in energies):
            best = other
    if len(trials) > len(equilibrium.trials):
        factorise(shell, best.x, factor)
    return replace(best, trials=trials)


def _by_direction(guesses: Sequence[SimpleShape]) -> list[list[SimpleShape]]:
    """The guesses by the direction of their axis, in three sectors of 60 degrees; caps are in the first sector."""
    return [[shape for shape in guesses if int(3.0 * shape.angle / np.pi) == third] for third in range(3)]
