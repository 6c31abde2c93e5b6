"""The equilibrium of a sheet: from simple shapes, and then as later pins take hold of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from asterism.previews.uncertainty.expected import amplitudes_percent, another_form_is_near
from equilibrium.linear.factor import Factor
from fem.elements.tabulation import Floats
from fem.search.candidate_shapes import candidate_shapes
from fem.search.evidence import ShellEquilibrium, Trial
from fem.search.guess_builder import GuessBuilder
from fem.search.mean_fields import MeanFields, mean_fields
from fem.search.relax import factorise, follow, relax, softest_modes
from fem.search.sides import FLAT_SAG_MM, Side, side_of
from fem.search.simple_shapes import SimpleShape
from fem.shell.shell import Shell
from pattern.geometry.rigid_fit import rigid_fit

# a free sheet of equal stars that would turn by more from side to side, in rad, is a tube, and not tried as a cap
TUBE_TURN = 3.0
TIE = 0.005  # part of the energy by which the law's sheets are wrong at best: it cannot say which of two forms is lower
CAPS = (1.0, 0.7)  # parts of a cap's curvature to start from: from afar it takes luck to reach the lowest fold
EQUAL = 1e-3  # part of the energy within which two minima are the same form
ROLLED = {"arc", "bent", "saddle"}
KINDS = ROLLED | {"cap"}  # that are bent
PUSH = 0.04  # of the size: how far a held sheet that is soft in two ways is pushed, to see what else it can be
OVER = 0.1  # on the wrong side: a sheet that rises by less than this part of how far it hangs
# of its own size: what is held narrower is tried from so many arcs, and from caps, too
NARROW, ARCS = 0.95, 3
EDIT = "edit"  # name of the start of what goes on from a shape before it
STRIDES = 6  # in which later pins move the sheet to their places


def settled(
    shell: Shell, factor: Factor, side: Side, uniform: bool, curls: bool, turns: Sequence[Floats] = ()
) -> ShellEquilibrium:
    """The lowest equilibrium that the most promising simple shapes lead to, on the side that is asked for if any is.

    `turns`: of the design's symmetries. `uniform`: all stars are alike. `curls`: many stars curl tightly.
    """
    found = _lowest_of_all(shell, factor, side, uniform, curls, turns)
    if side == "auto" or side_of(shell, found.x) == side:
        return found
    return _on_side(shell, factor, found, side, turns)


def _on_side(
    shell: Shell, factor: Factor, found: ShellEquilibrium, side: Side, turns: Sequence[Floats]
) -> ShellEquilibrium:
    """The lowest minimum that is on a side, from bent starts there if none was met yet; `found` if there is none."""

    def fitting() -> list[Trial]:
        return [trial for trial in found.trials if trial.is_minimum and side_of(shell, trial.x) == side]

    wants, size = mean_fields(shell), shell.extent
    bent = [shape for shape in candidate_shapes(wants, size, side) if shape.name != "flat"]
    if not fitting() and bent:
        found = replace(
            found, trials=found.trials + relax(shell, factor, side, bent, len(KINDS), symmetries=turns).trials
        )
    best = min(fitting(), key=lambda trial: trial.energy, default=None)
    if best is None:
        factorise(shell, found.x, factor)
        return found
    there = follow(shell, best.x, factor, best.name)  # for the evidence and the factor: it is there already
    soft = softest_modes(shell, there.x, factor)[0]
    return replace(there, trials=found.trials, soft_modes=soft, iterations=best.iterations)


def _lowest_of_all(
    shell: Shell, factor: Factor, side: Side, uniform: bool, curls: bool, turns: Sequence[Floats]
) -> ShellEquilibrium:
    """The lowest one on any side; parameters as of `settled`.

    A held sheet that came out altogether on the wrong side is tried from flat too. A free sheet of stars that curl
    tightly may fold up on several sides in place of rolling, which a start as a cap finds and costs. Where a free sheet
    without symmetry is soft in two ways, starts of other kinds are followed too; a held one is pushed, or if it is
    stiff but narrow started anew.
    """
    free = len(shell.fixed_points) == 0
    wants, size = mean_fields(shell), shell.extent
    if free and uniform and abs(wants.curvature) * wants.stretch * size > TUBE_TURN:
        tubes = [shape for shape in candidate_shapes(wants, size, side) if shape.name in ("arc", "flat")]
        found = relax(shell, factor, side, tubes, max_guesses=1, symmetries=turns, energy_tie=TIE)
        if found.is_minimum:
            return found
    found = relax(shell, factor, side, symmetries=turns, energy_tie=TIE)
    wanted = wants.side if side == "auto" else side
    if not free and found.is_minimum and found.guess != "flat" and turned_over(shell, found.x, wanted):
        flat = [shape for shape in candidate_shapes(wants, size, side) if shape.name == "flat"]
        found = _lowest(shell, factor, found, [relax(shell, factor, side, flat, max_guesses=1)])
    soft = soft_in_two_ways(shell, found, wants.stretch * size)
    guesses = candidate_shapes(wants, size, side)
    if not free:
        if soft and found.is_minimum:
            return pushed(shell, factor, found, PUSH * size)
        return buckled(shell, factor, found, wants, guesses) if narrow(wants) and found.is_minimum else found
    tried = {trial.name for trial in found.trials} - ROLLED | {"flat"}
    if sum(trial.name in ROLLED for trial in found.trials) > 1:
        tried |= ROLLED  # in several directions
    offers: list[list[SimpleShape]] = []
    caps = [shape for shape in guesses if shape.name == "cap"]
    if curls and caps and "cap" not in tried:
        offers = [[replace(caps[-1], curvature=share * caps[-1].curvature)] for share in CAPS]
    elif soft and len(turns) <= 1:
        offers = _by_direction([shape for shape in guesses if shape.name not in tried])
    best, trials = found, found.trials
    for offer in filter(None, offers):
        other = relax(shell, factor, side, offer, max_guesses=1, symmetries=turns)
        known = [trial.energy for trial in trials if trial.is_minimum]
        trials += other.trials
        margin = EQUAL * abs(other.energy)
        if other.is_minimum and all(other.energy < energy - margin for energy in known):
            best = other
    if len(trials) > len(found.trials):
        factorise(shell, best.x, factor)
    return replace(best, trials=trials)


def _by_direction(guesses: Sequence[SimpleShape]) -> list[list[SimpleShape]]:
    """Those that are bent about axes in each third of a half turn; others are with the first ones."""
    return [[shape for shape in guesses if int(3.0 * shape.angle / np.pi) == third] for third in range(3)]


def pushed(shell: Shell, factor: Factor, found: ShellEquilibrium, far: float) -> ShellEquilibrium:
    """The lowest of a minimum and of those that its softest motion leads to; `far`: how far a dof is pushed, mm."""
    mode = softest_modes(shell, found.x, factor, 1)[1][:, 0]
    step = far / np.abs(shell.move(np.zeros_like(found.x), mode)).max() * mode
    others = [follow(shell, shell.move(found.x, sign * step), factor, "pushed") for sign in (1.0, -1.0)]
    return _lowest(shell, factor, found, others)


def narrow(wants: MeanFields) -> bool:
    """Whether a sheet is held narrower than it would be by itself."""
    return wants.chord < NARROW * wants.stretch


def buckled(
    shell: Shell, factor: Factor, found: ShellEquilibrium, wants: MeanFields, guesses: Sequence[SimpleShape]
) -> ShellEquilibrium:
    """The lowest of a minimum and of those that caps and a few arcs lead to.

    A sheet that is held narrow buckles, and into which of its forms depends on the start; each is stiff, so that no
    softness tells of the others.
    """
    frame = GuessBuilder(shell, factor, wants.centre, wants.stretch)
    arcs = [shape for shape in guesses if shape.name in ("arc", "bent")]
    tried = [shape for shape in guesses if shape.name == "cap"] + arcs[:: max(len(arcs) // ARCS, 1)]
    starts = [frame.relax_in_plane(frame.bend(shape)) for shape in tried]  # all of them while the factor is the frame's
    others = [follow(shell, start.x, factor, start.shape.name, patient=False) for start in starts]
    low = min(others, key=lambda other: other.energy)
    if not low.is_minimum and low.energy < found.energy:
        others.append(follow(shell, low.x, factor, low.guess))
    return _lowest(shell, factor, found, others)


def turned_over(shell: Shell, x: Floats, side: Side) -> bool:
    """Whether a held sheet is altogether on the other side of what holds it than where its edges' `side` puts it."""
    heights = (shell.node_positions(x)[:, 2] - shell.support_level[2]) * (1.0 if side == "down" else -1.0)
    return bool(heights.min() < -FLAT_SAG_MM and heights.max() < OVER * -heights.min())


