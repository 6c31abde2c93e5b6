"""Points laid on other points."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from asterism.pattern.geometry.rigid_fit import rigid_fit
from tests.distances import rms_distance


def test_rigid_fit() -> None:
    rng = np.random.default_rng(0)
    points = rng.normal(size=(9, 3))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    rotation, shift = rigid_fit(points, points @ turn.T + [1.0, 2.0, 3.0])
    np.testing.assert_allclose(rotation, turn, atol=1e-12)
    np.testing.assert_allclose(shift, [1.0, 2.0, 3.0], atol=1e-12)


def test_distance_knows_turns_from_reflections() -> None:
    rng = np.random.default_rng(1)
    points = rng.normal(size=(30, 3))
    turned = points @ Rotation.random(rng=rng).as_matrix().T + 3.0
    assert rms_distance(points, turned) < 1e-6
    assert rms_distance(points, turned, mirrored=True) > 0.1
    assert rms_distance(points * [1.0, -1.0, 1.0], turned) > 0.1
    assert rms_distance(points * [1.0, -1.0, 1.0], turned, mirrored=True) < 1e-6


def test_distance_is_that_of_the_noise() -> None:
    rng = np.random.default_rng(2)
    points = rng.normal(size=(400, 3))
    moved = points[:, [1, 2, 0]] + [4.0, -1.0, 2.0] + 0.01 * rng.normal(size=points.shape)
    assert rms_distance(points, moved) == pytest.approx(0.01 * np.sqrt(3.0), rel=0.05)


def test_weights_count_points_as_often_as_they_say() -> None:
    rng = np.random.default_rng(3)
    points, targets, times = rng.normal(size=(12, 3)), rng.normal(size=(12, 3)), rng.integers(1, 5, 12)
    weighted = rigid_fit(points, targets, times.astype(float))
    for found, several in zip(weighted, rigid_fit(points.repeat(times, 0), targets.repeat(times, 0)), strict=True):
        np.testing.assert_allclose(found, several, atol=1e-12)
