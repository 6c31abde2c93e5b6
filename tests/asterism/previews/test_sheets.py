"""Kept prints, and the positions of printed points, which are followed over edits."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from asterism.fem.elements.argyris import Argyris
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews import sheet as sheets
from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.places import Places
from asterism.previews.session import Preview
from asterism.previews.sheet import kept_print
from tests.asterism.previews.designs import edited
from tests.fem.hexagons import hexagon

small = partial(edited, "dome", mesh={"edge_mm": 5.0}, border={"rings": 1})


@pytest.fixture(autouse=True)
def _without_kept_prints() -> Iterator[None]:
    sheets._kept.clear()
    yield
    sheets._kept.clear()


def is_kept(design: Design, triangles: int | None = None) -> bool:
    return kept_print(design, layout(design), triangles, PREVIEW_MODEL) is not None


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        {"stars": {"override": [{"star": 2, "length_mm": 0.0}]}},
        {"mesh": {"edge_mm": 4.0}},
        {"pins": [{"where": "border", "scale": 0.8}]},
    ],
    ids=["removed", "mesh", "pins"],
)
def test_the_shape_is_that_of_a_new_print(change: dict[str, Any]) -> None:
    edited = small(**change)
    new = Preview(edited).shape()
    sheets._kept.clear()
    Preview(small()).shape()
    assert is_kept(edited)
    again = Preview(edited).shape()
    assert np.array_equal(again.triangles, new.triangles)
    assert again.positions == pytest.approx(new.positions, abs=1e-6)  # the tolerance of Newton's method leaves 1e-8
    assert again.summary["warnings"] == new.summary["warnings"]


@pytest.mark.slow
def test_the_same_print_shares_its_elements_and_the_shape_its_triangles() -> None:
    first, second = Preview(small()), Preview(small(stars={"width_mm": 0.9}))
    assert second.state.sheet.space is first.state.sheet.space
    assert second.state.shell.assembly is first.state.shell.assembly
    assert second.state.factor is not first.state.factor
    first.shape()
    third = Preview(small())
    assert third.sheet.shown_mesh is first.sheet.shown_mesh


def test_other_prints_share_nothing_and_few_are_kept() -> None:
    Preview(small(), triangles=30)
    assert is_kept(small(), triangles=30) and not is_kept(small())
    assert not is_kept(small(border={"rings": 2}), triangles=30)
    for triangles in (31, 32):
        Preview(small(), triangles=triangles)
    assert not is_kept(small(), triangles=30) and is_kept(small(), triangles=31)


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
