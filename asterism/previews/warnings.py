"""Warnings of a preview: one line each, with the star or the place, and what the user can do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from asterism.previews.directions_warning import directions_warning
from asterism.previews.inverted_stars import stars_that_may_be_inverted
from asterism.previews.law_warnings import held_out_warning, mesh_warning, pleat_warning, symmetry_warning
from asterism.previews.search.alternatives import MIN_SIZE_RATIO
from asterism.previews.solve import EDIT_START
from asterism.previews.state import StarState
from asterism.previews.uncertainty.estimate import ErrorEstimate
from asterism.results.placed_warning import PlacedWarning
from asterism.results.words import star_numbers
from asterism.shape.pin_warnings import pin_warnings
from asterism.shape.self_intersections import passing
from asterism.shape.site_warnings import site_warnings
from asterism.shape.sizing_warnings import sizing_warnings
from fem.search.sides import side_of

# the softest mode is neutral if the next one is this many times stiffer
MIN_NEUTRAL_RATIO = 5.0
# a supported sheet is flat because of its pins if its size over its natural size is above MAX_SIZE_RATIO, and its
# height over its diameter is below MIN_HEIGHT_RATIO
MAX_SIZE_RATIO = 1.1
MIN_HEIGHT_RATIO = 0.03
# a buckled form that is higher by less than this share of the energy at stake may be the right one
MAX_BUCKLED_GAP = 0.5


def preview_warnings(
    state: StarState,
    estimate: ErrorEstimate,
    axis_deg: float | None,
    crossings: int,
    height_mm: float,
    overstretched: Sequence[int] = (),
) -> list[str]:
    """The warnings, in the order of their causes: stars, law, supports, equilibrium, other forms, shape.

    Parameters
    ----------
    axis_deg : direction of the axis of a rolled sheet, on the print; None for other shapes.
    crossings : number of pairs of triangles that pass through each other.
    height_mm : height of the shape.
    overstretched : numbers of the stars around which the shape is longer than its fabric can be.
    """
    return [
        *_about_stars(state),
        *_about_supports(state, estimate, height_mm),
        *_about_the_form(state, estimate),
        *_about_the_shape(state, axis_deg, crossings),
        *_about_lengths(overstretched, len(state.layout.centres)),
    ]


def _about_stars(state: StarState) -> Iterator[str]:
    """Stars that the law does not describe, and the law's own errors."""
    values, count = state.values, len(state.layout.centres)
    if len(values.outside) > 1:
        yield PlacedWarning(
            f"{len(values.outside)} of {count} stars are outside the law's range, such as {values.outside[0]}; "
            "the preview takes the nearest star in the range",
            values.outside_stars,
        )
    else:
        yield from (PlacedWarning(line, values.outside_stars) for line in values.outside)
    yield from site_warnings(state.layout)
    yield from sizing_warnings(state.design, state.layout)
    yield from _about_bonds(state)
    if state.law.statement is not None:
        yield state.law.statement
    for line in (directions_warning, held_out_warning, mesh_warning, symmetry_warning, pleat_warning):
        if text := line(state.law):
            yield text
    if values.not_scale_separated and not state.is_supported:  # supported sheets are as accurate with them
        yield PlacedWarning(
            f"{len(values.not_scale_separated)} of {count} stars curl to a radius below two thirds of their spacing, "
            f"too tightly for a smooth sheet; check with the exact model: {star_numbers(values.not_scale_separated)}",
            values.not_scale_separated,
        )
    if values.strongly_anisotropic:
        yield PlacedWarning(
            f"{len(values.strongly_anisotropic)} of {count} stars curl far more in some directions than in others, "
            f"which the law describes poorly; check with the exact model: {star_numbers(values.strongly_anisotropic)}",
            values.strongly_anisotropic,
        )


def _about_bonds(state: StarState) -> Iterator[str]:
    """Arms of different stars that are bonded where they meet, which the cells of the law are not."""
    graph, number = state.layout.graph, state.layout.star_number
    if not graph.joints:
        return
    ends = [end for node in graph.joints for end in graph.ends_at[node]]
    stars = np.unique(number[[graph.rods[end.rod].group for end in ends]]).tolist()
    yield PlacedWarning(
        f"arms of different stars meet in {len(graph.joints)} places and print as one, but the law is of stars that do "
        f"not touch; check with the exact model: {star_numbers(stars)}",
        stars,
    )


