"""The exact shape from two starts: the released flat print, and the preview."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from asterism.discrete.release.continuation import Report, prefixed_report
from asterism.discrete.release.levels import Ladder, SharedSearch
from asterism.equilibrium.errors import Error
from asterism.exact.simulation import BY_ENERGY, FROM_DEFAULT_START, exact_shape, several_minima
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.session import preview
from asterism.process.progress import Say, ignore_line
from asterism.results.records.exact import MinimumRecord, StartsRecord
from asterism.shape.shape import Shape
from asterism.verification.verify import PREVIEW, RELEASE, right_shape, same_minimum, two_minima_warnings

# default number of starts of `simulate`
BOTH_STARTS = 2


def simulate(
    design: Design,
    backend: str = "auto",
    report: Report | None = None,
    say: Say | None = None,
    starts: int | None = None,
    near: Shape | None = None,
    law: Law[Any] | None = None,
) -> Shape:
    """Compute an equilibrium of the exact model.

    By default there are two starts, the released flat print and the preview, and the lower minimum is the result. A
    minimum whose stars are all on the side that the design asks for comes before others. If the starts end in two
    minima, `Shape.others` holds the second one, and the summary's `minima` compares them. A start that fails is left
    out, such as a preview of a fabric without a law. Drawn rods start from the flat print alone. With contact, a
    preview that passes through itself is no start.

    Parameters
    ----------
    design : from `load_design`, `new` or `Design.from_dict`.
    backend : linear solver: `auto`, `pardiso`, `cholmod`, `superlu`, or `amg` (multigrid, for little memory).
    report : called after every iteration with the name of the stage and an `Iteration`.
    say : called with a line of text at the beginning of each stage.
    starts : number of initial guesses on a coarse mesh, without the preview; 1 releases the flat print alone. See
        `asterism.exact.simulation.exact_shape`.
    near : shape of the same design, such as a preview, that is the only start.
    law : law of the preview; by default the one that the design names, or else that of the paper's material.

    Returns
    -------
    The shape. Its `summary` holds the certificate (`is_minimum`) and the whole design.

    Raises
    ------
    DesignError, MeshError
        The design cannot be printed, or its sheet cannot be meshed.
    BackendError
        The linear solver is not installed.
    ValueError
        `starts` is not a whole number above zero, or `near` is given with several starts.

    Examples
    --------
    >>> import asterism
    >>> star = asterism.new("star")
    >>> asterism.simulate(star).summary["minima"][0]["start_names"]
    ['release', 'preview']
    >>> asterism.simulate(star, starts=1).summary["starts"]
    1
    """
    if starts is not None or near is not None:
        return exact_shape(design, backend, report, say, 1 if starts is None else starts, near)
    tell = say or ignore_line
    plan = layout(design)
    shared = SharedSearch(Ladder(design, plan))
    released = exact_shape(design, backend, report, say, plan=plan, shared=shared)
    if plan.drawn is not None:  # the flat print is the only start of drawn rods
        return released
    try:
        shown = preview(design, law, plan=plan)
        if design.solver.contact and shown.summary["self_intersections"]:
            raise Error("it meets itself, which contact cannot undo")
        tell("started from the preview")
        near_report = prefixed_report(report, "from the preview")
        near = exact_shape(design, backend, near_report, say, near=shown, plan=plan, shared=shared)
    except (Error, FloatingPointError) as error:
        tell(f"no start from the preview: {' '.join(str(error).split())}")
        return released
    return lower_minimum(design, plan, released, near)


def lower_minimum(design: Design, plan: Layout, released: Shape, near: Shape) -> Shape:
    """The exact shape that counts, from the flat print or from the preview; with the other one if it is another one."""
    exact = {RELEASE: released, PREVIEW: near}
    agree, between = same_minimum(released, near, plan, symmetries(design, plan), design.gravity.pull)
    first = right_shape(exact)
    other = PREVIEW if first == RELEASE else RELEASE
    result, second = exact[first].summary, exact[other].summary
    lost = [name for name, shape in exact.items() if not shape.summary["is_minimum"]]
    if agree or lost:
        starts = [name for name in exact if name not in lost] or [first]
        found = StartsRecord(
            starts=BOTH_STARTS,
            starts_lost=len(lost),
            result_is=BY_ENERGY if starts == [PREVIEW] else FROM_DEFAULT_START,
            minima_seen=1,
            minima=[_entry(result, starts, 0.0)],
            next_minimum_percent=None,
        )
        return replace(exact[first], summary=result | vars(found))
    apart = between.rms_percent
    found = several_minima(
        [_entry(result, [first], 0.0), _entry(second, [other], apart)],
        [[0.0, apart], [apart, 0.0]],
        result.get("gravity", 0.0),
        starts=BOTH_STARTS,
        starts_lost=0,
    )
    warnings = [*result["warnings"], *two_minima_warnings(exact, first, apart)]
    return replace(exact[first], summary=result | vars(found) | {"warnings": warnings}, others=(exact[other],))


def _entry(summary: Mapping[str, Any], starts: list[str], distance_percent: float) -> MinimumRecord:
    same = ("energy_n_mm", "is_minimum", "stars_up", "roll_axis_deg", "smallest_eigenvalue", "vertices")
    return MinimumRecord(
        **{name: summary[name] for name in same},
        stars_off_branch=len(summary["stars_off_branch"]),
        starts=len(starts),
        start_names=starts,
        default=RELEASE in starts,
        distance_percent=distance_percent,
    )
