"""From the print to a certified equilibrium."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, get_args

from discrete.evidence.equilibrium import Equilibrium
from discrete.model.contact_model import is_intersection_free
from discrete.model.discrete_model import DiscreteModel
from discrete.model.state import State
from discrete.release.continuation import ReleaseContinuation, Report
from discrete.release.release_start import ReleaseStart
from equilibrium.newton.regularisation import Method

StartKind = Literal["bump", "flat"]


def solve_on_mesh(
    model: DiscreteModel,
    start: StartKind | ReleaseStart | State = "bump",
    releases: Sequence[float] | None = None,
    seed: int = 0,
    backend: str = "auto",
    method: Method = "blended",
    max_iterations: int = 500,
    report: Report | None = None,
) -> Equilibrium:
    """Equilibrium of a model.

    Parameters
    ----------
    start : `bump`: every star starts 2 mm to the side of its branch (up, which printing on the plastic side favours,
        unless the layout says otherwise), and is nudged between the steps while it is still flat; `flat`: as printed;
        a `ReleaseStart`; or a state, minimised at full release with all pins in place.
    releases : steps of the continuation; the last must be 1. The start's own by default.
    seed : of the noise (a thousandth of a mm) that takes an exactly symmetric start off its symmetry.
    backend : sparse factorisation, see `equilibrium.linear.factor`.
    report : called after every iteration with the stage's name.

    Raises
    ------
    ValueError
        Releases that do not grow from 0 to 1 or come with a state, no start or method of this name, or, with contact, a
        state that passes through itself.
    """
    if method not in get_args(Method):
        raise ValueError(f"method = {method!r}: must be one of {', '.join(get_args(Method))}")
    continuation = ReleaseContinuation(backend, method, max_iterations, report, seed)
    if isinstance(start, State):
        if releases is not None:
            raise ValueError("releases: a state is minimised at full release; give one or the other")
        model.set_release(1.0)
        state = model.apply_supports(start)
        if not is_intersection_free(model, state):
            raise ValueError("start: the state passes through itself, which contact cannot undo")
        return continuation.minimise_from(model, state)
    if not isinstance(start, ReleaseStart):
        if start not in get_args(StartKind):
            raise ValueError(f"start = {start!r}: must be one of {', '.join(get_args(StartKind))}")
        start = ReleaseStart(bumps=start == "bump", seed=seed)
    if releases is not None:
        start = replace(start, releases=tuple(releases))
    try:
        return continuation.follow(model, start)
    except BaseException:
        model.set_release(1.0)  # what is interrupted leaves the model as it was
        raise
