"""Points beside segments, and crossings, against looking at all pairs."""

from __future__ import annotations

import numpy as np
import pytest

from pattern.near_segments import crossings, near_segments
from pattern.planar import distance_to_segment

TOLERANCE = 1e-3


@pytest.mark.parametrize("longest", [0.02, 0.3, 2.0])
@pytest.mark.parametrize("seed", range(3))
def test_nothing_is_missed(longest: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    starts = rng.uniform(0.0, 1.0, (150, 2))
    ends = starts + longest * rng.uniform(-1.0, 1.0, (150, 2))
    beside = starts[:20] + rng.uniform(0.1, 0.9, (20, 1)) * (ends - starts)[:20]
    points = np.concatenate([starts, ends, beside, rng.uniform(-1.0, 2.0, (200, 2))])
    segments = np.column_stack([np.arange(150), 150 + np.arange(150)])
    segments[100:, 0] = segments[:50, 1]  # some begin where others end
    segment, point = near_segments(points, segments, TOLERANCE)
    found = set(zip(segment.tolist(), point.tolist(), strict=True))
    assert len(found) == len(segment)
    a, b = points[segments].swapaxes(0, 1)
    near = distance_to_segment(points, a[:, None], b[:, None]) <= TOLERANCE
    near[np.arange(150)[:, None], segments] = False
    assert near.sum() >= 20
    assert set(zip(*(part.tolist() for part in np.nonzero(near)), strict=True)) <= found
    expected = [
        [i, j]
        for i in range(150)
        for j in range(i + 1, 150)
        if not set(segments[i]) & set(segments[j]) and _cross(a[i], b[i], a[j], b[j])
    ]
    assert crossings(points, segments).tolist() == expected
    assert expected or longest < 0.1


def _cross(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> bool:
    """Whether the parts of two lines at which they meet are both between their ends."""
    along = np.linalg.solve(np.column_stack([b - a, c - d]), c - a)
    return bool(((along > 0.0) & (along < 1.0)).all())
