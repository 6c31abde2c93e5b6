"""Sensitivities of a preview: the change of its equilibrium for a small change of each star.

The fields of the sheet are differences of fields with changed stars. Stars that are `COLOUR_STEPS` lattice steps
apart share no place, so that they are changed together: 16 evaluations of the fields are enough, whatever the number
of stars. The change of the stress at a place belongs to the nearest of the changed stars.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.fem.search.linear_response import stress_responses, stress_under
from asterism.pattern.design.rounding import rounded
from asterism.pattern.design.stars import SIZE_KEYS, SizeName
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import size_rows, stars_apart, with_painted_stars
from asterism.previews.fields.star_values import StarValues, star_values
from asterism.previews.solve import PreviewState

# lattice steps between stars that are changed together
COLOUR_STEPS = 4


def star_sensitivity(state: PreviewState, size: SizeName) -> Floats:
    """(N, 3, S) change of the shell's degrees of freedom per mm of one size of each star, to first order.

    Sizes at the upper end of the law's range are changed downwards.

    Raises LawError, DesignError: a changed star is not admissible.
    Raises ValueError: the state shows no equilibrium.
    """
    if state.response is not None:
        raise ValueError("sensitivities belong to an equilibrium, not to a linear response")
    state = state.with_resting_factor()
    shell, x = state.shell, state.resting.x
    changed, steps = _changed_values(state, size)
    before = shell.density(shell.strains(x))[1]
    points = shell.points.reshape(-1, 2)
    changes: list[Floats] = []
    order: list[int] = []
    for stars in stars_apart(state.layout, COLOUR_STEPS):
        fields = state.sheet.fields(_mixed(state.sheet.values, changed, stars))
        difference = stress_under(shell, x, fields) - before
        owner = cKDTree(state.layout.centres[stars]).query(points)[1].reshape(difference.shape[:2])
        for number, star in enumerate(stars):
            changes.append(np.where((owner == number)[..., None], difference, 0.0) / steps[star])
            order.append(int(star))
    responses = stress_responses(shell, x, state.factor, changes)
    result = np.empty_like(responses)
    result[..., order] = responses
    return result


def _changed_values(state: PreviewState, size: SizeName) -> tuple[StarValues, Floats]:
    """The law at the stars with one size of all of them changed, and these changes (S,) in mm.

    Lengths are changed with the rounding of the design in place, thicknesses and widths from their rounded values.
    """
    plan, design = state.layout, state.design
    stars, known = design.required_stars, dict(zip(SIZE_KEYS, plan.star_sizes_mm.T, strict=True))
    kept: dict[SizeName, Floats] = {}
    if stars.rounding is not None and stars.rounding.rounds(size):
        kept = {key: rounded(stars.rounding, key, values) for key, values in known.items()}
        stars = stars.model_copy(update={"rounding": None})
    before = (kept or known)[size]
    steps = size_steps(state, size, before)
    sizes = size_rows({**kept, size: before + steps})
    changed = with_painted_stars(design.model_copy(update={"stars": stars}), plan.sites, sizes)
    return star_values(changed, layout(changed), state.sheet.law, state.sheet.model), steps


def size_steps(state: PreviewState, size: SizeName, sizes: Floats) -> Floats:
    """(S,) mm, changes of one size of stars (S,) mm for differences; at the upper end of the law's range downwards."""
    steps = np.full(len(sizes), 0.005) if size == "length_mm" else 5e-4 * sizes
    top = state.sheet.law.size_ranges(state.design.fabric.stretch_xy)[size][1]
    return np.where(sizes + steps > top, -steps, steps)


def _mixed(values: StarValues, changed: StarValues, stars: np.ndarray) -> StarValues:
    """The values that fields depend on, with those of some stars from others."""

    def mix(of_all: Floats, of_some: Floats) -> Floats:
        result = of_all.copy()
        result[stars] = of_some[stars]
        return result

    return replace(
        values,
        value={name: mix(value, changed.value[name]) for name, value in values.value.items()},
        sizes=mix(values.sizes, changed.sizes),
        anisotropy=mix(values.anisotropy, changed.anisotropy),
    )
