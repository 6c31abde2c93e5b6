"""Search for certified equilibria of a shell: from initial guesses, from a given state, or in load steps.

Every result carries its evidence: norm of the gradient, and definiteness of the exact Hessian. An equilibrium whose
Hessian is not positive definite is a saddle; the search leaves it along its lowest mode.
"""

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

GRADIENT_TOLERANCE = 1e-11  # over `Shell.force_scale`
SADDLE_STEP = 0.02  # part of the extent of the sheet: largest change of a dof on leaving a saddle
LOAD_STEPS = (4, 16)  # numbers of load steps that are tried if no guess leads to a minimum
MAX_ITERATIONS = 60  # of Newton's method with mixed points
MAX_ITERATIONS_OF_FURTHER_GUESSES = 12  # the same once a minimum is known
MAX_DESCENT_ITERATIONS = 200  # of energy minimisation after Newton's method failed
CLOSE_GUESS = 0.1  # part of the energy between the flat sheet and the best guess: closer guesses are followed too
MAX_GUESSES = 2  # of different kinds that are followed
MAX_TURNED_GUESSES = 2  # of the best kind in other directions that are followed
MODE_COUNT = 3  # softest modes that are computed


def relax(
    shell: Shell,
    factor: Factor | None = None,
    side: Side = "auto",
    shapes: Sequence[SimpleShape] | None = None,
    max_guesses: int = MAX_GUESSES,
    soft_modes: int = MODE_COUNT,
    symmetries: Sequence[Floats] = (),
    energy_tie: float = 0.0,
) -> ShellEquilibrium:
    """The equilibrium of lowest energy among those that the best initial guesses lead to.

    Parameters
    ----------
    factor : of `shell.factor()`, to be used again; at the end it holds the exact Hessian if that is definite. One is
        made for this call if none is given.
    side : of the printed plane for the edges; by default the one of the rest curvature.
    shapes : simple shapes for the initial guesses, in place of the candidates of the mean fields.
    max_guesses : guesses that are followed, each of another kind (cap, arc, saddle, flat). If the first one is bent
        about an axis, so are those about other axes that promise as much.
    soft_modes : how many of the smallest eigenvalues to find.
    symmetries : rotations and reflections (2, 2) of the print; axes that they map onto each other count once.
    energy_tie : part of the energy within which minima are equally low; the one with the lowest guess then counts.

    Raises
    ------
    ValueError
        `shapes` is empty, or `max_guesses` is below 1.
    """
    if shapes is not None and not len(shapes):
        raise ValueError("shapes = []: at least one shape is needed; None takes the candidates of the mean fields")
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
    chosen = _promising(kinds, kinds)[:max_guesses] + _promising(turned, kinds)[:MAX_TURNED_GUESSES]
    for guess in sorted(chosen, key=lambda guess: guess.energy):
        # once a minimum is known, a further guess gets few iterations, and more only if its energy is already lower
        least = min((each.energy for each in found if each.is_minimum), default=np.inf)
        found.append(follow(shell, guess.x, factor, guess.shape.name, patient=least == np.inf))
        if not found[-1].is_minimum and found[-1].energy < least < np.inf:
            found.append(follow(shell, found[-1].x, factor, guess.shape.name))
    for steps in LOAD_STEPS:
        if not any(each.is_minimum for each in found):
            found += filter(None, [follow_load_steps(shell, factor, steps)])
    best = min(found, key=_rank)
    if best.is_minimum:
        enough = best.energy + energy_tie * abs(best.energy)
        best = next(each for each in found if each.is_minimum and each.energy <= enough)
        if best is not found[-1]:
            factorise(shell, best.x, factor)
        begin = time.perf_counter()
        best = replace(best, soft_modes=softest_shell_modes(shell, best.x, factor, soft_modes)[0])
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
        return mixed_newton(
            shell,
            state,
            factor,
            tolerance,
            given.pop() if given else None,
            MAX_ITERATIONS if patient else MAX_ITERATIONS_OF_FURTHER_GUESSES,
        )

    equilibrium = find_minimum(
        shell,
        x,
        factor,
        tolerance,
        iterate,
        SADDLE_STEP * shell.extent,
        max_iterations=MAX_DESCENT_ITERATIONS if patient else 0,
    )
    return _evidence(shell, equilibrium, name)


def factorise(shell: Shell, x: Floats, factor: Factor) -> bool:
    """Factorise the exact Hessian at x (N, 3), with rigid motions fixed; False if it is not positive definite."""
    return is_definite_on_support(shell, x, shell.hessian(x), factor)


def follow_load_steps(shell: Shell, factor: Factor, steps: int) -> ShellEquilibrium | None:
    """The equilibrium from the printed sheet if fields, loads and supports grow in steps; None if a step fails."""
    x = shell.flat
    found = None
    for step in range(1, steps + 1):
        part = shell.at_progress(step / steps)
        found = follow(part, part.constrain(x), factor, f"{steps} load steps")
        if not found.converged:
            return None
        x = found.x
    return None if found is None else replace(found, load_steps=steps)


def softest_shell_modes(shell: Shell, x: Floats, factor: Factor, count: int = MODE_COUNT) -> tuple[Floats, Floats]:
    """Smallest eigenvalues (k,) in N/mm^3 and modes (n, k); the factor holds the Hessian at the minimum x (N, 3).

    Rigid motions are left out, also those that loads resist: they do not change the form.
    """
    return softest(shell.mass, factor, shell.rigid_motions(x), count)


def energies_by_part(shell: Shell, x: Floats) -> dict[str, float]:
    """Parts of the energy in N mm as in `Shell.energies`, with the part of Gaussian curvature as `gaussian`."""
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
    """The guesses close to the best one, measured by its gain over the flat sheet."""
    best = kinds[0].energy
    flat = next((guess.energy for guess in kinds if guess.shape.name == "flat"), best)
    return [guess for guess in offered if guess is kinds[0] or guess.energy - best <= CLOSE_GUESS * (flat - best)]


def _rank(found: ShellEquilibrium) -> tuple[bool, bool, float]:
    """Minima before others, low energies before high ones."""
    energy = found.energy if np.isfinite(found.energy) else np.inf
    return not found.is_minimum, not found.converged, energy
