"""Whether two exact shapes of a design are one minimum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from asterism.discrete.release.forms import SAME_FORM_PERCENT
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import Symmetry
from asterism.shape.cell_mean import CellMean
from asterism.shape.comparison import Comparison, compare_shapes
from asterism.shape.shape import Shape
from asterism.verification.right_shape import same_energy


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
    of a minimum may have another energy, as the mesh may be less symmetric than the design.

    Parameters
    ----------
    first, second : exact shapes of one design.
    plan, symmetries, gravity, mean : as in `asterism.shape.comparison.compare_shapes`.
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
