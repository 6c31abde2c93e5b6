"""Points that move a little are found in less time, in the same places."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import Delaunay

from asterism.pattern.geometry.point_location import TriangleFinder, clipped

PRINTED = np.random.default_rng(1).uniform(-10.0, 10.0, (300, 2))
TRIANGLES = Delaunay(PRINTED).simplices.astype(np.int64)


@pytest.mark.parametrize("step", [0.0, 0.01, 0.5, 3.0])
def test_points_found_from_where_they_were_are_those_found_anew(step: float) -> None:
    rng, finder = np.random.default_rng(2), TriangleFinder(PRINTED, TRIANGLES)
    points = rng.uniform(-6.0, 6.0, (500, 2))
    known, _ = finder.nearest(points)
    moved = points + rng.uniform(-step, step, points.shape)
    for (triangle, weights), (right, right_weights) in [(finder.near_before(moved, known), finder.nearest(moved))]:
        inside = right_weights.min(axis=1) > 1e-9
        assert inside.mean() > 0.9 and np.array_equal(triangle[inside], right[inside])
        places, others = (
            np.einsum("nk,nkc->nc", clipped(each), PRINTED[TRIANGLES[which]])
            for which, each in ((triangle, weights), (right, right_weights))
        )
        assert np.abs(places - others).max() < 1e-12
