"""`asterism.sensitivity`: what each star does to the shape."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats, Ints
from asterism.homogenize.law.axes import AXES
from asterism.homogenize.law.law import Law
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.layout.painted_stars import SIZE_KEYS, with_painted_stars
from asterism.previews.session import Preview
from asterism.previews.star_sensitivity import SIZE_STEPS, SizeName
from asterism.shape.shape import Shape


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """Derivatives of a quantity by one size of each star.

    Attributes
    ----------
    value : (...) the quantity.
    derivatives : (S, ...) its change per mm by which the size of each star grows. Where the quantity has a kink, as the
        height of a symmetric sheet with several highest places, it may change differently when the size shrinks.
    stars : (S,) numbers of the stars.
    centres : (S, 2) mm, their places on the print.
    """

    value: Floats
    derivatives: Floats
    stars: Ints
    centres: Floats


def sensitivity(
    design: Design,
    of: Literal["height_mm"] | Callable[[Shape], ArrayLike] = "height_mm",
    by: SizeName = "length_mm",
    law: Law | None = None,
) -> Sensitivity:
    """Compute how a quantity of the preview changes with one size of each star.

    The sheet follows a small change of one star after the other by its linear response, with the bumps of the stars.
    Thicknesses and widths are those before a rounding of the design.

    Parameters
    ----------
    design : with stars; from `load_design`, `new` or `Design.from_dict`.
    of : `height_mm`, or a function of a `Shape` that gives a number or an array. The function may use all of the shape
        but its summary and its fields.
    by : `length_mm`, `thickness_mm` or `width_mm`. A size at the upper end of the law's range is changed downwards.
    law : as for `Preview`.

    Raises
    ------
    DesignError, MeshError, LawError
        As for `Preview`.
    ValueError
        `of` or `by` is not one of these, or the search finds no minimum.

    Examples
    --------
    >>> from asterism.pattern import gallery
    >>> found = sensitivity(gallery.load("star"), of=lambda shape: shape.at([[0.0, 0.0]])[0])
    >>> found.derivatives.shape
    (1, 3)
    """
    check_type(design, Design, "load_design reads one from a file")
    if not (of == "height_mm" or callable(of)):
        raise ValueError(f"of = {of!r}: must be 'height_mm' or a function of a shape")
    if by not in get_args(SizeName):
        raise ValueError(f"by = {by!r}: must be {' or '.join(get_args(SizeName))}")
    stars = design.required_stars.model_copy(update={"rounding": None})
    design = design.model_copy(update={"stars": stars})
    preview = Preview(design, law)
    if not preview.equilibrium.is_minimum:
        raise ValueError("the search finds no minimum, and only a minimum has derivatives")
    shown, plan, column = preview.shape(), preview.state.layout, SIZE_KEYS.index(by)

    def quantity(x: Any) -> Floats:
        moved = replace(shown, positions=preview.at(shown.printed, x).bumpy)
        moved = moved if moved.held else moved.aligned()
        return np.asarray(moved.height_mm if of == "height_mm" else of(moved), dtype=float)  # type: ignore[operator]

    value, sizes = quantity(None), plan.star_sizes_mm[:, column]
    steps = np.full(len(sizes), SIZE_STEPS[column]) * (1.0 if column == 0 else sizes)
    top = preview.law.size_ranges(design.fabric.stretch_xy)[AXES[column].key][1]
    steps = np.where(sizes + steps > top, -steps, steps)
    changes = []
    for site, size, step in zip(plan.sites, sizes, steps, strict=True):
        row = np.full((1, len(SIZE_KEYS)), np.nan)
        row[0, column] = size + step
        response = next(preview.edit(with_painted_stars(design, site[None], row)))
        changes.append((quantity(response.x) - value) / step)
    return Sensitivity(value, np.array(changes), plan.star_number, plan.centres)
