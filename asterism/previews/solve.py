"""The state of a preview: all that it has computed, as one frozen value, and the states that changes lead to.

A change of the design makes a new state from the old one, and the session then replaces the old by the new one as a
whole. So an edit that fails or is interrupted leaves the old state, but for the content of the factor. States share
what did not change: mesh, smoothed cells, supports, and the factor.

The linear response of an edit gives a picture its positions. Its energies and its gradient would take a third of the
time of a response, and are computed when a summary asks for them.

**Other forms.** The search may meet further minima besides the one that is shown. Two minima are one form if a motion
that the supports leave free and a symmetry of the design bring their star centres together, or the sites of the lattice
of a motif.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.linear_response import Response, linear_response
from asterism.fem.search.mean_fields import Side
from asterism.fem.search.relax import ShellEquilibrium, Trial, energies_by_part, factorise, follow, softest_shell_modes
from asterism.fem.shell.shell import Shell
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.free_motions import FreeMotions, free_motions
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import Symmetry, distances_of_images
from asterism.previews.print_sheet import PrintSheet
from asterism.previews.search_minima import apply_supports, find_equilibrium
from asterism.results.records.shape import OtherFormRecord

# names of the start of an equilibrium: that an edit led to, and that was chosen from other forms, or restored
EDIT_START, FORM_START = "edit", "form"


@dataclass(frozen=True, eq=False)
class PreviewState:
    """A design, its shell, and its state, for any pattern. Functions that return a state do not change this one."""

    sheet: PrintSheet  # the print with its law, its mesh and its model
    side: Side  # to which the edges were asked to go
    shell: Shell  # with the supports of all steps
    resting: ShellEquilibrium  # the last equilibrium, from which edits go on
    factor: Factor  # a solver for the shell's Hessians. Its content changes while an equilibrium is sought.
    watch: Callable[[], None]  # called at least once in each Newton iteration; an error that it raises ends the search
    is_factor_resting: bool = True  # whether the factor holds the Hessian at `resting`
    # after the first stage of an edit, the linear response, which is shown in place of `resting`
    response: Response | None = None

    @classmethod
    def from_guesses(cls, sheet: PrintSheet, side: Side, clock: Clock, watch: Callable[[], None]) -> PreviewState:
        """The state at the equilibrium that initial guesses lead to, after all supports have taken hold.

        Raises DesignError: the supports contradict each other.
        Raises LawError: the rest metric is not positive definite.
        """
        with clock("fields"):
            values = sheet.values
            fields = sheet.fields(values)
        was_free = True
        for step in sheet.layout.pin_steps:
            with clock("shell"):
                shell = sheet.shell(fields, step)
            factor = WatchedFactor(shell.factor(), watch)
            if step == 0:
                symmetries: list[Symmetry] = []
                if shell.is_free:
                    with clock("symmetries"):
                        symmetries = sheet.symmetries
                turns = [each.turn for each in symmetries]
                with clock("equilibrium"):
                    equilibrium = find_equilibrium(
                        shell, factor, side, values.is_uniform, values.has_tight_curls, turns
                    )
            else:
                with clock("pins"):
                    equilibrium = apply_supports(shell, factor, equilibrium.x, was_free)
            was_free = len(shell.fixed_points) == 0
        equilibrium = replace(equilibrium, state=shell.shifted_to_ground(equilibrium.x))
        return cls(sheet, side, shell, equilibrium, factor, watch)

    @cached_property
    def x(self) -> Floats:
        """(N, 3) mm, positions of the shell's dofs as shown."""
        return self.resting.x if self.response is None else self.shell.shifted_to_ground(self.response.x)

    @cached_property
    def equilibrium(self) -> ShellEquilibrium:
        """What is shown, with its certificate; a linear response is a minimum only if the edit changes nothing."""
        shell, resting, response = self.shell, self.resting, self.response
        if response is None:
            return resting
        gradient = float(np.linalg.norm(shell.gradient(response.x)))
        definite = resting.definite and gradient <= resting.tolerance
        return replace(
            resting,
            state=self.x,
            strains=response.strains,
            energy=shell.energy(response.x),
            energies=energies_by_part(shell, response.x),
            gradient_norm=gradient,
            definite=definite,
            soft_modes=resting.soft_modes if definite else np.empty(0),
            trials=(),
        )

    @property
    def design(self) -> Design:
        """The design that is previewed."""
        return self.sheet.design

    @property
    def layout(self) -> Layout:
        """Its layout."""
        return self.sheet.layout

    @property
    def is_supported(self) -> bool:
        """Whether supports act along the print; a sheet that slides on all of its supports counts as free."""
        return self.layout.is_supported_in_plane

    def on(self, sheet: PrintSheet, clock: Clock) -> PreviewState:
        """The state with another sheet and all of its supports; errors as of `from_guesses`.

        On a sheet of the same print, with another pattern or with pins at other places in space, its equilibrium is
        still that of the old sheet. On another print it is none, but the printed sheet.
        """
        with clock("fields"):
            fields = sheet.fields(sheet.values)
        with clock("shell"):
            shell = sheet.shell(fields, sheet.layout.pin_steps[-1])
            if sheet.space is self.sheet.space:
                return replace(self, sheet=sheet, shell=shell)
            x = shell.flat
            start = ShellEquilibrium(x, np.inf, np.inf, 0.0, strains=shell.strains(x), energies={}, guess="printed")
            factor = WatchedFactor(shell.factor(), self.watch)
        return PreviewState(sheet, self.side, shell, start, factor, self.watch, is_factor_resting=False)

    def kept_form(self, sheet: PrintSheet, clock: Clock) -> PreviewState | None:
        """The state of another print, started from the resting equilibrium; None if the print reaches far beyond."""
        new, space = self.on(sheet, clock), self.sheet.space
        try:
            with clock("shell"):
                x = sheet.space.interpolate(lambda points: space.locate(points).jets(self.resting.x))
        except ValueError:
            return None
        return new.at_form(x, clock)

    def respond(self, clock: Clock) -> PreviewState:
        """The state with the linear response of its resting equilibrium to a change.

        If the factor had lost the resting equilibrium, and that is unstable after the change, it is a new equilibrium.
        """
        state, resting = self.with_resting_factor(), self.resting
        if not state.is_factor_resting:
            return self.restarted(clock)
        with clock("linear response"):
            return replace(state, response=linear_response(self.shell, resting.x, self.factor))

    def followed(self, clock: Clock) -> PreviewState:
        """The state at the equilibrium that its linear response leads to, or from guesses if that is no minimum."""
        response = self.response
        assert response is not None
        with clock("equilibrium"):
            equilibrium = follow(self.shell, response.x, self.factor, EDIT_START, response.strains)
        return self._at_rest(equilibrium) if equilibrium.is_minimum else self.restarted(clock)

    def restarted(self, clock: Clock, side: Side | None = None) -> PreviewState:
        """The state of the same design from guesses, on another side if one is given."""
        return PreviewState.from_guesses(self.sheet, side or self.side, clock, self.watch)

    def at_form(self, x: Floats, clock: Clock) -> PreviewState:
        """The state at the equilibrium near dofs x (N, 3), with the trials of the last one; or else from guesses."""
        with clock("equilibrium"):
            equilibrium = follow(self.shell, self.shell.constrain(x), self.factor, FORM_START)
        if not equilibrium.is_minimum:
            return self.restarted(clock)
        trials = self.resting.trials
        return self._at_rest(replace(equilibrium, trials=trials if len(trials) > 1 else equilibrium.trials))

    def _at_rest(self, equilibrium: ShellEquilibrium) -> PreviewState:
        """The state at an equilibrium, on the ground."""
        equilibrium = replace(equilibrium, state=self.shell.shifted_to_ground(equilibrium.x))
        return replace(self, resting=equilibrium, is_factor_resting=True, response=None)

    def with_resting_factor(self) -> PreviewState:
        """The state whose factor holds the Hessian at its resting equilibrium, if that is definite."""
        if self.is_factor_resting:
            return self
        return replace(self, is_factor_resting=factorise(self.shell, self.resting.x, self.factor))

    def with_near_zero_modes(self, clock: Clock) -> PreviewState:
        """The state whose equilibrium has its softest modes, if it is a minimum; edits do not wait for them."""
        resting = self.resting
        if not self.equilibrium.is_minimum:
            return self
        state = self.with_resting_factor()  # an edit that changes nothing may have been interrupted
        if not len(resting.soft_modes):
            with clock("soft modes"):
                stiffness, _ = softest_shell_modes(self.shell, resting.x, self.factor)
            state = replace(state, resting=replace(resting, soft_modes=stiffness))
        return state


