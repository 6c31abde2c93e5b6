"""What a reader of a verification should know before trusting its numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from asterism.exact.star_sides import off_branch
from asterism.exact.warnings import passes_through
from asterism.results.words import small_percent, star_numbers
from asterism.shape.comparison import Comparison
from asterism.verification.numbers import FORM_PERCENT
from asterism.verification.right_shape import SURE, gap
from asterism.verification.verification import Verification

ALIKE = 1.3  # largest ratio of two edge lengths that count as one
SURPRISE = 2.0  # times the error that the preview expected
HEIGHTS_PERCENT = 10.0  # by which heights may differ where it expected none
FLAT_HEIGHT_FACTOR = 1e-3  # part of the diameter: heights that differ by less are those of flat sheets


def verification_warnings(found: Verification, apart_percent: float) -> list[str]:
    """One line each; `apart_percent` of the diameter, distance of the two exact shapes."""
    preview, exact = found.preview.summary, found.exact[found.result].summary
    own = [*map(str, preview.get("warnings", []))]
    own += _exact_shape(exact, own)
    if not exact["is_minimum"]:  # nothing to hold the preview against
        return own
    return [
        *own,
        *_two_minima(found, apart_percent),
        *_far(found.comparison, preview.get("expected_rms_percent")),
        *_high(found.comparison, preview.get("expected_height_percent")),
        *_meshes(exact, preview.get("law", {}).get("edge_mm"), found.comparison.rms_percent),
    ]


def _exact_shape(exact: Mapping[str, Any], known: Sequence[str]) -> Iterator[str]:
    """What the exact model said of its shape, and was not said in other words or before."""
    if not exact["is_minimum"]:
        yield "the exact shape is not certified to be a minimum"
    yield from passes_through(exact, "the exact sheet")
    down, off, total = exact["stars_down"], exact["stars_off_branch"], exact["stars_total"]
    if down:
        yield f"{len(down)} of {total} stars of the exact shape bump down: {star_numbers(down)}"
    named = list(off_branch(exact))
    if set(off) - set(down):  # sent down, and up again
        yield from named
    said = {*known, *named, *passes_through(exact)}
    yield from (f"the exact model: {line}" for line in exact.get("warnings", []) if line not in said)


def _two_minima(found: Verification, apart: float) -> Iterator[str]:
    """Two exact shapes of which the model cannot tell the lower one."""
    exact = found.exact[found.result].summary
    for other in (shape.summary for name, shape in found.exact.items() if name != found.result):
        more = gap(exact, other)
        if other["is_minimum"] and apart > FORM_PERCENT and more <= SURE:
            yield (
                f"the exact model has two minima, {apart:.1f} % of the diameter apart, whose energies differ by "
                f"{small_percent(100.0 * more)}: a print may rest in either"
            )


def _far(comparison: Comparison, expected: float | None) -> Iterator[str]:
    """What "the same form" does not say."""
    distance = comparison.rms_percent
    if expected is not None and distance > SURPRISE * expected:
        yield f"the distance ({distance:.1f} %) is more than twice what the preview expected ({expected:.1f} %)"


def _high(comparison: Comparison, expected: float | None) -> Iterator[str]:
    """Heights that differ by more than the preview had said."""
    exact, preview = comparison.heights_mm
    off, most = 100.0 * abs(preview - exact), HEIGHTS_PERCENT if expected is None else SURPRISE * expected
    if off > 100.0 * FLAT_HEIGHT_FACTOR * comparison.diameter_mm and off > most * exact:
        heights = f"the preview is {preview:.1f} mm high, the exact shape {exact:.1f} mm"
        told = "" if expected is None else f", more than twice what it expected ({expected:.1f} %)"
        yield f"{heights}: {off / exact:.0f} % off{told}" if exact else heights


def _meshes(exact: Mapping[str, Any], of_law: float | None, distance: float) -> Iterator[str]:
    edge = exact["edge_mm"]
    if of_law is not None and not 1.0 / ALIKE < of_law / edge < ALIKE:
        # who asked for a finer mesh than the law's has a reason
        alike = f"; mesh.edge_mm = {of_law:g} (--edge {of_law:g}) makes them alike" if edge > of_law else ""
        coarser = "exact model's" if edge > of_law else "law's"
        yield (
            f"the law was made with edges of {of_law:g} mm, the exact model's are {edge:g} mm: part of the distance is "
            f"the error of the {coarser} coarser mesh{alike}"
        )
    error, change = exact["mesh_error_percent"], exact.get("mesh_change_percent")
    if error is not None and error > distance:
        yield f"the exact model's own mesh error ({error:.1f} %) is larger than the distance ({distance:.1f} %)"
    elif error is None and change is not None and change > distance:
        yield (
            f"the exact model's own mesh error is not known: its shape is {change:.1f} % from that of the next coarser "
            f"mesh, more than the distance ({distance:.1f} %)"
        )
