"""The exact shape from the release and from the preview: which counts, and what is said of the other one."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from asterism import Design, Shape, simulate, verify
from asterism.exact.simulation import exact_shape
from asterism.pattern.layout.build import layout
from asterism.verification.both_starts import lower_minimum
from tests.asterism.previews.designs import edited

SMALL = Design.from_dict(
    {"stars": {"length_mm": 8.0, "thickness_mm": 0.4}, "border": {"rings": 1}, "mesh": {"edge_mm": 6.0}}
)


@pytest.fixture(scope="module")
def released() -> Shape:
    return exact_shape(SMALL)


def other(shape: Shape, more: float, **summary: Any) -> Shape:
    """A shape of another form, rolled up about an axis, with a share of the energy more."""
    x, y = shape.printed.T
    rolled = np.column_stack([x, 12.0 * np.sin(y / 12.0), 12.0 * np.cos(y / 12.0)])
    energy = (1.0 + more) * shape.summary["energy_n_mm"]
    return replace(shape, positions=rolled, summary=shape.summary | {"energy_n_mm": energy} | summary)


@pytest.mark.slow
def test_both_starts_of_a_small_sheet_end_in_one_minimum(released: Shape) -> None:
    said: list[str] = []
    shape = simulate(SMALL, say=said.append)
    (minimum,) = shape.summary["minima"]
    assert shape.summary["is_minimum"] and not shape.others
    assert shape.summary["starts"] == 2 and shape.summary["starts_lost"] == 0 and shape.summary["minima_seen"] == 1
    assert minimum["start_names"] == ["release", "preview"] and minimum["default"]
    assert shape.summary.table()["minimum 1"].endswith("7 up; from release and preview")
    assert shape.summary["energy_n_mm"] == pytest.approx(released.summary["energy_n_mm"], rel=1e-8)
    assert "started from the preview" in said


@pytest.mark.parametrize(
    ("more", "result", "near"), [(0.02, "release", False), (0.001, "release", True), (-0.001, "preview", True)]
)
def test_the_lower_of_two_minima_counts_and_the_other_is_kept(
    released: Shape, more: float, result: str, near: bool
) -> None:
    second = other(released, more)
    shape = lower_minimum(SMALL, layout(SMALL), released, second)
    s = shape.summary
    assert [minimum["start_names"] for minimum in s["minima"]] == [
        [result],
        [{"release": "preview"}.get(result, "release")],
    ]
    assert s["minima_seen"] == s["starts"] == 2 and s["result_is"] == "lowest energy"
    assert len(shape.others) == 1 and s["energy_n_mm"] <= shape.others[0].summary["energy_n_mm"]
    assert s["next_minimum_percent"] == pytest.approx(100.0 * abs(more), rel=2e-3)
    assert s["minima"][1]["distance_percent"] == s["minima_distance_percent"][0][1] > 10.0
    assert any("a print may rest in either" in line for line in s["warnings"]) is near
    assert [minimum["file"] for minimum in s["minima"]] == ["shape", "minimum-2"]
    assert {"minimum 1", "minimum 2"} <= set(s.table())


def test_a_lower_minimum_with_stars_on_the_wrong_side_does_not_count(released: Shape) -> None:
    inverted = other(released, -0.01, stars_off_branch=[3], stars_down=[3])
    shape = lower_minimum(SMALL, layout(SMALL), released, inverted)
    assert shape.summary["minima"][0]["start_names"] == ["release"]
    assert shape.summary["next_minimum_percent"] == pytest.approx(-1.0, rel=1e-6)
    assert shape.summary["result_is"] == "lowest energy of those whose stars are all on their branch"


def test_a_start_without_a_minimum_is_lost(released: Shape) -> None:
    lost = other(released, -0.5, is_minimum=False)
    shape = lower_minimum(SMALL, layout(SMALL), released, lost)
    assert shape.summary["starts_lost"] == 1 and shape.summary["minima_seen"] == 1 and not shape.others
    assert shape.summary["minima"][0]["start_names"] == ["release"]
    uncertain = replace(released, summary=released.summary | {"is_minimum": False})
    shape = lower_minimum(SMALL, layout(SMALL), uncertain, other(released, 0.5))
    assert shape.summary["minima"][0]["start_names"] == ["preview"] and shape.summary["is_minimum"]


@pytest.mark.slow
def test_a_fabric_without_a_law_is_released_alone() -> None:
    said: list[str] = []
    free = Design.from_dict(SMALL.to_dict() | {"fabric": {"bending": "none"}, "border": {"rings": 0}})
    shape = simulate(free, say=said.append)
    assert shape.summary["starts"] == 1 and any("no start from the preview" in line for line in said)


@pytest.mark.slow
def test_one_start_is_the_release_and_a_given_shape_is_the_only_start(released: Shape) -> None:
    alone = simulate(SMALL, starts=1)
    assert alone.summary["starts"] == 1 and np.array_equal(alone.positions, released.positions)
    near = simulate(SMALL, near=released)
    assert near.summary["result_is"] == "from a shape that was given"
    with pytest.raises(ValueError, match="near goes with one start"):
        simulate(SMALL, starts=2, near=released)


@pytest.mark.slow
def test_starts_that_meet_on_a_coarse_mesh_share_the_finer_ones() -> None:
    found = verify(edited("dome", border={"rings": 2}, mesh={"edge_mm": 1.2}))
    release, near = found.summary["starts"]["release"], found.summary["starts"]["preview"]
    assert found.summary["starts_agree"] and found.summary["starts_distance_percent"] < 1e-6
    assert (
        near["joined_at_vertices"] in [level["vertices"] for level in found.summary["exact"]["levels"]]
        and near["is_minimum"]
    )
    assert near["energy_n_mm"] == release["energy_n_mm"] and near["iterations"] < release["iterations"] / 3
    assert "joined_at_vertices" not in release
