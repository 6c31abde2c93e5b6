"""`asterism.verify`: preview and exact shapes of one design, whether they are of one minimum or form, how far apart."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from asterism.discrete.release.continuation import Report
from asterism.discrete.release.forms import SAME_FORM_PERCENT
from asterism.discrete.release.levels import Ladder, SharedSearch
from asterism.equilibrium.newton.minimise import Iteration
from asterism.exact.simulation import exact_shape
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import Symmetry, symmetries
from asterism.previews.law_choice import serving_law
from asterism.previews.session import preview
from asterism.previews.sheet import preview_layout
from asterism.process.compiling import clock_without_compiling
from asterism.process.progress import Say, ignore_line
from asterism.process.version import __version__
from asterism.results.files import VERIFICATION_MODEL
from asterism.results.record import keys_of
from asterism.results.records.exact import ExactRecord, off_branch
from asterism.results.records.verification import DifferenceRecord, VerificationRecord, VerifiedStartRecord
from asterism.results.words import small_percent, star_numbers
from asterism.shape.comparison import Comparison, compare_shapes
from asterism.shape.measures import CellMean
from asterism.shape.shape import Shape

RELEASE = "release"  # name of the exact shape that is released from the flat print
PREVIEW = "preview"  # name of the exact shape that is started from the preview
# heights that differ by less than this part of the diameter count as equal: both sheets are nearly flat
FLAT_HEIGHT_FACTOR = 1e-3


@dataclass(frozen=True)
class Verification:
    """The preview and the exact shapes of one design, and their distances.

    Attributes
    ----------
    design : the design of all shapes.
    preview : the preview, with the corrugation of its stars.
    exact : exact shapes by their start: `release`, the continuation from the flat print, and `preview`.
    comparisons : the preview laid on each exact shape, by the same names.
    summary : the numbers of summary.json.
    """

    design: Design
    preview: Shape
    exact: dict[str, Shape]
    comparisons: dict[str, Comparison]
    summary: VerificationRecord = field(default_factory=lambda: VerificationRecord.from_json({}))

    @property
    def result(self) -> str:
        """Name of the exact shape that counts, see `right_shape`."""
        return right_shape(self.exact)

    @property
    def comparison(self) -> Comparison:
        """The preview laid on the exact shape that counts."""
        return self.comparisons[self.result]


STAGES = ("preview", "exact model from the flat print", "exact model from the preview", "comparison")
StageReport = Callable[[str, int, int], None]


def verify(
    design: Design,
    law: Law[Any] | None = None,
    backend: str = "auto",
    report: Report | None = None,
    say: Say | None = None,
    released: Shape | None = None,
    near: Shape | None = None,
    command: str | None = None,
    ready: Shape | None = None,
    progress: StageReport | None = None,
) -> Verification:
    """Compute the preview and two exact shapes, from the flat print and from the preview, and compare them.

    Parameters
    ----------
    law : law of the preview, as of `asterism.preview`.
    backend, report, say : as in `simulate`.
    released, near : exact shapes from the flat print and from the preview, if they are available already.
    command : command line, for the report.
    ready : a preview of this design, or another shape to compare instead, if it is available already.
    progress : called with the name of a stage, the number of completed steps, and the number of all steps. The stages
        are those of `STAGES`, in this order.

    Raises
    ------
    DesignError, MeshError, BackendError
        As in `simulate`.
    LawError
        The law is for another material.
    """
    tell, step = say or ignore_line, progress or (lambda stage, done, of: None)
    tell("preview")
    step(STAGES[0], 0, 1)
    with clock_without_compiling() as clock:
        begun = clock()
        plan = preview_layout(design)
        layout_s = clock() - begun
        if law is None and ready is None:
            law = serving_law(design, plan, say=tell)
        shared = SharedSearch(Ladder(design, plan))

        def timed(known: Shape | None, make: Callable[[], Shape], line: str = "") -> tuple[Shape, float]:
            """A shape and its computing time (s) with the shared layout; the recorded time if it is known."""
            if known is not None:
                return known, float(known.summary["wall_s"])
            if line:
                tell(line)
            begun = clock()
            return make(), clock() - begun + layout_s

        def solve(stage: str, near: Shape | None = None) -> Shape:
            counted = ExactProgress(stage, step)

            def reported(name: str, iteration: Iteration) -> None:
                counted.report(name, iteration)
                if report:
                    report(name, iteration)

            shape = exact_shape(design, backend, reported, tell, near=near, plan=plan, shared=shared)
            counted.finish()
            return shape

        quick, preview_s = timed(ready, lambda: preview(design, law, plan=plan))
        tell(f"preview done in {preview_s:.2f} s")
        step(STAGES[0], 1, 1)
        released, exact_s = timed(released, lambda: solve(STAGES[1]), "exact model, released from the flat print")
        near, near_s = timed(near, lambda: solve(STAGES[2], quick), "exact model, started from the preview")
    tell("comparing")
    step(STAGES[3], 0, 1)
    same, pull = symmetries(design, plan), design.gravity.pull
    exact = {RELEASE: released, PREVIEW: near}
    by_release = compare_shapes(released, quick, plan, same, pull)
    comparisons = {RELEASE: by_release, PREVIEW: compare_shapes(near, quick, plan, same, pull, by_release.mean)}
    verification = Verification(design, quick, exact, comparisons)
    agree, between = same_minimum(released, near, plan, same, pull, by_release.mean)
    seconds = {"preview_s": preview_s, "exact_s": exact_s, "exact_from_preview_s": near_s}
    step(STAGES[3], 1, 1)
    return replace(verification, summary=_summary(verification, between, agree, seconds, command))


def _summary(
    verification: Verification,
    between: Comparison,
    agree: bool,
    seconds: dict[str, Any],
    command: str | None,
) -> VerificationRecord:
    result, other = verification.result, next(name for name in verification.exact if name != verification.result)
    exact = ExactRecord.from_json(verification.exact[result].summary)
    # a start that ends without a minimum has no form to compare with
    with_other = verification.comparisons[other].record if verification.exact[other].summary["is_minimum"] else None
    form = same_branch(verification.comparison.record, with_other, between.rms_percent) if exact.is_minimum else None
    preview = verification.preview.summary
    of_start = keys_of(VerifiedStartRecord).keys() - keys_of(DifferenceRecord).keys()
    return VerificationRecord(
        model=VERIFICATION_MODEL,
        **vars(verification.comparison.record),
        same_branch=form,
        speedup=seconds["exact_s"] / seconds["preview_s"],
        **seconds,
        mesh_error_percent=exact.mesh_error_percent,
        mesh_change_percent=exact.get("mesh_change_percent"),
        expected_rms_percent=preview.get("expected_rms_percent"),
        expected_height_percent=preview.get("expected_height_percent"),
        result_from=result,
        starts_agree=agree,
        starts_distance_percent=between.rms_percent,
        starts={
            name: VerifiedStartRecord(
                **vars(verification.comparisons[name].record),
                **{key: shape.summary[key] for key in of_start if key in shape.summary},
            )
            for name, shape in verification.exact.items()
        },
        warnings=verification_warnings(verification, between.rms_percent),
        version=__version__,
        preview=preview,
        exact=exact,
        design=verification.design.to_dict(),
        command=command,
    )


# number of steps of a stage
WHOLE = 100


class ExactProgress:
    """Counts the progress of an exact shape from the reports of `exact_shape`.

    Parameters
    ----------
    stage : name of the stage.
    tell : called with the stage, the number of completed steps, and the number of all steps.
    """

    def __init__(self, stage: str, tell: StageReport) -> None:
        self._stage, self._tell = stage, tell
        self._meshes: set[str] = set()
        self._done = 0
        tell(stage, 0, WHOLE)

    def report(self, text: str, iteration: Iteration) -> None:
        """Read the mesh and the share of the release from the name of a stage of `exact_shape`."""
        mesh, percent = re.match(r"(\d+) vertices", text), re.search(r"(\d+) %", text)
        if percent:  # the release on the coarsest mesh takes about half of the time
            share = 0.5 * int(percent[1]) / 100.0
        else:  # how many finer meshes there will be is not known: each takes a part of what those before have left
            self._meshes.add(mesh[1] if mesh else "")
            share = 1.0 - 0.5 * 0.6 ** len(self._meshes)
        # an unfinished stage stays below 100 %, and a repeated stage does not decrease the count
        self._done = max(self._done, min(int(WHOLE * share), WHOLE - 1))
        self._tell(self._stage, self._done, WHOLE)

    def finish(self) -> None:
        """Report that all steps are completed."""
        self._tell(self._stage, WHOLE, WHOLE)


def verification_warnings(verification: Verification, apart_percent: float) -> list[str]:
    """The warnings of preview, exact shape and comparison; `apart_percent` of the diameter is between both starts."""
    preview, exact = verification.preview.summary, verification.exact[verification.result].summary
    assert isinstance(exact, ExactRecord)
    lines = [*map(str, preview.get("warnings", []))]
    lines += _exact_shape(exact, lines)
    if not exact.is_minimum:  # without an exact minimum, the comparison has no meaning
        return lines
    lines += two_minima_warnings(verification.exact, verification.result, apart_percent)
    comparison = verification.comparison
    distance, expected = comparison.rms_percent, preview.get("expected_rms_percent")
    if expected is not None and distance > 2.0 * expected:
        estimate = f"the estimated error of the preview ({expected:.1f} %)"
        lines.append(f"the distance ({distance:.1f} %) is more than twice {estimate}")
    (right, shown), expected = comparison.record.heights_mm, preview.get("expected_height_percent")
    # largest difference of the heights, in % of the exact height, without a warning if the preview has no estimate
    limit = 10.0 if expected is None else 2.0 * expected
    off = 100.0 * abs(shown - right)
    if off > 100.0 * FLAT_HEIGHT_FACTOR * comparison.diameter_mm and off > limit * right:
        heights = f"the preview is {shown:.1f} mm high, the exact shape {right:.1f} mm"
        estimate = "" if expected is None else f", more than twice its estimated error ({expected:.1f} %)"
        lines.append(f"{heights}: {off / right:.0f} % off{estimate}" if right else heights)
    change = exact.get("mesh_change_percent")
    if exact.mesh_error_percent is None and change is not None and change > distance:
        lines.append(
            f"the mesh error of the exact model is unknown: its shape is {change:.1f} % away from that on the next "
            f"coarser mesh, more than the distance ({distance:.1f} %)"
        )
    return lines


def _exact_shape(exact: ExactRecord, known: Sequence[str]) -> Iterator[str]:
    """The warnings of the exact shape that the preview's warnings do not contain, and the stars that bump down."""
    down, off = exact.stars_down, exact.stars_off_branch
    if down:
        bump = "bumps" if len(down) == 1 else "bump"
        yield f"{len(down)} of {exact.stars_total} stars of the exact shape {bump} down: {star_numbers(down)}"
    # stars that are off because they are down have been named
    named = set() if set(off) - set(down) else {*off_branch(exact)}
    yield from (f"the exact model: {line}" for line in exact.get("warnings", []) if line not in {*known, *named})


