"""From the print to a certified equilibrium, on one mesh."""

from __future__ import annotations

from typing import Literal, get_args

from asterism.discrete.evidence.equilibrium import Equilibrium
from asterism.discrete.model.contact_model import is_intersection_free
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.release.continuation import ReleaseContinuation, Report
from asterism.discrete.release.release_start import ReleaseStart

StartKind = Literal["bump", "flat"]


def solve_on_mesh(
    model: DiscreteModel,
    start: StartKind | ReleaseStart | State = "bump",
    seed: int = 0,
    backend: str = "auto",
    report: Report | None = None,
    coarse: bool = False,
) -> Equilibrium:
    """Find an equilibrium of a model and certify it.

    Parameters
    ----------
    model : the model; it is fully released at the end, also after an exception.
    start : `bump`: every star starts 2 mm to the side that its layout prescribes (up by default), and flat stars are
        nudged to that side between the steps. `flat`: as printed. A `ReleaseStart`: as it states. A state: minimised
        at full release with all pins in place.
    seed : seed of the noise (standard deviation 0.001 mm) that breaks the symmetry of the start.
    backend : linear solver, see `equilibrium.linear.backends`.
    report : called after every iteration with the name of the stage.
    coarse : a finer mesh follows. The result is only as accurate as it needs, and usually has no certificate.

    Returns
    -------
    The equilibrium; `is_minimum` is its certificate.

    Raises
    ------
    ValueError
        The start has no such name, or a given state intersects itself and the model has contact.

    Examples
    --------
    A single star without rest curvature of its arms, as coarse as it can be meshed:

    >>> from asterism.pattern import gallery
    >>> from asterism.pattern.layout.build import layout
    >>> from asterism.pattern.mesh.meshing import mesh_layout
    >>> design = gallery.load("star")
    >>> plan = layout(design)
    >>> model = DiscreteModel(design, plan, mesh_layout(plan, 6.0))
    >>> equilibrium = solve_on_mesh(model, ReleaseStart(releases=(0.3, 1.0)), backend="superlu")
    >>> equilibrium.is_minimum, equilibrium.stars_up, [step.release for step in equilibrium.path]
    (True, 1, [0.3, 1.0, 1.0])
    """
    continuation = ReleaseContinuation(backend, report, seed, coarse)
    if isinstance(start, State):
        model.set_release(1.0)
        state = model.apply_supports(start)
        if not is_intersection_free(model, state):
            raise ValueError("start: the state passes through itself; contact cannot separate intersecting parts")
        return continuation.minimise_from(model, state)
    if not isinstance(start, ReleaseStart):
        if start not in get_args(StartKind):
            raise ValueError(f"start = {start!r}: must be one of {', '.join(get_args(StartKind))}")
        start = ReleaseStart(bumps=start == "bump", seed=seed)
    try:
        return continuation.follow(model, start)
    except BaseException:
        model.set_release(1.0)  # also after an interruption
        raise
