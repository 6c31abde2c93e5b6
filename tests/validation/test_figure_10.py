"""What the paper says of figure 10, by the exact model on coarse meshes and by the preview.

Both have the free corners of the doubly-curved roof stick out, higher than the held ones.
"""

from __future__ import annotations

import numpy as np
import pytest

from asterism.self_intersections import self_intersections
from asterism.shape import Shape
from pattern.layout import Floats
from tests.validation.figures import both, bumps, contractions, exact, middles, shown

pytestmark = pytest.mark.slow

EXACT, PREVIEW = 0, 1
MODELS = pytest.mark.parametrize("model", [EXACT, PREVIEW], ids=["exact", "preview"])
FIXED, FREE = (30.0, 150.0, 270.0), (90.0, 210.0, 330.0)  # deg, corners of the doubly-curved roof
NEAR = 15.0  # deg


def shapes(name: str, model: int) -> tuple[Shape, Floats]:
    """A model's shape, and its cell means (V, 3) at the reference's printed points."""
    found = both(name)
    return ((found.reference, found.reference_mean), (found.other, found.other_mean))[model]


def height(name: str, model: int, x: float, y: float) -> float:
    """mm, of the cell means around a printed place."""
    printed, mean = both(name).reference.printed, shapes(name, model)[1]
    return float(mean[np.hypot(*(printed - (x, y)).T) < 8.0, 2].mean())


def rise(name: str, model: int) -> float:
    """Of the ridge over the eaves, in spans between these."""
    printed, mean = both(name).reference.printed, shapes(name, model)[1]
    right, left = (mean[sign * printed[:, 0] > printed[:, 0].max() - 4.0] for sign in (1.0, -1.0))
    ground = np.concatenate([right, left])[:, 2].mean()
    return float((height(name, model, 0.0, 0.0) - ground) / (right[:, 0].mean() - left[:, 0].mean()))


def in_direction(places: Floats, angles: tuple[float, ...]) -> np.ndarray:
    """(n,) whether printed places (n, 2) lie outside, towards one of these corners."""
    angle = np.degrees(np.arctan2(places[:, 1], places[:, 0]))
    away = np.abs((angle[:, None] - np.array(angles) + 180.0) % 360.0 - 180.0).min(axis=1)
    return (away < NEAR) & (np.hypot(*places.T) > 60.0)


@MODELS
def test_the_tunnel_is_a_cylinder_more_curved_than_the_roof(model: int) -> None:
    across, along = middles(both("tunnel"), 40.0)[model]
    assert across > 0.009 and abs(along) < 0.1 * across
    # its edges stay on the ground, half a circle apart
    assert rise("tunnel", model) > 1.3 * rise("roof", model) > 0.2
    for y in (-40.0, 0.0, 40.0):
        assert height("tunnel", model, 0.0, y) > height("tunnel", model, 40.0, y) > height("tunnel", model, 80.0, y)


@MODELS
def test_the_tunnels_edges_keep_it_from_passing_through_itself(model: int) -> None:
    shape = shapes("tunnel", model)[0]
    assert self_intersections(shape.positions, shape.triangles) == 0


@MODELS
def test_the_u_shape_is_an_amphitheatre(model: int) -> None:
    ratio, place = contractions(both("u-shape"), shapes("u-shape", model)[0])
    inside = (np.abs(place[:, 0]) < 35.0) & (place[:, 1] > -25.0)
    along_u = (np.abs(place[:, 0]) > 70.0) | (place[:, 1] < -60.0)
    assert ratio[inside].mean() < ratio[along_u].mean() - 0.03
    # seats on three sides, and the stage open on the fourth
    ranks = [height("u-shape", model, x, y) for x, y in ((-60.0, 0.0), (60.0, 0.0), (0.0, -60.0))]
    stage, front = height("u-shape", model, 0.0, 10.0), height("u-shape", model, 0.0, 80.0)
    assert min(ranks) > stage + 1.5 and stage > front + 3.0


@MODELS
def test_the_roof_on_three_corners_is_doubly_curved(model: int) -> None:
    most, least = middles(both("doubly-curved"), 60.0)[model]
    assert most > 0.0015 and least > 0.9 * most
    for angle in np.radians(FIXED):
        x, y = 90.0 * np.cos(angle), 90.0 * np.sin(angle)
        assert height("doubly-curved", model, 0.0, 0.0) > height("doubly-curved", model, x, y) + 3.0


@MODELS
def test_big_stars_at_the_free_corners_contract_less_and_buckle(model: int) -> None:
    shape = shapes("doubly-curved", model)[0]
    ratio, place = contractions(both("doubly-curved"), shape)
    free = in_direction(place, FREE)
    assert ratio[free].mean() > 0.012 + max(ratio[~free].mean(), ratio[in_direction(place, FIXED)].mean())
    centres = both("doubly-curved").layout.centres
    corner, held = (bumps(shape)[in_direction(centres, angles)].mean() for angles in (FREE, FIXED))
    assert corner > 2.5 * held


@MODELS
def test_the_free_corners_of_the_doubly_curved_roof_stick_out(model: int) -> None:
    printed, mean = both("doubly-curved").reference.printed, shapes("doubly-curved", model)[1]
    free, held = (mean[in_direction(printed, angles), 2].mean() for angles in (FREE, FIXED))
    assert free > held + 3.0


def test_the_shapes_are_minima_and_the_previews_are_near() -> None:
    for name in ("tunnel", "u-shape", "doubly-curved"):
        assert exact(name).summary["is_minimum"] and shown(name).summary["is_minimum"]
        found = both(name).rms_percent
        assert found < 2.0
        # what is expected leaves out the error of the exact model's coarse mesh, which counts where a sheet is soft
        assert found < 1.3 * shown(name).summary["expected_rms_percent"] or name == "doubly-curved"