def _lowest(
    shell: Shell, factor: Factor, found: ShellEquilibrium, others: Sequence[ShellEquilibrium]
) -> ShellEquilibrium:
    """A minimum, or the lowest of others that are lower, with everybody's trials."""
    best = found
    for other in others:
        if other.is_minimum and other.energy < best.energy - EQUAL * abs(best.energy):
            best = other
    factorise(shell, best.x, factor)
    if best is not found:
        best = replace(best, soft_modes=softest_modes(shell, best.x, factor)[0])
    return replace(best, trials=found.trials + tuple(trial for other in others for trial in other.trials))


def soft_in_two_ways(shell: Shell, found: ShellEquilibrium, size: float) -> bool:
    """Whether another form is likely to be near a minimum of a sheet that is about `size` mm large."""
    area = float(shell.assembly.weights.sum())
    held = len(shell.fixed_points) > 0
    return another_form_is_near(amplitudes_percent(found.soft_modes, found.absolute_energy, area, size), held)


def taken(shell: Shell, factor: Factor, x: Floats, was_free: bool) -> ShellEquilibrium:
    """The equilibrium after the shell's conditions have taken hold of a state x (N, 3) that did not meet them all.

    A sheet that was free is first laid where its held points come closest to their places. They go there in strides.
    """
    target = shell.reduction.target
    if was_free:
        x = _laid(shell, x, target.reshape(-1, 3))
    start = x.ravel() - shell.reduction.map @ shell.reduction.project(x)
    whole = shell.reduction
    found = None
    try:
        for stride in range(1, STRIDES + 1):
            share = stride / STRIDES
            shell.reduction = replace(whole, target=(1.0 - share) * start + share * target)
            found = follow(shell, shell.constrain(x), factor, "pins take hold")
            x = found.x
    finally:
        shell.reduction = whole
    assert found is not None
    return found


def _laid(shell: Shell, x: Floats, places: Floats) -> Floats:
    """The rigid motion that brings held points closest to their places."""
    held = shell.fixed_points
    rotation, shift = rigid_fit(x[held], places[held])
    return shell.translated(x @ rotation.T, shift)