@dataclass
class WatchedFactor:
    """A `Factor` that calls `watch` before each factorisation and solution; an error of `watch` ends the search.

    Every Newton iteration solves at least once.
    """

    factor: Factor
    watch: Callable[[], None]

    def __post_init__(self) -> None:
        self.name = self.factor.name

    def factorise(self, data: Floats) -> bool:
        self.watch()
        return self.factor.factorise(data)

    def solve(self, b: Floats) -> Floats:
        self.watch()
        return self.factor.solve(b)

    def close(self) -> None:
        self.factor.close()


def other_forms(state: PreviewState) -> list[tuple[OtherFormRecord, Trial]]:
    """The other forms, each with the trial that found it; the lowest one is first."""
    shown, layout = state.resting, state.layout
    minima = sorted((trial for trial in shown.trials if trial.is_minimum), key=lambda trial: trial.energy)
    # sheets with fewer stars or sites have no list of other forms, because these points cannot distinguish them
    if len(minima) < 2 or len(layout.sample_points) < 3:
        return []
    diameter_mm = diameter(state.shell.node_positions(shown.x))
    known, forms = [(shown.x, _free(state, shown.x))], list[tuple[OtherFormRecord, Trial]]()
    for trial in minima:
        apart = [100.0 * _distance(state, form, trial.x, free) / diameter_mm for form, free in known]
        # two minima have the same form if the rms distance of these points, in % of the diameter, is at most this
        if min(apart) > 2.0:
            form = OtherFormRecord(
                start=trial.name,
                energy_n_mm=trial.energy,
                gap=(trial.energy - shown.energy) / shown.absolute_energy,
                distance_percent=float(apart[0]),
            )
            forms.append((form, trial))
            known.append((trial.x, _free(state, trial.x)))
    return forms


def _distance(state: PreviewState, first: Floats, second: Floats, free: FreeMotions) -> float:
    """mm, rms distance of two minima (N, 3) by their dofs, after the nearest symmetry and free motion."""
    points, space = state.layout.sample_points, state.sheet.space
    at = space.locate(points).value

    def second_at(places: Floats) -> Floats:
        return np.asarray(space.locate(places).value @ second)

    return float(distances_of_images(points, at @ first, second_at, state.sheet.symmetries, free).min())


def _free(state: PreviewState, x: Floats) -> FreeMotions:
    """The rigid motions that the supports leave to a minimum."""
    supports = state.layout.support_samples
    if len(supports.printed) == 0:
        return FreeMotions()
    positions = state.sheet.space.locate(supports.printed).value @ x
    return free_motions(supports, positions, state.design.gravity.pull)
