"""Large targets have fewer triangles, and the distance by which they move is stated."""

from __future__ import annotations

import re

import numpy as np
import pytest

from asterism.fitting.target import MAX_TARGET_TRIANGLES, TargetSurface
from tests.asterism.fitting.surfaces import spherical_cap


def test_a_large_target_is_decimated_with_a_note() -> None:
    vertices, triangles = spherical_cap(35.0, rings=70)
    assert len(triangles) > MAX_TARGET_TRIANGLES
    target = TargetSurface.of_triangles(vertices, triangles, name="cap")
    assert len(target.disk.triangles) <= MAX_TARGET_TRIANGLES
    (note,) = target.notes
    moved = float(re.search(r"by at most (\S+) mm", note)[1])  # type: ignore[index]
    away = np.abs(target.nearest(vertices @ target.motion.T + target.shift_mm).distance)
    assert away.max() == pytest.approx(moved, rel=0.1) and moved < 0.01


def test_a_small_target_stays_as_it_is() -> None:
    vertices, triangles = spherical_cap(35.0)
    target = TargetSurface.of_triangles(vertices, triangles)
    assert target.notes == () and len(target.disk.triangles) == len(triangles)
