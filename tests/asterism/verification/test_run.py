"""Where the mesh error of an exact shape comes from."""

from __future__ import annotations

import pytest

from asterism.results.records.exact import ExactRecord
from asterism.results.records.shape import MeshLimitRecord
from asterism.verification.run import verified_mesh_error

LIMIT = MeshLimitRecord(height_mm=33.0, roll_radius_mm=35.0, distance_percent=5.0, wall_s=0.1)


@pytest.mark.parametrize(
    ("own", "order", "limit", "same_form", "result"),
    [
        (1.7, 1.1, LIMIT, True, (1.7, "meshes")),
        (1.7, None, LIMIT, True, (5.0, "law")),
        (None, 3.0, LIMIT, True, (5.0, "law")),
        (None, None, LIMIT, False, (None, None)),
        (None, None, LIMIT, None, (None, None)),
        (1.7, None, LIMIT, False, (1.7, "two meshes")),
        (1.7, None, None, True, (1.7, "two meshes")),
        (None, None, None, True, (None, None)),
    ],
)
def test_an_order_comes_before_previews_and_these_before_two_meshes(own, order, limit, same_form, result) -> None:
    exact = ExactRecord.from_json({"mesh_error_percent": own, "mesh_error_order": order})
    assert verified_mesh_error(exact, limit, same_form) == result


def test_the_limit_in_words_has_a_radius_only_of_a_roll() -> None:
    assert LIMIT.in_words() == "height 33.0 mm, radius 35.0 mm; 5.00 % of the diameter away"
    assert LIMIT.changed(roll_radius_mm=None).in_words() == "height 33.0 mm; 5.00 % of the diameter away"
