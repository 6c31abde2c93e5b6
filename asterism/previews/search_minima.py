"""The equilibrium that a preview shows: the lowest minimum among those that simple shapes lead to.

1. The initial guesses of `fem.search`: caps, tubes about several axes, saddles; the most promising ones are followed.
2. Where experience shows that other forms are likely, more are tried: caps for free sheets whose stars curl within
   their own spacing; other kinds of guesses for free sheets without symmetry that have two near-zero modes; the flat
   sheet for supported sheets that come out inverted; both sides of the softest mode for supported sheets with
   two soft modes; caps and arcs for supported sheets that are narrower than their natural size, soft or not.
3. If one side is asked for, the lowest minimum on that side.

**Narrow sheets.** A sheet that its supports hold narrower than its natural size buckles. Its form depends on the start,
and all forms are stiff, so that no near-zero mode shows the others. Soft modes need not point to the other forms
either.

**Near-zero modes** are motions of the sheet that cost little energy. A mode with the eigenvalue `s_i` (N/mm^3) of the
Hessian against the printed area A would take the energy E at stake (`fem.search.relax`) up to this amplitude, rms
over the sheet, in % of its diameter D:

    a_i = 100/D sqrt(2 E / (s_i A)).

One near-zero mode is common: the rotation of a tube's axis. A sheet with two near-zero modes may rest in another form.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.initial_guesses import MAX_ENERGY_RATIO, GuessBuilder, candidate_shapes
from asterism.fem.search.mean_fields import FLAT_SAG_MM, MeanFields, Side, mean_fields, side_of
from asterism.fem.search.relax import (
    MAX_FURTHER_ITERATIONS,
    ShellEquilibrium,
    Trial,
    factorise,
    follow,
    relax,
    softest_shell_modes,
)
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.fem.shell.shell import Shell
from asterism.pattern.geometry.rigid_fit import rigid_fit

# two minima count as one form if their energies differ by less than this share
EQUAL_ENERGY = 1e-3
# sheets with a smaller ratio of supported size to natural size may buckle
MIN_SIZE_RATIO = 0.95
# kinds of initial guesses with an axis; caps are the others that are not flat
ROLLED = {"arc", "bent", "saddle"}


def is_equilibrium_near_another(
    shell: Shell, equilibrium: ShellEquilibrium, size: float, percent: float = 18.0
) -> bool:
    """Whether a sheet with a diameter of about `size` mm has two modes with amplitudes above `percent`.

    With larger ones the search tries further starts; the limit is chosen by hand.
    """
    if len(equilibrium.soft_modes) < 2:
        return False
    # smaller and negative eigenvalues are replaced by this one
    stiffness = max(np.sort(equilibrium.soft_modes)[1], 1e-12)
    area = float(shell.assembly.weights.sum())
    return bool(100.0 / size * np.sqrt(2.0 * equilibrium.absolute_energy / (stiffness * area)) > percent)


def is_narrow(means: MeanFields) -> bool:
    """Whether the supports hold the sheet narrower than its natural size."""
    return means.chord < MIN_SIZE_RATIO * means.stretch


def is_inverted(shell: Shell, x: Floats, side: Side) -> bool:
    """Whether a supported sheet x (N, 3) lies completely on the wrong side of its supports for the given side."""
    heights = (shell.node_positions(x)[:, 2] - shell.support_level[2]) * (1.0 if side == "down" else -1.0)
    # an inverted sheet rises above its supports by less than this share of its depth below them
    return bool(heights.min() < -FLAT_SAG_MM and heights.max() < 0.1 * -heights.min())


def find_equilibrium(
    shell: Shell,
    factor: Factor,
    side: Side,
    has_equal_stars: bool = False,
    has_tight_curls: bool = False,
    turns: Sequence[Floats] = (),
) -> ShellEquilibrium:
    """The lowest minimum that the guesses lead to, on the side that is asked for if one is reached there.

    `has_equal_stars`: whether all stars have one size; `has_tight_curls`: whether many of them are not scale-separated;
    `turns`: (2, 2) rotations and mirrors of the design's symmetries; axes that they make equal count once. The factor
    then holds the exact Hessian at the equilibrium, if that is definite.
    """
    search = _Search(shell, factor, side, has_equal_stars, has_tight_curls, turns)
    equilibrium = search.lowest_on_any_side()
    if side == "auto" or side_of(shell, equilibrium.x) == side:
        return equilibrium
    return search.lowest_on_side(equilibrium)


@dataclass(eq=False)
class _Search:
    """The search for the lowest minimum of a shell; see `find_equilibrium`."""

    shell: Shell
    factor: Factor
    side: Side
    has_equal_stars: bool
    has_tight_curls: bool
    turns: Sequence[Floats]

    @cached_property
    def means(self) -> MeanFields:
        return mean_fields(self.shell)

    def guesses(self, *names: str) -> list[SimpleShape]:
        """The simple shapes of these kinds, or all of them."""
        shapes = candidate_shapes(self.means, self.shell.extent, self.side)
        return [shape for shape in shapes if shape.name in names or not names]

    def relax(self, shapes: Sequence[SimpleShape] | None = None, **limits: Any) -> ShellEquilibrium:
        return relax(self.shell, self.factor, self.side, shapes, symmetries=self.turns, **limits)

    def lowest_on_side(self, equilibrium: ShellEquilibrium) -> ShellEquilibrium:
        """The lowest minimum on the side, from guesses there if none was met yet; `equilibrium` if it has none."""
        shell, factor = self.shell, self.factor

        def on_side() -> list[Trial]:
            return [trial for trial in equilibrium.trials if trial.is_minimum and side_of(shell, trial.x) == self.side]

        kinds = (*ROLLED, "cap")
        if not on_side() and (bent := self.guesses(*kinds)):
            more = self.relax(bent, max_guesses=len(kinds))
            equilibrium = replace(equilibrium, trials=equilibrium.trials + more.trials)
        best = min(on_side(), key=lambda trial: trial.energy, default=None)
        if best is None:
            factorise(shell, equilibrium.x, factor)
            return equilibrium
        there = follow(shell, best.x, factor, best.name)  # best.x is a minimum; this recomputes evidence and factor
        stiffness = softest_shell_modes(shell, there.x, factor)[0]
        return replace(there, trials=equilibrium.trials, soft_modes=stiffness, iterations=best.iterations)

    def lowest_on_any_side(self) -> ShellEquilibrium:
        """The lowest minimum; the guesses are on the requested side, but may lead to the other one."""
        shell, means, natural_size = self.shell, self.means, self.means.stretch * self.shell.extent
        if len(shell.fixed_points) == 0:
            # a free sheet of equal stars whose natural turn from side to side is larger is a tube; caps are not tried
            if self.has_equal_stars and abs(means.curvature) * natural_size > 3.0:
                tube = self.relax(self.guesses("arc", "flat"), max_guesses=1)
                if tube.is_minimum:
                    return tube
            return self._lowest_free(self.relax())
        equilibrium = self.relax()
        right_side = means.side if self.side == "auto" else self.side
        if equilibrium.is_minimum and equilibrium.guess != "flat" and is_inverted(shell, equilibrium.x, right_side):
            equilibrium = self._lowest(equilibrium, [self.relax(self.guesses("flat"), max_guesses=1)])
        if not equilibrium.is_minimum:
            return equilibrium
        is_soft = is_equilibrium_near_another(shell, equilibrium, natural_size, percent=10.0)  # chosen by hand
        if is_soft:
            equilibrium = self._perturbed(equilibrium)
        return self._buckled(equilibrium, is_soft) if is_narrow(means) else equilibrium

    def _lowest_free(self, equilibrium: ShellEquilibrium) -> ShellEquilibrium:
        """The lowest of a free sheet's equilibrium and of those that further kinds of guesses lead to."""
        natural_size = self.means.stretch * self.shell.extent
        tried = {trial.name for trial in equilibrium.trials} - ROLLED | {"flat"}
        if sum(trial.name in ROLLED for trial in equilibrium.trials) > 1:
            tried |= ROLLED  # these have been tried in several directions
        offers: list[list[SimpleShape]] = []
        caps = self.guesses("cap")
        if self.has_tight_curls and caps and "cap" not in tried:
            # curvatures of the caps that are tried, over the curvature of the last cap among the guesses
            offers = [[replace(caps[-1], curvature=share * caps[-1].curvature)] for share in (1.0, 0.7)]
        elif len(self.turns) <= 1 and is_equilibrium_near_another(self.shell, equilibrium, natural_size):
            rest = [shape for shape in self.guesses() if shape.name not in tried]
            # by the direction of the axis, in three sectors of 60 degrees; caps are in the first one
            offers = [[shape for shape in rest if int(3.0 * shape.angle / np.pi) == third] for third in range(3)]
        best, trials = equilibrium, equilibrium.trials
        for offer in filter(None, offers):
            other = self.relax(offer, max_guesses=1)
            energies = [trial.energy for trial in trials if trial.is_minimum]
            trials += other.trials
            margin = EQUAL_ENERGY * abs(other.energy)
            if other.is_minimum and all(other.energy < energy - margin for energy in energies):
                best = other
        if len(trials) > len(equilibrium.trials):
            factorise(self.shell, best.x, self.factor)
        return replace(best, trials=trials)

    def _perturbed(self, equilibrium: ShellEquilibrium) -> ShellEquilibrium:
        """The lowest of a minimum and of those that a perturbation along its softest mode leads to, both ways."""
        shell = self.shell
        mode = softest_shell_modes(shell, equilibrium.x, self.factor, 1)[1][:, 0]
        # largest change of a degree of freedom in the perturbation, over the size of the sheet
        step = 0.04 * shell.extent / np.abs(shell.move(np.zeros_like(equilibrium.x), mode)).max() * mode
        starts = [(shell.move(equilibrium.x, sign * step), "pushed") for sign in (1.0, -1.0)]
        return self._lowest(equilibrium, self._followed(equilibrium, starts, patient=True))

    def _buckled(self, equilibrium: ShellEquilibrium, is_soft: bool) -> ShellEquilibrium:
        """The lowest of a narrow sheet's minimum and of those that caps and a few arcs lead to.

        For a soft sheet these are the tightest cap and arcs in three directions.
        """
        shell, factor = self.shell, self.factor
        builder = GuessBuilder(shell, factor, self.means.centre, self.means.stretch)
        caps, arcs = self.guesses("cap"), self.guesses("arc", "bent")
        if is_soft:
            caps = sorted(caps, key=lambda shape: abs(shape.curvature))[-1:]
            arcs = [shape for shape in arcs if replace(shape, angle=arcs[0].angle) == arcs[0]]
        # about this many arcs are initial guesses for a narrow sheet
        tried = caps + arcs[:: max(len(arcs) // 3, 1)]
        relaxed, most = [builder.relax_in_plane(builder.bend(shape)) for shape in tried], MAX_FURTHER_ITERATIONS
        if is_soft:
            relaxed.sort(key=lambda guess: guess.energy)
            # iterations for each guess of a narrow soft sheet: arcs take up to this many there
            limit, most = (MAX_ENERGY_RATIO - 1.0) * abs(relaxed[0].energy), 30
            relaxed = [guess for guess in relaxed if guess.energy - relaxed[0].energy <= limit]
        starts = ((guess.x, guess.shape.name) for guess in relaxed)
        others = self._followed(equilibrium, starts, patient=False, max_iterations=most)
        low = min(others, key=lambda other: other.energy)
        if not is_soft and not low.is_minimum and low.energy < equilibrium.energy:
            others.append(follow(shell, low.x, factor, low.guess))
        return self._lowest(equilibrium, others)

    def _followed(
        self, equilibrium: ShellEquilibrium, starts: Iterable[tuple[Floats, str]], **limits: Any
    ) -> list[ShellEquilibrium]:
        """The equilibria that states with names lead to, see `follow`; a known minimum is met early."""
        others: list[ShellEquilibrium] = []
        for x, name in starts:
            known = [each.x for each in (equilibrium, *others) if each.is_minimum]
            others.append(follow(self.shell, x, self.factor, name, known=known, **limits))
        return others

    def _lowest(self, equilibrium: ShellEquilibrium, others: Sequence[ShellEquilibrium]) -> ShellEquilibrium:
        """The lowest of several minima, with the history of all attempts; the factor then holds its Hessian."""
        best = equilibrium
        for other in others:
            if other.is_minimum and other.energy < best.energy - EQUAL_ENERGY * abs(best.energy):
                best = other
        factorise(self.shell, best.x, self.factor)
        if best is not equilibrium:
            best = replace(best, soft_modes=softest_shell_modes(self.shell, best.x, self.factor)[0])
        return replace(best, trials=equilibrium.trials + tuple(trial for other in others for trial in other.trials))


def apply_supports(shell: Shell, factor: Factor, x: Floats, was_free: bool) -> ShellEquilibrium:
    """The equilibrium with the shell's supports, from a state x (N, 3) mm that does not meet all of them.

    A sheet that was free is first laid where its supported points come closest to their places.
    """
    target = shell.reduction.target
    if was_free:
        x = _laid_on_supports(shell, x, target.reshape(-1, 3))
    start = x.ravel() - shell.reduction.map @ shell.reduction.project(x)
    # the supported degrees of freedom move to their places in steps
    for share in np.arange(1, 7) / 6:
        moved = shell.with_target((1.0 - share) * start + share * target)
        equilibrium = follow(moved, moved.constrain(x), factor, "pins take hold")
        x = equilibrium.x
    return equilibrium


def _laid_on_supports(shell: Shell, x: Floats, places: Floats) -> Floats:
    """(N, 3) x after the rigid motion that brings supported points closest to their places (N, 3)."""
    held = shell.fixed_points
    rotation, shift = rigid_fit(x[held], places[held])
    return np.asarray(shell.translated(x @ rotation.T, shift))