def two_minima_warnings(exact: Mapping[str, Shape], result: str, apart_percent: float) -> Iterator[str]:
    """Two exact minima, `apart_percent` of the diameter apart, whose energies are so close that either may be lower."""
    for other in (shape.summary for name, shape in exact.items() if name != result):
        more = gap(exact[result].summary, other)
        # another mesh may exchange the order of two minima whose energies differ by 0.5 % of the elastic energy
        if other["is_minimum"] and apart_percent > MAX_FORM_DISTANCE_PERCENT and more <= 0.005:
            yield (
                f"the exact model has two minima, {apart_percent:.1f} % of the diameter apart, whose energies "
                f"differ by {small_percent(100.0 * more)}: a print may rest in either"
            )


def same_energy(one: float, other: float) -> bool:
    """Whether the energies (N mm) of two minima are equal up to the accuracy of the solver.

    Examples
    --------
    >>> same_energy(1808.98, 1808.9801), same_energy(1808.98, 1809.98)
    (True, False)
    """
    # two minima are equal if their energies differ by at most this part
    return abs(one - other) <= 1e-6 * abs(one)


def gap(one: Mapping[str, Any], other: Mapping[str, Any]) -> float:
    """Difference of the energies of two summaries over the elastic energy of the first: gravity has any zero."""
    elastic = one["energy_n_mm"] - one.get("gravity", 0.0)
    return float(abs(other["energy_n_mm"] - one["energy_n_mm"]) / elastic) if elastic else math.inf


