"""Warnings of a preview that any kind of pattern may have: supports, side, form and shape; one line each."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from asterism.fem.search.mean_fields import side_of
from asterism.previews.search.alternatives import MIN_SIZE_RATIO
from asterism.previews.solve import EDIT_START
from asterism.previews.state import AnyPreviewState
from asterism.previews.uncertainty.error_estimate import ErrorEstimate
from asterism.shape.pin_warnings import pin_warnings
from asterism.shape.self_intersections import passing

# the softest mode is neutral if the next one is this many times stiffer
MIN_NEUTRAL_RATIO = 5.0
# a supported sheet is flat because of its pins if its size over its natural size is above MAX_SIZE_RATIO, and its
# height over its diameter is below MIN_HEIGHT_RATIO
MAX_SIZE_RATIO = 1.1
MIN_HEIGHT_RATIO = 0.03
# % of the diameter: a larger estimated error is a warning
FAR_PERCENT = 2.5
# why an error is large, by the largest contribution (`asterism.previews.uncertainty.distance_error`)
CAUSES = {
    "soft": "the sheet is soft, so that small errors of the energy move it far",
    "stiffness": "the shape depends on the balance of several stiffnesses",
    "narrow": "the supports hold the sheet narrower than its natural size, so that it may buckle into another form",
    "form": "the exact model may take another form",
}


def support_warnings(state: AnyPreviewState, estimate: ErrorEstimate, height_mm: float) -> Iterator[str]:
    """Pins that fix too little, or stretch the sheet flat."""
    layout, ratio = state.layout, estimate.sources.size_ratio
    yield from pin_warnings(layout, state.design.gravity.on)
    if MAX_SIZE_RATIO < ratio < np.inf and height_mm / estimate.sources.diameter_mm < MIN_HEIGHT_RATIO:
        scale = layout.common_pin_scale
        advice = "" if scale is None else f"; use a scale of about {scale / ratio:.2g} to let it rise"
        yield f"the pins stretch the sheet to {ratio:.2f} times its natural size, so that it is nearly flat{advice}"


def side_warnings(state: AnyPreviewState) -> Iterator[str]:
    """A requested side that was not reached."""
    side = side_of(state.shell, state.equilibrium.x) if state.side != "auto" else "auto"
    if side not in ("auto", state.side):
        yield f"the edges go {side}: the preview reached no equilibrium with edges {state.side}, as requested"


def form_warnings(state: AnyPreviewState, estimate: ErrorEstimate) -> Iterator[str]:
    """Other forms that the sheet may have, and results that are not a stable equilibrium."""
    shown, far = state.equilibrium, estimate.distance_percent
    if shown.guess == EDIT_START and (not state.is_supported or estimate.sources.size_ratio < MIN_SIZE_RATIO):
        yield "the edit kept the form of the sheet before it; start a new preview to search for forms of lower energy"
    if not shown.converged:
        yield f"not an equilibrium: gradient {shown.gradient_norm:.1e} N is above {shown.tolerance:.1e} N"
    elif not shown.definite:
        yield "an unstable equilibrium: a real sheet leaves this shape; start a new preview to search for a minimum"
    if far is not None and far > FAR_PERCENT:
        cause = CAUSES[estimate.main_part]
        yield f"the exact shape may be {far:.1f} % of the diameter away: {cause}; check with the exact model"
    elif far is None and estimate.sources.size_ratio < MIN_SIZE_RATIO:
        yield f"{CAUSES['narrow']}; check with the exact model"
    if (other := estimate.close_form) is not None:
        energy = f"nearly the same energy ({100.0 * other.gap:+.1f} %); the exact model may take that form"
        if other.gap < -estimate.energy_uncertainty:
            energy = f"{-100.0 * other.gap:.0f} % less energy; the exact model will probably take that form"
        yield f"another form, {other.distance_percent:.0f} % of the diameter away (rms), has {energy}"


def shape_warnings(state: AnyPreviewState, axis_deg: float | None, crossings: int) -> Iterator[str]:
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
