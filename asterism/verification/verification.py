"""The result of a verification: the shapes of both models, their comparison, and reasons to read it with care."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from asterism.exact.simulation import off_branch
from asterism.pattern.design.design import Design
from asterism.results.records.exact import ExactRecord
from asterism.results.records.verification import VerificationRecord
from asterism.results.words import small_percent, star_numbers
from asterism.shape.comparison import Comparison
from asterism.shape.shape import Shape
from asterism.verification.minima import MAX_FORM_DISTANCE_PERCENT, MIN_CERTAIN_GAP, gap, right_shape

RELEASE = "release"  # name of the exact shape that is released from the flat print
PREVIEW = "preview"  # name of the exact shape that is started from the preview


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
        """Name of the exact shape that counts, see `asterism.verification.minima`."""
        return right_shape(self.exact)

    @property
    def comparison(self) -> Comparison:
        """The preview laid on the exact shape that counts."""
        return self.comparisons[self.result]


# largest ratio of an error and its estimate by the preview without a warning
MAX_ERROR_RATIO = 2.0
# heights that differ by less than this part of the diameter count as equal: both sheets are nearly flat
FLAT_HEIGHT_FACTOR = 1e-3


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
    if expected is not None and distance > MAX_ERROR_RATIO * expected:
        estimate = f"the estimated error of the preview ({expected:.1f} %)"
        lines.append(f"the distance ({distance:.1f} %) is more than twice {estimate}")
    (right, shown), expected = comparison.record.heights_mm, preview.get("expected_height_percent")
    # largest difference of the heights, in % of the exact height, without a warning if the preview has no estimate
    limit = 10.0 if expected is None else MAX_ERROR_RATIO * expected
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
        if other["is_minimum"] and apart_percent > MAX_FORM_DISTANCE_PERCENT and more <= MIN_CERTAIN_GAP:
            yield (
                f"the exact model has two minima, {apart_percent:.1f} % of the diameter apart, whose energies "
                f"differ by {small_percent(100.0 * more)}: a print may rest in either"
            )