def right_shape(exact: Mapping[str, Shape]) -> str:
    """The name of the certified shape; among several, the one of lowest energy, and among equal energies the first.

    A shape whose stars are all on the side that the design asks for comes before shapes with stars on the other side.
    """

    def rank(name: str) -> tuple[bool, bool]:
        return not exact[name].summary["is_minimum"], bool(exact[name].summary["stars_off_branch"])

    def energy(name: str) -> float:
        return float(exact[name].summary["energy_n_mm"])

    best = [name for name in exact if rank(name) == min(map(rank, exact))]
    lowest = min(map(energy, best))
    return next(name for name in best if same_energy(lowest, energy(name)))


def same_minimum(
    first: Shape,
    second: Shape,
    plan: Layout,
    symmetries: Sequence[Symmetry],
    gravity: Sequence[float] | None = None,
    mean: CellMean | None = None,
) -> tuple[bool, Comparison]:
    """Whether both are certified and are one minimum, and the second laid on the first as held.

    They are one minimum if their surfaces are nearer than `SAME_FORM_PERCENT` and the same stars are inverted. An image
    of a minimum may have another energy, as the mesh may be less symmetric than the design. Parameters are those of
    `asterism.shape.comparison.compare_shapes`.
    """
    between = compare_shapes(first, second, plan, symmetries, gravity, mean)
    certain = bool(first.summary["is_minimum"] and second.summary["is_minimum"])
    agree = certain and between.rms_percent < SAME_FORM_PERCENT and _same_stars_down(first, second, plan, symmetries)
    if agree and not same_energy(first.summary["energy_n_mm"], second.summary["energy_n_mm"]):
        as_it_is = compare_shapes(first, second, plan, symmetries[:1], gravity, between.mean)
        agree = as_it_is.rms_percent >= SAME_FORM_PERCENT
    return agree, between


