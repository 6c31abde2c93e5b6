"""New states of a preview: from a design, from another state after an edit, or on a given side.

Each function returns a state, and leaves the one it was given as it is, but for the content of the factor.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.evidence import ShellEquilibrium
from asterism.fem.search.linear_response import linear_response
from asterism.fem.search.mean_fields import Side
from asterism.fem.search.relax import factorise, follow, softest_shell_modes
from asterism.pattern.layout.symmetries import Symmetry
from asterism.previews.print_sheet import PrintSheet
from asterism.previews.search_minima import SheetTraits, apply_supports, find_equilibrium
from asterism.previews.state import PreviewState

# name of the start of an equilibrium that an edit led to
EDIT_START = "edit"
# name of the start of an equilibrium that was chosen from other forms, or restored
FORM_START = "form"


def state_from_guesses(sheet: PrintSheet, side: Side, clock: Clock, watch: Callable[[], None]) -> PreviewState:
    """The state at the equilibrium that initial guesses lead to, after all supports have taken hold.

    `watch` is called at least once in each Newton iteration, here and in later searches from this state.

    Raises
    ------
    DesignError
        The supports contradict each other.
    LawError
        The rest metric is not positive definite.
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
            traits = SheetTraits(values.is_uniform, values.has_tight_curls, [each.turn for each in symmetries])
            with clock("equilibrium"):
                equilibrium = find_equilibrium(shell, factor, side, traits)
        else:
            with clock("pins"):
                equilibrium = apply_supports(shell, factor, equilibrium.x, was_free)
        was_free = len(shell.fixed_points) == 0
    equilibrium = replace(equilibrium, state=shell.shifted_to_ground(equilibrium.x))
    return PreviewState(sheet, side, shell, equilibrium, factor, watch)


def printed(state: PreviewState, sheet: PrintSheet, clock: Clock) -> PreviewState:
    """The state of another sheet with all of its supports, at the printed sheet in place of an equilibrium.

    Raises
    ------
    DesignError, LawError
        As for `state_from_guesses`.
    """
    with clock("shell"):
        shell = sheet.shell(sheet.fields(sheet.values), sheet.layout.pin_steps[-1])
        x = shell.flat
        start = ShellEquilibrium(x, np.inf, np.inf, 0.0, strains=shell.strains(x), energies={}, guess="printed")
        factor = WatchedFactor(shell.factor(), state.watch)
    return PreviewState(sheet, state.side, shell, start, factor, state.watch, is_factor_resting=False)


def kept_form(state: PreviewState, sheet: PrintSheet, clock: Clock) -> PreviewState | None:
    """The state of another sheet, started from the resting equilibrium of a state; None if it reaches far beyond."""
    new, space = printed(state, sheet, clock), state.sheet.space
    try:
        with clock("shell"):
            x = sheet.space.interpolate(lambda points: space.locate(points).jets(state.resting.x))
    except ValueError:
        return None
    return at_form(new, x, clock)


def with_sheet(state: PreviewState, sheet: PrintSheet, clock: Clock) -> PreviewState:
    """The state with another sheet of the same print: another pattern, and pins at other places in space.

    Its equilibrium is still that of the old sheet.

    Raises
    ------
    DesignError
        The supports contradict each other.
    LawError
        The rest metric is not positive definite.
    """
    with clock("fields"):
        shell = state.shell.with_fields(sheet.fields(sheet.values), sheet.loads() if sheet.design.gravity.on else None)
        if not state.sheet.has_pins_of(sheet.layout):
            shell = shell.with_target(sheet.support_target())
    return replace(state, sheet=sheet, shell=shell)


def respond(state: PreviewState, clock: Clock) -> PreviewState:
    """The state with the linear response of its resting equilibrium to a change.

    If the factor had lost the resting equilibrium, and that is unstable after the change, it is a new equilibrium.
    """
    resting, shell, factor = state.resting, state.shell, state.factor
    if not state.is_factor_resting:
        state = replace(state, is_factor_resting=factorise(shell, resting.x, factor))
    if not state.is_factor_resting:
        return restarted(state, clock)
    with clock("linear response"):
        return replace(state, response=linear_response(shell, resting.x, factor))


def followed(state: PreviewState, clock: Clock) -> PreviewState:
    """The state at the equilibrium that its linear response leads to, or from guesses if that is no minimum."""
    response = state.response
    assert response is not None
    with clock("equilibrium"):
        equilibrium = follow(state.shell, response.x, state.factor, EDIT_START, response.strains)
    if not equilibrium.is_minimum:
        return restarted(state, clock)
    return _resting(state, equilibrium)


def restarted(state: PreviewState, clock: Clock, side: Side | None = None) -> PreviewState:
    """The state of the same design from guesses, on another side if one is given."""
    return state_from_guesses(state.sheet, side or state.side, clock, state.watch)


def at_form(state: PreviewState, x: Floats, clock: Clock) -> PreviewState:
    """The state at the equilibrium near positions x (N, 3) of the shell's dofs, with the trials of the last one.

    The state is that from guesses if x leads to no minimum.
    """
    with clock("equilibrium"):
        equilibrium = follow(state.shell, state.shell.constrain(x), state.factor, FORM_START)
    if not equilibrium.is_minimum:
        return restarted(state, clock)
    trials = state.resting.trials
    return _resting(state, replace(equilibrium, trials=trials if len(trials) > 1 else equilibrium.trials))


def _resting(state: PreviewState, equilibrium: ShellEquilibrium) -> PreviewState:
    """The state at an equilibrium, on the ground."""
    equilibrium = replace(equilibrium, state=state.shell.shifted_to_ground(equilibrium.x))
    return replace(state, resting=equilibrium, is_factor_resting=True, response=None)


def with_near_zero_modes(state: PreviewState, clock: Clock) -> PreviewState:
    """The state whose equilibrium has its softest modes, if it is a minimum; edits do not wait for them."""
    resting = state.resting
    if not state.equilibrium.is_minimum:
        return state
    if not state.is_factor_resting:  # an edit that changes nothing was interrupted
        state = replace(state, is_factor_resting=factorise(state.shell, resting.x, state.factor))
    if not len(resting.soft_modes):
        with clock("soft modes"):
            stiffness, _ = softest_shell_modes(state.shell, resting.x, state.factor)
        state = replace(state, resting=replace(resting, soft_modes=stiffness))
    return state


@dataclass
class WatchedFactor:
    """Calls `watch` before each factorisation and solution of another factor; an error of `watch` ends the search.

    Every Newton iteration solves at least once.
    """

    factor: Factor
    watch: Callable[[], None]

    def __post_init__(self) -> None:
        self.name = self.factor.name

    def factorise(self, data: Floats) -> bool:
        """See `Factor.factorise`."""
        self.watch()
        return self.factor.factorise(data)

    def solve(self, b: Floats) -> Floats:
        """See `Factor.solve`."""
        self.watch()
        return self.factor.solve(b)

    def close(self) -> None:
        """Free the memory."""
        self.factor.close()
