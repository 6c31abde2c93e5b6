"""Further minima near a given one. Each function returns the lowest of the given minimum and those that it reaches.

- `perturb_along_softest_mode` starts on both sides of the minimum, along its softest mode.
- `buckle` starts a sheet that its supports hold narrower than its natural size from caps and arcs: such a sheet
  buckles, its form depends on the start, and all forms are stiff, so that no near-zero mode shows the others.
- `buckle_soft` does the same for a sheet that has soft modes: these need not point to the other forms either.
- `is_inverted` detects sheets that lie completely on the wrong side of their supports.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.evidence import ShellEquilibrium
from asterism.fem.search.guess_builder import GuessBuilder
from asterism.fem.search.initial_guesses import MAX_ENERGY_RATIO
from asterism.fem.search.mean_fields import FLAT_SAG_MM, MeanFields, Side
from asterism.fem.search.relax import MAX_FURTHER_ITERATIONS, factorise, follow, softest_shell_modes
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.fem.shell.shell import Shell

# two minima count as one form if their energies differ by less than this share
EQUAL_ENERGY = 1e-3
# an inverted sheet rises above its supports by less than this share of its depth below them
MAX_RISE_SHARE = 0.1
# sheets with a smaller ratio of supported size to natural size may buckle
MIN_SIZE_RATIO = 0.95
# about this many arcs are initial guesses for a narrow sheet
ARC_GUESSES = 3
# iterations for each guess of a narrow soft sheet: arcs take up to this many there
SOFT_ITERATIONS = 30


def perturb_along_softest_mode(
    shell: Shell, factor: Factor, equilibrium: ShellEquilibrium, amplitude_mm: float
) -> ShellEquilibrium:
    """The lowest of a minimum and of those that a perturbation along its softest mode leads to, in both directions.

    Parameters
    ----------
    amplitude_mm : largest change of a degree of freedom.
    """
    mode = softest_shell_modes(shell, equilibrium.x, factor, 1)[1][:, 0]
    step = amplitude_mm / np.abs(shell.move(np.zeros_like(equilibrium.x), mode)).max() * mode
    starts = [(shell.move(equilibrium.x, sign * step), "pushed") for sign in (1.0, -1.0)]
    others = _followed(shell, factor, equilibrium, starts, patient=True)
    return lowest(shell, factor, equilibrium, others)


def is_narrow(means: MeanFields) -> bool:
    """Whether the supports hold the sheet narrower than its natural size."""
    return means.chord < MIN_SIZE_RATIO * means.stretch


def buckle(
    shell: Shell, factor: Factor, equilibrium: ShellEquilibrium, means: MeanFields, guesses: Sequence[SimpleShape]
) -> ShellEquilibrium:
    """The lowest of a minimum and of those that caps and a few arcs, taken from the guesses, lead to."""
    builder = GuessBuilder(shell, factor, means.centre, means.stretch)
    arcs = [shape for shape in guesses if shape.name in ("arc", "bent")]
    tried = [shape for shape in guesses if shape.name == "cap"] + arcs[:: max(len(arcs) // ARC_GUESSES, 1)]
    guessed = [builder.relax_in_plane(builder.bend(shape)) for shape in tried]
    others = _followed(shell, factor, equilibrium, [(start.x, start.shape.name) for start in guessed])
    low = min(others, key=lambda other: other.energy)
    if not low.is_minimum and low.energy < equilibrium.energy:
        others.append(follow(shell, low.x, factor, low.guess))
    return lowest(shell, factor, equilibrium, others)


def buckle_soft(
    shell: Shell, factor: Factor, equilibrium: ShellEquilibrium, means: MeanFields, guesses: Sequence[SimpleShape]
) -> ShellEquilibrium:
    """The lowest of a minimum and of those that the tightest cap and arcs in three directions lead to."""
    caps = [shape for shape in guesses if shape.name == "cap"]
    arcs = [shape for shape in guesses if shape.name in ("arc", "bent")]
    family = [shape for shape in arcs if replace(shape, angle=arcs[0].angle) == arcs[0]]
    tightest = sorted(caps, key=lambda shape: abs(shape.curvature))[-1:]
    builder = GuessBuilder(shell, factor, means.centre, means.stretch)
    tried = tightest + family[:: max(len(family) // ARC_GUESSES, 1)]
    starts = sorted((builder.relax_in_plane(builder.bend(shape)) for shape in tried), key=lambda start: start.energy)
    promising = [
        (start.x, start.shape.name)
        for start in starts
        if start.energy - starts[0].energy <= (MAX_ENERGY_RATIO - 1.0) * abs(starts[0].energy)
    ]
    others = _followed(shell, factor, equilibrium, promising, max_iterations=SOFT_ITERATIONS)
    return lowest(shell, factor, equilibrium, others)


def _followed(
    shell: Shell,
    factor: Factor,
    equilibrium: ShellEquilibrium,
    starts: Sequence[tuple[Floats, str]],
    patient: bool = False,
    max_iterations: int = MAX_FURTHER_ITERATIONS,
) -> list[ShellEquilibrium]:
    """The equilibria that states with names lead to; arguments as in `follow`. A known minimum is met early."""
    others: list[ShellEquilibrium] = []
    for x, name in starts:
        known = [each.x for each in (equilibrium, *others) if each.is_minimum]
        others.append(follow(shell, x, factor, name, patient=patient, max_iterations=max_iterations, known=known))
    return others


def is_inverted(shell: Shell, x: Floats, side: Side) -> bool:
    """Whether a supported sheet x (N, 3) lies completely on the wrong side of its supports for the given side."""
    heights = (shell.node_positions(x)[:, 2] - shell.support_level[2]) * (1.0 if side == "down" else -1.0)
    return bool(heights.min() < -FLAT_SAG_MM and heights.max() < MAX_RISE_SHARE * -heights.min())


def lowest(
    shell: Shell, factor: Factor, equilibrium: ShellEquilibrium, others: Sequence[ShellEquilibrium]
) -> ShellEquilibrium:
    """The lowest of several minima, with the history of all attempts; the factor then holds its Hessian."""
    best = equilibrium
    for other in others:
        if other.is_minimum and other.energy < best.energy - EQUAL_ENERGY * abs(best.energy):
            best = other
    factorise(shell, best.x, factor)
    if best is not equilibrium:
        best = replace(best, soft_modes=softest_shell_modes(shell, best.x, factor)[0])
    return replace(best, trials=equilibrium.trials + tuple(trial for other in others for trial in other.trials))
