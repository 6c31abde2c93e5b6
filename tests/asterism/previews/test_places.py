"""Places beside a point of a smooth surface, and printed points that are followed over edits."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from asterism.fem.elements.argyris import Argyris
from asterism.pattern import gallery
from asterism.previews.places import Places
from asterism.previews.session import Preview
from tests.asterism.previews.designs import edited
from tests.fem.hexagons import hexagon


def test_shifts_of_the_print_are_followed_to_second_order() -> None:
    """Exactly, on a surface that is quadratic in the print."""
    space = Argyris(hexagon(1))
    a, b, c = 4e-3, -2e-3, 3e-3

    def bowl(points: np.ndarray) -> np.ndarray:
        (x, y), out = points.T, np.zeros((len(points), 6, 3))
        out[:, 0] = np.column_stack([x, y, 0.5 * a * x**2 + 0.5 * b * y**2 + c * x * y])
        out[:, 1, 0] = out[:, 2, 1] = 1.0
        out[:, 1, 2], out[:, 2, 2] = a * x + c * y, b * y + c * x
        out[:, 3, 2], out[:, 4, 2], out[:, 5, 2] = a, b, c
        return out

    random = np.random.default_rng(2)
    points, shift = random.uniform(-40.0, 40.0, (2, 9, 2))
    surface = Places.at(space.locate(points), space.interpolate(bowl))
    np.testing.assert_allclose(surface.smooth + surface.moved(shift), bowl(points + shift)[:, 0], atol=1e-8)


def test_the_curvature_of_a_roll_does_not_depend_on_how_it_was_sheared() -> None:
    """The print is sheared by one half, and lies on a roll of curvature k about the second axis."""
    k = 0.02
    places = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0]]
    jets = np.array([[*places, [0.0, 0.0, k], [0.0, 0.0, 0.25 * k], [0.0, 0.0, 0.5 * k]]])
    surface = Places.at(SimpleNamespace(jets=lambda x: jets), np.empty((0, 3)))  # type: ignore[arg-type]
    assert surface.area[0] == pytest.approx(1.0)
    assert surface.mean_curvature[0] == pytest.approx(-0.5 * k)
    assert surface.gaussian_curvature[0] == pytest.approx(0.0, abs=1e-12)


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
