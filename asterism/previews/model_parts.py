"""The parts of the preview model that change a shape, and the values that turn each of them off."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from asterism.previews.model import PREVIEW_MODEL, PreviewModel

PARTS: dict[str, dict[str, Any]] = {
    "rosette metric": {"has_rosette_metric": False},
    "lengths that follow curvature": {"has_curvature_lengths": False},
    "series bending": {"has_series_bending": False},
    "Gaussian curvature": {"gaussian_area": 0.0},
    "roll axis": {"sixfold_factor": 0.0},
    "directions": {"anisotropy_share": 0.0},
    "holes": {"has_holes": False},
    "softness at points": {"has_point_softness": False},
    "neo-Hookean fabric": {"has_neo_hookean_fabric": False},
    "turn of free rims": {"has_rim_turn": False},
    "arms into free rims": {"has_rim_arms": False},
    "supported rims": {"supported_rim_width": 0.0},
    "bumps": {"has_bumps": False},
    "arms that keep their length": {"has_arm_lengths": False},
    "arms that bend with the mean curvature": {"arm_mean_share": 0.0},
    "last arms": {"has_last_arms": False},
}


def without(part: str) -> PreviewModel:
    """The model with one part turned off.

    Raises
    ------
    KeyError
        `PARTS` has no part of that name.

    Examples
    --------
    >>> without("rosette metric").has_rosette_metric
    False
    """
    return replace(PREVIEW_MODEL, **PARTS[part])