def _same_stars_down(first: Shape, second: Shape, plan: Layout, symmetries: Sequence[Symmetry]) -> bool:
    """Whether two shapes have the same inverted stars, up to a symmetry; the cell means do not show these."""
    down = [np.isin(plan.star_number, shape.summary["stars_down"]) for shape in (first, second)]
    return any(np.array_equal(down[0], down[1][symmetry.star]) for symmetry in symmetries)


# two shapes have different forms if one of these limits is exceeded: the rms distance, in % of the diameter
MAX_LIKE_DISTANCE_PERCENT = 10.0
# the angle between their roll axes
MAX_LIKE_AXIS_DEG = 20.0
# the rms angle between their normals. In 236 previews it is below 22 deg, or the form is another one
MAX_LIKE_NORMALS_DEG = 30.0
# two exact minima have the same form if their rms distance, in % of the diameter, is below this
MAX_FORM_DISTANCE_PERCENT = 2.5


def alike(found: DifferenceRecord) -> bool:
    """Whether two shapes have the same form: small distance, similar normals, and the same roll axis if rolled.

    The normals distinguish a pleated sheet from a smooth one, which may be near to it.
    """
    one, other = found.roll_axes_deg
    is_far = found.rms_percent > MAX_LIKE_DISTANCE_PERCENT or found.normals_rms_deg > MAX_LIKE_NORMALS_DEG
    if is_far or one is None or other is None:
        return not is_far and one is other
    apart = abs(one - other) % 180.0
    return min(apart, 180.0 - apart) < MAX_LIKE_AXIS_DEG


def same_branch(found: DifferenceRecord, with_other: DifferenceRecord | None, apart_percent: float = 0.0) -> bool:
    """Whether a shape has the form of the exact result, and not that of another exact minimum.

    The minima are `apart_percent` of the diameter apart; without a second one, `with_other` is None.
    """
    nearer = with_other is None or found.rms_percent <= with_other.rms_percent
    return bool((nearer or apart_percent < MAX_FORM_DISTANCE_PERCENT) and alike(found))
