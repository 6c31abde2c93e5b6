"""Printed points that are followed over edits are where a new look finds them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern import gallery
from asterism.previews.session import Preview
from tests.asterism.previews.designs import edited

EDITS: list[dict[str, Any]] = [
    {"stars": {"thickness_mm": 0.33}},
    {"stars": {"length_mm": 7.5}},
    {"stars": {"override": [{"site": [0, 0], "length_mm": 4.0}]}},
    {"stars": {"override": [{"site": [1, 0], "remove": True}]}},
    {"pins": [{"where": "border", "scale": 0.8}]},
    {"stars": {"length_mm": 7.5}, "pins": [{"where": "border", "scale": 0.72, "offset_mm": [0.0, 0.0, 2.0]}]},
]


@pytest.mark.slow
def test_places_are_those_of_a_new_look() -> None:
    preview = Preview(gallery.load("dome"))
    points = preview.shape().printed[::7]
    lens = preview.lens(points)
    for change in EDITS:
        for stage in preview.edit(edited("dome", **change)):
            places, fresh = lens(stage.x), preview.at(points, stage.x)
            assert np.array_equal(places.bumpy, fresh.bumpy) and np.array_equal(places.smooth, fresh.smooth)
            assert np.array_equal(places.normals, fresh.normals)
            assert np.array_equal(places.mean_curvature, fresh.mean_curvature)
        assert np.array_equal(lens().bumpy, preview.at(points).bumpy)


def test_points_off_a_smaller_outline_are_refused() -> None:
    preview = Preview(gallery.load("dome"))
    lens = preview.lens([[0.0, 50.0]])
    preview.update(edited("dome", border={"rings": 1}))
    with pytest.raises(ValueError, match="outside the sheet"):
        lens()
