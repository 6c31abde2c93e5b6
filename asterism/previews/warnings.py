"""Warnings of a preview: one line each, with the star or the place, and what the user can do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from asterism.previews.common_warnings import form_warnings, shape_warnings, side_warnings, support_warnings
from asterism.previews.directions_warning import directions_warning
from asterism.previews.inverted_stars import stars_that_may_be_inverted
from asterism.previews.law_warnings import held_out_warning, mesh_warning, pleat_warning, symmetry_warning
from asterism.previews.state import StarState
from asterism.previews.uncertainty.error_estimate import ErrorEstimate
from asterism.results.placed_warning import PlacedWarning
from asterism.results.words import star_numbers
from asterism.shape.site_warnings import site_warnings
from asterism.shape.sizing_warnings import sizing_warnings


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
        *form_warnings(state, estimate),
        *shape_warnings(state, axis_deg, crossings),
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
    layout = state.layout
    yield from support_warnings(state, estimate, height_mm)
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
    yield from side_warnings(state)


def _about_lengths(overstretched: Sequence[int], count: int) -> Iterator[str]:
    """A shape that is longer than its fabric can be."""
    if overstretched:
        yield PlacedWarning(
            f"not a shape of this sheet: around {len(overstretched)} of {count} stars it is longer than the fabric can "
            f"stretch; use the exact model: {star_numbers(overstretched)}",
            overstretched,
        )
