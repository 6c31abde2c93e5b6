"""Weights of places: where a fit comes nearer to its target, at the cost of other places.

A fit minimises the mean over the print of `w d^2`, with the distance d to the target and the weight w of a place.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats
from asterism.fitting.errors import TargetError, place_text
from asterism.fitting.height_file import PICTURE_FORMATS, picture_levels
from asterism.fitting.target import TargetSurface
from asterism.fitting.target_map import TargetMap
from asterism.pattern.design.design import WEIGHT_RANGE, Design, FitWeights, WeightedSite
from asterism.pattern.design.sizing.expression import ExpressionError, evaluate
from asterism.pattern.design.sizing.grey_image import ImageError
from asterism.pattern.layout.layout import Layout

# weights of black and white of a picture; transparent pixels have that of black
PICTURE_WEIGHTS = (1.0, 10.0)
# decimals of a weight in a design file
WEIGHT_DECIMALS = 2


def weighted_target(target: TargetSurface, weight: str | Path | ArrayLike) -> TargetSurface:
    """The target with weights of its places.

    Parameters
    ----------
    weight : a formula in x, y, z, r and theta (mm in the target's file), a grey picture, or (V,) numbers at the
        vertices of `target.disk`. A picture lies over the target as one sees it along z, its first row at the largest
        y; black is 1, white 10.

    Raises
    ------
    TargetError
        The weights are not understood, or are not from 0.01 to 100.

    Examples
    --------
    >>> target = TargetSurface.of_formula("10*(1 - (r/50)**2)", 80.0)
    >>> weighted = weighted_target(target, "1 + 4*(x > 0)")
    >>> weighted.weight_at(np.array([[-20.0, 0.0, 9.0], [20.0, 0.0, 9.0]])).tolist()
    [1.0, 5.0]
    """
    if isinstance(weight, str | Path):
        is_picture = str(weight).lower().endswith(PICTURE_FORMATS)
        places = np.asarray(np.linalg.solve(target.motion, (target.disk.vertices - target.shift_mm).T).T, dtype=float)
        values = _picture(target, Path(weight), places) if is_picture else _formula(target, str(weight), places)
    else:
        values = np.asarray(weight)
        if values.shape != (len(target.disk.vertices),) or values.dtype.kind not in "iuf":
            raise TargetError(
                target.name,
                f"weights of shape {values.shape}: must be {len(target.disk.vertices)} numbers, one a vertex",
            )
    low, high = WEIGHT_RANGE
    wrong = np.flatnonzero(~((values >= low) & (values <= high)))
    if len(wrong):
        at = place_text(target.disk.vertices[wrong[0]])
        problem = f"the weight at {at} in the pose of the fit is {values[wrong[0]]:.4g}: must be {low:g} to {high:g}"
        raise TargetError(target.name, problem)
    return replace(target, weight=values.astype(float))


def _formula(target: TargetSurface, formula: str, places: Floats) -> Floats:
    x, y, z = places.T
    try:
        return evaluate(formula, {"x": x, "y": y, "z": z, "r": np.hypot(x, y), "theta": np.arctan2(y, x)})
    except ExpressionError as error:
        raise TargetError(target.name, f"the formula of the weight {error}") from None


def _picture(target: TargetSurface, path: Path, places: Floats) -> Floats:
    from scipy.ndimage import map_coordinates  # slow to import, rarely used

    try:
        levels = picture_levels(path)
    except ImageError as error:
        raise TargetError(target.name, f"the picture of the weight {error}") from None
    plane = places[:, :2]
    low, size = plane.min(axis=0), np.ptp(plane, axis=0)
    share = (plane - low) / np.where(size > 0.0, size, 1.0)
    rows, columns = (count - 1 for count in levels.shape)
    at = np.stack([(1.0 - share[:, 1]) * rows, share[:, 0] * columns])
    grey = map_coordinates(np.nan_to_num(levels), at, order=1, mode="nearest")
    black, white = PICTURE_WEIGHTS
    return np.asarray(black + (white - black) * np.clip(grey, 0.0, 1.0))


def with_weights(design: Design, target: TargetSurface, target_map: TargetMap, plan: Layout) -> Design:
    """The design with the weights of the target at its lattice sites, so that a further fit has them too."""
    if target.weight is None:
        return design
    weights = target.weight_at(target_map.places(plan.lattice.place(plan.sheet_sites))).round(WEIGHT_DECIMALS)
    entries = zip(plan.sheet_sites.tolist(), weights.tolist(), strict=True)
    kept = tuple(WeightedSite(site=tuple(site), weight=weight) for site, weight in entries if weight != 1.0)
    return design.model_copy(update={"fit": FitWeights(weights=kept)})
