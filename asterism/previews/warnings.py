"""What a reader should know before trusting a preview: one line for each reason."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from asterism.laws.directions_warning import directions_warning
from asterism.laws.law_warnings import held_out_warning, mesh_warning, pleat_warning
from asterism.previews.search.alternatives import MIN_SIZE_RATIO
from asterism.previews.solve import EDIT_START
from asterism.previews.state import PreviewState
from asterism.previews.uncertainty.estimate import ErrorEstimate
from asterism.results.words import star_numbers
from asterism.shape.pin_warnings import pin_warnings
from asterism.shape.self_intersections import passing
from fem.search.sides import side_of

MIN_NEUTRAL_RATIO = 5.0  # the softest mode is neutral if the next one is this many times stiffer
# supported size over natural size, and height over diameter: a sheet that is wider and flatter lacks length for a rise
MAX_SIZE_RATIO = 1.1
MIN_HEIGHT_RATIO = 0.03
MAX_BUCKLED_GAP = 0.5  # share of the energy at stake by which a buckled form may be above another and be the right one


def warnings(
    state: PreviewState,
    estimate: ErrorEstimate,
    axis_deg: float | None,
    crossings: int,
    height_mm: float,
) -> list[str]:
    """The lines, in the order of their causes: stars, law, supports, equilibrium, other forms, the shape itself.

    Parameters
    ----------
    axis_deg : of a rolled sheet, on the print; None for other shapes.
    crossings : pairs of triangles that pass through each other.
    """
    return [
        *_about_stars(state),
        *_about_supports(state, estimate, height_mm),
        *_about_the_form(state, estimate),
        *_about_the_shape(state, axis_deg, crossings),
    ]


def _about_stars(state: PreviewState) -> Iterator[str]:
    """Stars that the law does not describe, and what the law says of itself."""
    values, count = state.values, len(state.layout.centres)
    if len(values.outside) > 1:
        yield f"{len(values.outside)} of {count} stars are outside the law, such as {values.outside[0]}"
    else:
        yield from values.outside
    for line in (directions_warning, held_out_warning, mesh_warning, pleat_warning):
        if text := line(state.law):
            yield text
    if values.tight and not state.is_supported:  # supported sheets are as accurate with them
        yield (
            f"{len(values.tight)} of {count} stars curl to a radius below two thirds of their spacing, "
            f"where a smooth sheet says little: {star_numbers(values.tight)}"
        )
    if values.uneven:
        yield (
            f"{len(values.uneven)} of {count} stars curl far more in some directions than in others, of "
            f"which the law knows little: {star_numbers(values.uneven)}"
        )


def _about_supports(state: PreviewState, estimate: ErrorEstimate, height_mm: float) -> Iterator[str]:
    """Supports that leave or take too much, and sides that the sheet does not have."""
    layout, ratio = state.layout, estimate.size_ratio
    yield from pin_warnings(layout, state.design.gravity.on)
    if MAX_SIZE_RATIO < ratio < np.inf and height_mm / estimate.diameter_mm < MIN_HEIGHT_RATIO:
        scale = layout.common_pin_scale
        narrower = "" if scale is None else f": a scale of about {scale / ratio:.2g} lets it rise"
        yield f"the pins hold the sheet {ratio:.2f} times as wide as its stars want it, nearly flat{narrower}"
    if inverted := layout.star_number[layout.star_branch < 0].tolist():
        yield f"the law's stars bump up, but {len(inverted)} of the design start down: {star_numbers(inverted)}"
    side = side_of(state.shell, state.equilibrium.x) if state.side != "auto" else "auto"
    if side not in ("auto", state.side):
        yield f"the edges were asked to go {state.side}, but no such form was reached: they go {side}"


def _about_the_form(state: PreviewState, estimate: ErrorEstimate) -> Iterator[str]:
    """Other forms that the sheet may have, and equilibria that are none."""
    shown, two_modes = state.equilibrium, estimate.has_two_near_zero_modes
    is_edit = shown.guess == EDIT_START
    if estimate.size_ratio < MIN_SIZE_RATIO and not two_modes:
        buckles = "held narrower than it would be, the sheet may buckle in several ways"
        if is_edit:
            yield f"{buckles}: a new preview looks for lower ones"
        elif estimate.buckling == 1.0 or any(form.gap < MAX_BUCKLED_GAP for form in estimate.other_forms):
            yield f"{buckles}, and the law cannot tell which is lowest: the exact model may take another form"
    elif is_edit and not state.is_supported:
        yield "the edit went on from the form before it: a new preview looks for lower ones"
    if not shown.converged:
        yield f"not an equilibrium: gradient {shown.gradient_norm:.1e} N, above {shown.tolerance:.1e} N"
    elif not shown.definite:
        yield "an equilibrium that is not stable"
    if two_modes:
        yield "soft in more than one way: the sheet may rest in another form"
    if (other := estimate.close_form) is not None:
        energy = f"nearly the same energy ({100.0 * other.gap:+.1f} %): the exact model may take that one"
        if other.gap < -estimate.energy_uncertainty:
            energy = f"{-100.0 * other.gap:.0f} % less energy: the exact model will likely take that one"
        yield f"another form, {other.distance_percent:.0f} % of the diameter away, has {energy}"


def _about_the_shape(state: PreviewState, axis_deg: float | None, crossings: int) -> Iterator[str]:
    """Crossings, and rolls whose axis is nearly neutral."""
    if crossings:
        yield f"{passing(crossings)}; the exact model can keep it apart (solver.contact, --contact)"
    stiffness = state.equilibrium.soft_modes
    if axis_deg is not None and len(stiffness) > 1 and stiffness[1] > MIN_NEUTRAL_RATIO * stiffness[0]:
        softer = f"one motion is {stiffness[1] / stiffness[0]:.0f} times softer than all others"
        even = f"an even sheet hardly prefers the axis about which it rolls ({axis_deg:.0f} deg)"
        yield f"{softer}: {'small changes move it far' if state.is_supported else even}"
