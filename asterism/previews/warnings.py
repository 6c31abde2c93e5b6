"""Warnings of a preview: one line each, with the star or the place, and what the user can do.

**Overstretched stars.** Around them a preview is longer than its fabric can be, so that it is no shape of the sheet. A
cell of the released sheet can return to its printed lengths. So its fabric stores no more energy than in print, apart
from the bending of its arms, which is small beside it. Let q be the mean of `tr(F^T F)/2` over a cell, with the
gradient F from print, and s the stretch in print. The energy of the neo-Hookean fabric (`discrete.energies.membrane`)
per rest area is at least

    W(y) = mu (y - 1 - ln y) + lam/2 (ln y)^2    for    ln y < mu/lam,    mu (y - 1) - mu^2/(2 lam)    beyond,

at `tr C = 2 y`: the least over J, which is J = y as far as `ln y < mu/lam`. W is convex and grows for y above 1. By
Jensen's inequality, q is at most y/s^2 with W(y) equal to the energy in print. That is 1 up to `ln s^2 = mu/lam`, and a
little more for fabric that is stretched further. The incompressible fabric has the limit 1 at every stretch.

Supports at other distances than in print change the bound. If p > 1 is the largest ratio of the distances of two
supported points in space and in print, some shape meets the supports and has no length above p times the printed one
(Kirszbraun 1934). It takes the place of the print. Within a spacing of the supports there is no bound: fabric that is
pulled at points stretches further. Weight is not bounded in this way either.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.distance import pdist

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.search.mean_fields import mean_fields, side_of
from asterism.fem.search.relax import is_collapsing
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.geometry.planar import triangle_areas
from asterism.pattern.layout.layout import Layout
from asterism.previews.search_minima import MIN_SIZE_RATIO
from asterism.previews.solve import EDIT_START, PreviewState
from asterism.results.words import PlacedWarning, passing, star_numbers
from asterism.shape.design_warnings import pin_warnings
from asterism.shape.shape import Shape
from asterism.shape.surface_fields import deformation_gradients

# supported points that are closer together in print, in spacings, are one point
MIN_SUPPORT_DISTANCE = 1e-3


def overstretched_stars(shape: Shape, design: Design, layout: Layout) -> Ints:
    """Numbers of the stars around which a shape is longer than its fabric can be; none if the sheet has weight."""
    if design.gravity.on or not layout.has_stars:
        return np.empty(0, dtype=np.int64)
    far = np.ones(len(layout.centres), dtype=bool)
    if shape.held:
        far = layout.distance_to_supports(layout.centres) > layout.spacing_mm
    over = mean_square_stretch(shape, layout) > mean_square_limit(design.fabric, support_ratio(layout))
    return np.asarray(layout.star_number[over & far])


def mean_square_limit(fabric: Fabric, ratio: float = 0.0) -> float:
    """Upper bound of the mean square stretch from print.

    Parameters
    ----------
    ratio : of the distances of supports in space and in print.

    Examples
    --------
    >>> mean_square_limit(Fabric()), mean_square_limit(Fabric(), ratio=1.2)
    (1.0, 1.44)
    """
    pull = max(1.0, ratio) ** 2
    square = pull * float(np.prod(fabric.stretch_xy))
    bend = 0.5 * (1.0 - fabric.poisson) / fabric.poisson if fabric.poisson else np.inf  # mu/lam
    if fabric.model != "neo-hookean" or np.log(square) <= bend:
        return pull
    energy = square - 1.0 - np.log(square) + 0.5 * np.log(square) ** 2 / bend
    return float(pull * (1.0 + 0.5 * bend + energy) / square)


def mean_square_stretch(shape: Shape, layout: Layout) -> Floats:
    """(S,) mean of `tr(F^T F)/2` over the printed area that is nearest to each star, F from print."""
    gradients = deformation_gradients(shape.printed, shape.positions, shape.triangles)
    area = triangle_areas(shape.printed, shape.triangles)
    star = cKDTree(layout.centres).query(shape.printed[shape.triangles].mean(axis=1))[1]
    square = 0.5 * np.einsum("tca,tca->t", gradients, gradients)
    count = len(layout.centres)
    # a star without a triangle of its own has nothing to stretch
    return np.asarray(np.bincount(star, area * square, count) / np.maximum(np.bincount(star, area, count), 1e-300))


def support_ratio(layout: Layout) -> float:
    """The largest distance of two supported points in space over their distance in print; 0 with fewer than two."""
    printed, places, _ = layout.support_samples
    held = ~np.isnan(places[:, :2]).any(axis=1)
    if held.sum() < 2:
        return 0.0
    in_print, in_space = pdist(printed[held]), pdist(np.nan_to_num(places[held]))
    apart = in_print > MIN_SUPPORT_DISTANCE * layout.spacing_mm
    return float((in_space[apart] / in_print[apart]).max(initial=0.0))


def preview_warnings(
    state: PreviewState, shape: Shape, crossings: int, overstretched: Sequence[int] = ()
) -> Iterator[str]:
    """The warnings, in the order of their causes: pattern, supports, equilibrium, shape.

    Parameters
    ----------
    crossings : number of pairs of triangles of the shape that pass through each other.
    overstretched : numbers of the stars around which the shape is longer than its fabric can be.
    """
    collapses = not state.layout.has_stars and is_collapsing(state.shell, state.equilibrium)
    if collapses:
        yield (
            "not an equilibrium: at wide rims the tension of the fabric bends the preview more than its rods resist; "
            "make the rods thicker or wider, or use the exact model: asterism simulate"
        )
    yield from state.sheet.doubts()
    yield from _about_supports(state, shape)
    if not collapses:
        yield from _about_equilibrium(state)
    if crossings:
        yield f"{passing(crossings)}; the exact model can prevent that (solver.contact, --contact)"
    if overstretched:
        yield PlacedWarning(
            f"not a shape of this sheet: around {len(overstretched)} of {len(state.layout.centres)} stars it is longer "
            f"than the fabric can stretch; use the exact model: {star_numbers(overstretched)}",
            overstretched,
        )


# a supported sheet is flat because of its pins if its size over its natural size is above MAX_SIZE_RATIO, and its
# height over its diameter is below MIN_HEIGHT_RATIO
MAX_SIZE_RATIO = 1.1
MIN_HEIGHT_RATIO = 0.03


def size_ratio(state: PreviewState) -> float:
    """Size that the supports allow over the natural size; inf for a sheet that they do not hold along the print."""
    if not state.is_supported:
        return np.inf
    means = mean_fields(state.shell)
    return means.chord / means.stretch


def _about_supports(state: PreviewState, shape: Shape) -> Iterator[str]:
    """Pins that fix too little or stretch the sheet flat, inverted stars, and a requested side that was not reached."""
    layout, ratio = state.layout, size_ratio(state)
    yield from pin_warnings(layout, state.design.gravity.on)
    if MAX_SIZE_RATIO < ratio < np.inf and shape.height_mm / diameter(shape.positions) < MIN_HEIGHT_RATIO:
        scale = layout.common_pin_scale
        advice = "" if scale is None else f"; use a scale of about {scale / ratio:.2g} to let it rise"
        yield f"the pins stretch the sheet to {ratio:.2f} times its natural size, so that it is nearly flat{advice}"
    if inverted := layout.star_number[layout.star_branch < 0].tolist():
        yield PlacedWarning(
            f"{len(inverted)} stars of the design are inverted (branch down), but the law describes bumps up; "
            f"check with the exact model: {star_numbers(inverted)}",
            inverted,
        )
    side = side_of(state.shell, state.equilibrium.x) if state.side != "auto" else "auto"
    if side not in ("auto", state.side):
        yield f"the edges go {side}: the preview reached no equilibrium with edges {state.side}, as requested"


def _about_equilibrium(state: PreviewState) -> Iterator[str]:
    """A form that an edit kept, and results that are not a stable equilibrium."""
    shown = state.equilibrium
    if shown.guess == EDIT_START and (not state.is_supported or size_ratio(state) < MIN_SIZE_RATIO):
        yield "the edit kept the form of the sheet before it; start a new preview to search for forms of lower energy"
    if not shown.converged:
        yield f"not an equilibrium: gradient {shown.gradient_norm:.1e} N is above {shown.tolerance:.1e} N"
    elif not shown.definite:
        yield "an unstable equilibrium: a real sheet leaves this shape; start a new preview to search for a minimum"