def _about_supports(state: StarState, estimate: ErrorEstimate, height_mm: float) -> Iterator[str]:
    """Pins that fix too little or stretch the sheet flat, inverted stars, and a requested side that was not reached."""
    layout, ratio = state.layout, estimate.size_ratio
    yield from pin_warnings(layout, state.design.gravity.on)
    if MAX_SIZE_RATIO < ratio < np.inf and height_mm / estimate.diameter_mm < MIN_HEIGHT_RATIO:
        scale = layout.common_pin_scale
        advice = "" if scale is None else f"; use a scale of about {scale / ratio:.2g} to let it rise"
        yield f"the pins stretch the sheet to {ratio:.2f} times its natural size, so that it is nearly flat{advice}"
    if inverted := layout.star_number[layout.star_branch < 0].tolist():
        yield PlacedWarning(
            f"{len(inverted)} stars of the design are inverted (branch down), but the law describes bumps up; "
            f"check with the exact model: {star_numbers(inverted)}",
            inverted,
        )
    if len(stars := stars_that_may_be_inverted(state)):
        yield PlacedWarning(
            f"the supports hold the sheet so flat that {len(stars)} of {len(layout.centres)} stars may be inverted "
            f"beside others; check with the exact model: {star_numbers(stars.tolist())}",
            stars.tolist(),
        )
    side = side_of(state.shell, state.equilibrium.x) if state.side != "auto" else "auto"
    if side not in ("auto", state.side):
        yield f"the edges go {side}: the preview reached no equilibrium with edges {state.side}, as requested"


def _about_the_form(state: StarState, estimate: ErrorEstimate) -> Iterator[str]:
    """Other forms that the sheet may have, and results that are not a stable equilibrium."""
    shown, two_modes = state.equilibrium, estimate.has_two_near_zero_modes
    is_edit = shown.guess == EDIT_START
    if estimate.size_ratio < MIN_SIZE_RATIO and not two_modes:
        buckles = "the pins hold the sheet narrower than its natural size, so that it may buckle into several forms"
        if is_edit:
            yield f"{buckles}; start a new preview to search for forms of lower energy"
        elif any(form.gap < MAX_BUCKLED_GAP for form in estimate.other_forms):
            yield f"{buckles} of similar energy; the exact model may take another form"
    elif is_edit and not state.is_supported:
        yield "the edit kept the form of the sheet before it; start a new preview to search for forms of lower energy"
    if not shown.converged:
        yield f"not an equilibrium: gradient {shown.gradient_norm:.1e} N is above {shown.tolerance:.1e} N"
    elif not shown.definite:
        yield "an unstable equilibrium: a real sheet leaves this shape; start a new preview to search for a minimum"
    if two_modes:
        yield "two near-zero modes: a small disturbance can take the sheet to another form; check with the exact model"
    if (other := estimate.close_form) is not None:
        energy = f"nearly the same energy ({100.0 * other.gap:+.1f} %); the exact model may take that form"
        if other.gap < -estimate.energy_uncertainty:
            energy = f"{-100.0 * other.gap:.0f} % less energy; the exact model will probably take that form"
        yield f"another form, {other.distance_percent:.0f} % of the diameter away (rms), has {energy}"


def _about_lengths(overstretched: Sequence[int], count: int) -> Iterator[str]:
    """A shape that is longer than its fabric can be."""
    if overstretched:
        yield PlacedWarning(
            f"not a shape of this sheet: around {len(overstretched)} of {count} stars it is longer than the fabric can "
            f"stretch; use the exact model: {star_numbers(overstretched)}",
            overstretched,
        )


def _about_the_shape(state: StarState, axis_deg: float | None, crossings: int) -> Iterator[str]:
    """A sheet that passes through itself, and a roll whose axis is nearly arbitrary."""
    if crossings:
        yield f"{passing(crossings)}; the exact model can prevent that (solver.contact, --contact)"
    stiffness = state.equilibrium.soft_modes
    if axis_deg is not None and len(stiffness) > 1 and stiffness[1] > MIN_NEUTRAL_RATIO * stiffness[0]:
        softer = f"one motion of the sheet is {stiffness[1] / stiffness[0]:.0f} times softer than all others"
        if state.is_supported:
            yield f"{softer}, so that small changes of the design move the sheet far"
        else:
            yield f"{softer}: the axis about which it rolls ({axis_deg:.0f} deg) is nearly arbitrary"
