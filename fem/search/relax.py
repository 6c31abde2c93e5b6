"""From fields to a certified equilibrium of the shell."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from equilibrium.linear.factor import Factor
from equilibrium.newton.find_minimum import IterationResult, StationaryPoint, find_minimum, is_definite_on_support
from equilibrium.newton.soft_modes import softest_modes as softest
from fem.elements.tabulation import Floats
from fem.search.evidence import ShellEquilibrium, Trial
from fem.search.guess_builder import InitialGuess
from fem.search.initial_guesses import initial_guesses
from fem.search.mixed_newton import mixed_newton
from fem.search.sides import Side
from fem.search.simple_shapes import SimpleShape
from fem.shell.shell import Shell

GRADIENT_TOLERANCE = 1e-11  # of the gradient, over the sheet's membrane stiffness times its size
LEFT = 0.02  # of the sheet's size: how far a dof moves when a saddle is left
STEPS = (4, 16)  # load steps that are tried when nothing else works
LONG, SHORT = 60, 12  # iterations of Newton's method with mixed points
DOWN = 200  # iterations downhill where that failed
CLOSE = 0.1  # of what the best start saves against a flat sheet
FOLLOWED = 2  # starts of different kinds that are followed to their ends
TURNED = 2  # and as many in other directions
SOFTEST = 3  # soft modes


def relax(
    shell: Shell,
    factor: Factor | None = None,
    side: Side = "auto",
    shapes: Sequence[SimpleShape] | None = None,
    max_guesses: int = FOLLOWED,
    soft_modes: int = SOFTEST,
    symmetries: Sequence[Floats] = (),
    energy_tie: float = 0.0,
) -> ShellEquilibrium:
    """Equilibrium of lowest energy among those that the most promising starts lead to.

    Parameters
    ----------
    factor : of `shell.factor()`, to be used again; at the end it holds the exact Hessian if that is definite. One is
        made for this call if none is given.
    side : of the printed plane that the edges go to; by default that of the rest curvature.
    shapes : to start from in place of the usual ones.
    max_guesses : guesses that are followed, each of another kind (cap, arc, saddle, flat). If the first one is bent
        about an axis, so are those about other axes that promise as much.
    soft_modes : how many of the smallest eigenvalues to find.
    symmetries : (2, 2) rotations and mirrors of the print that change nothing; axes that they make equal count once.
    energy_tie : part of the energy within which minima are equally low; the one with the lowest guess then counts.

    Raises
    ------
    ValueError
        No shape to start from, or no start to follow.
    """
    if shapes is not None and not len(shapes):
        raise ValueError("shapes = []: at least one is needed to start from; None takes the usual ones")
    if max_guesses < 1:
        raise ValueError(f"max_guesses = {max_guesses!r}: must be at least 1")
    if factor is None:
        own = shell.factor()
        try:
            return relax(shell, own, side, shapes, max_guesses, soft_modes, symmetries, energy_tie)
        finally:
            own.close()
    begin = time.perf_counter()
    kinds, turned = initial_guesses(shell, factor, side, None if shapes is None else list(shapes), symmetries)
    seconds = {"starts": time.perf_counter() - begin}
    found: list[ShellEquilibrium] = []
    chosen = _promising(kinds, kinds)[:max_guesses] + _promising(turned, kinds)[:TURNED]
    for start in sorted(chosen, key=lambda start: start.energy):
        # with a minimum at hand, another start is worth a few iterations, and a long way down from below it
        least = min((each.energy for each in found if each.is_minimum), default=np.inf)
        found.append(follow(shell, start.x, factor, start.shape.name, patient=least == np.inf))
        if not found[-1].is_minimum and found[-1].energy < least < np.inf:
            found.append(follow(shell, found[-1].x, factor, start.shape.name))
    for steps in STEPS:
        if not any(each.is_minimum for each in found):
            found += filter(None, [follow_load_steps(shell, factor, steps)])
    best = min(found, key=_rank)
    if best.is_minimum:
        enough = best.energy + energy_tie * abs(best.energy)
        best = next(each for each in found if each.is_minimum and each.energy <= enough)
        if best is not found[-1]:
            factorise(shell, best.x, factor)
        begin = time.perf_counter()
        best = replace(best, soft_modes=softest_modes(shell, best.x, factor, soft_modes)[0])
        seconds["soft modes"] = time.perf_counter() - begin
    for each in found:
        for part, spent in each.seconds.items():
            seconds[part] = seconds.get(part, 0.0) + spent
    return replace(best, trials=tuple(trial for each in found for trial in each.trials), seconds=seconds)


def follow(
    shell: Shell,
    x: Floats,
    factor: Factor,
    name: str = "given",
    strains: Floats | None = None,
    patient: bool = True,
) -> ShellEquilibrium:
    """The equilibrium that a state x (N, 3) leads to, certified.

    `strains` (T, Q, 6) go with x after an edit. An impatient search ends where Newton's method does not converge soon.
    """
    tolerance = GRADIENT_TOLERANCE * shell.force_scale
    given = [strains]  # they belong to the first state only

    def iterate(state: Any) -> IterationResult:
        return mixed_newton(shell, state, factor, tolerance, given.pop() if given else None, LONG if patient else SHORT)

    settled = find_minimum(
        shell, x, factor, tolerance, iterate, LEFT * shell.extent, max_iterations=DOWN if patient else 0
    )
    return _evidence(shell, settled, name)


def factorise(shell: Shell, x: Floats, factor: Factor) -> bool:
    """Leave the Hessian at a state x (N, 3), its rigid motions held, in the factor; False if it is not definite."""
    return is_definite_on_support(shell, x, shell.hessian(x), factor)


def follow_load_steps(shell: Shell, factor: Factor, steps: int) -> ShellEquilibrium | None:
    """From the printed sheet, with fields, loads and moved conditions brought up in equal steps; None if one fails."""
    x = shell.flat
    found = None
    for step in range(1, steps + 1):
        part = shell.at_progress(step / steps)
        found = follow(part, part.constrain(x), factor, f"{steps} load steps")
        if not found.converged:
            return None
        x = found.x
    return None if found is None else replace(found, load_steps=steps)


def softest_modes(shell: Shell, x: Floats, factor: Factor, count: int = SOFTEST) -> tuple[Floats, Floats]:
    """(k,) N/mm^3 and (n, k) softest modes over the free unknowns; the factor holds the Hessian at the minimum x.

    What swings as a whole under its weight keeps its form: rigid motions are left out, whatever they cost.
    """
    return softest(shell.mass, factor, shell.rigid_motions(x), count)


def energies_by_part(shell: Shell, x: Floats) -> dict[str, float]:
    """N mm by part, what Gaussian curvature costs or saves as one of its own."""
    energies, gaussian = shell.energies(x), shell.gaussian_energy(x)
    return energies | ({"sheet": energies["sheet"] - gaussian, "gaussian": gaussian} if gaussian else {})


def _evidence(shell: Shell, settled: StationaryPoint, name: str) -> ShellEquilibrium:
    x = settled.state
    return ShellEquilibrium(
        x=x,
        strains=shell.strains(x),
        energies=energies_by_part(shell, x),
        gradient_norm=settled.gradient_norm,
        tolerance=settled.tolerance,
        definite=settled.definite,
        soft_modes=np.empty(0),
        guess=name,
        trials=(Trial(name, settled.energy, settled.is_minimum, settled.iterations, x),),
        iterations=settled.iterations,
        factorisations=settled.factorisations,
        saddles_left=settled.saddles_left,
        fallbacks=settled.fallbacks,
        seconds=settled.seconds,
    )


def _promising(offered: Sequence[InitialGuess], kinds: Sequence[InitialGuess]) -> list[InitialGuess]:
    """Those not much dearer than the best of all kinds, compared with a flat sheet."""
    best = kinds[0].energy
    flat = next((start.energy for start in kinds if start.shape.name == "flat"), best)
    return [start for start in offered if start is kinds[0] or start.energy - best <= CLOSE * (flat - best)]


def _rank(found: ShellEquilibrium) -> tuple[bool, bool, float]:
    """Minima before others, low energies before high ones."""
    energy = found.energy if np.isfinite(found.energy) else np.inf
    return not found.is_minimum, not found.converged, energy
