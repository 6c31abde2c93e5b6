"""New states of a preview: from a design, from another state after an edit, or on a given side.

Each function returns a state, and leaves the one it was given as it is, but for the content of the factor.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.evidence import ShellEquilibrium
from asterism.fem.search.linear_response import Response, linear_response
from asterism.fem.search.mean_fields import Side
from asterism.fem.search.relax import factorise, follow, softest_shell_modes
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import Symmetry
from asterism.previews.search_minima import SheetTraits, apply_supports, find_equilibrium
from asterism.previews.state import AnyPreviewState, LawT, PreviewState, SheetT, ShownResponse, ValuesT

# name of the start of an equilibrium that an edit led to
EDIT_START = "edit"
# name of the start of an equilibrium that was chosen from other forms, or restored
FORM_START = "form"


def state_from_guesses(
    sheet: SheetT, law: LawT, values: ValuesT, side: Side, clock: Clock, watch: Callable[[], None]
) -> PreviewState[SheetT, LawT, ValuesT]:
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
    equilibrium = replace(equilibrium, x=shell.shifted_to_ground(equilibrium.x))
    return PreviewState(sheet, law, side, values, shell, equilibrium, equilibrium, factor, watch)


def state_without_search(
    sheet: SheetT, law: LawT, values: ValuesT, side: Side, watch: Callable[[], None]
) -> PreviewState[SheetT, LawT, ValuesT]:
    """The state of a sheet with all of its supports, at the printed sheet in place of an equilibrium.

    Raises
    ------
    DesignError, LawError
        As for `state_from_guesses`.
    """
    shell = sheet.shell(sheet.fields(values), sheet.layout.pin_steps[-1])
    x = shell.flat
    printed = ShellEquilibrium(x, shell.strains(x), {}, np.inf, 0.0, False, np.empty(0), "printed")
    factor = WatchedFactor(shell.factor(), watch)
    return PreviewState(sheet, law, side, values, shell, printed, printed, factor, watch, is_factor_resting=False)


def carried(state: AnyPreviewState, new: AnyPreviewState) -> Floats | None:
    """(N, 3) positions of the dofs of another sheet where the resting equilibrium of a state takes its points.

    None if the other sheet reaches far beyond that one.
    """
    space, x = state.sheet.space, state.resting.x
    try:
        return np.asarray(new.sheet.space.interpolate(lambda points: space.locate(points).jets(x)))
    except ValueError:
        return None


def with_pattern(state: AnyPreviewState, design: Design, layout: Layout, values: Any) -> AnyPreviewState:
    """The state with another pattern, and pins at other places in space, on the same print.

    Its equilibrium is still that of the old ones.

    Raises
    ------
    DesignError
        The supports contradict each other.
    LawError
        The rest metric is not positive definite.
    """
    sheet = state.sheet.with_pattern(design, layout)
    fields = sheet.fields(values)
    shell = state.shell.with_fields(fields, sheet.loads() if design.gravity.on else None)
    if not state.sheet.has_pins_of(layout):
        shell = shell.with_target(sheet.support_target())
    shown = None if state.shown is None else state.shown.renewed(state.sheet, sheet)
    return replace(state, sheet=sheet, values=values, shell=shell, shown=shown)


def respond(state: AnyPreviewState, clock: Clock) -> tuple[AnyPreviewState, Response | None]:
    """The state after the linear response of its resting equilibrium to a change, and that response.

    The response is None if the factor had lost the resting equilibrium, and that is unstable after the change: the
    state is then a new equilibrium.
    """
    resting, shell, factor = state.resting, state.shell, state.factor
    if not state.is_factor_resting:
        state = replace(state, is_factor_resting=factorise(shell, resting.x, factor))
    if not state.is_factor_resting:
        return restarted(state, clock), None
    with clock("linear response"):
        response = linear_response(shell, resting.x, factor)
    shown = ShownResponse(shell, resting, response, shell.shifted_to_ground(response.x))
    return replace(state, result=shown), response


def followed(state: AnyPreviewState, response: Response, clock: Clock) -> AnyPreviewState:
    """The state at the equilibrium that the linear response leads to, or from guesses if that is no minimum."""
    start = response.x, state.factor, EDIT_START, response.strains
    with clock("equilibrium"):
        equilibrium = follow(state.shell, *start)
    if not equilibrium.is_minimum:
        return restarted(state, clock)
    equilibrium = replace(equilibrium, x=state.shell.shifted_to_ground(equilibrium.x))
    return replace(state, result=equilibrium, resting=equilibrium, is_factor_resting=True)


def restarted(state: AnyPreviewState, clock: Clock, side: Side | None = None) -> AnyPreviewState:
    """The state of the same design from guesses, on another side if one is given."""
    new = state_from_guesses(state.sheet, state.law, state.values, side or state.side, clock, state.watch)
    return replace(new, shown=state.shown)


def at_form(state: AnyPreviewState, x: Floats, clock: Clock) -> AnyPreviewState:
    """The state at the equilibrium near positions x (N, 3) of the shell's dofs, with the trials of the last one.

    The state is that from guesses if x leads to no minimum.
    """
    start = state.shell.constrain(x), state.factor, FORM_START
    with clock("equilibrium"):
        equilibrium = follow(state.shell, *start)
    if not equilibrium.is_minimum:
        return restarted(state, clock)
    x = state.shell.shifted_to_ground(equilibrium.x)
    trials = state.resting.trials
    equilibrium = replace(equilibrium, x=x, trials=trials if len(trials) > 1 else equilibrium.trials)
    return replace(state, result=equilibrium, resting=equilibrium, is_factor_resting=True)


def with_near_zero_modes(state: AnyPreviewState, clock: Clock) -> AnyPreviewState:
    """The state whose equilibrium has its softest modes, if it is a minimum; edits do not wait for them."""
    shown = state.equilibrium
    if not shown.is_minimum:
        return state
    if not state.is_factor_resting:  # an edit that changes nothing was interrupted
        state = replace(state, is_factor_resting=factorise(state.shell, shown.x, state.factor))
    if not len(shown.soft_modes):
        with clock("soft modes"):
            stiffness, _ = softest_shell_modes(state.shell, shown.x, state.factor)
        state = replace(state, result=replace(shown, soft_modes=stiffness))
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
