"""What a verification warns of, and that it does so only where it is true."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.exact.simulation import off_branch
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.results.records.exact import ExactRecord
from asterism.shape.comparison import compare_shapes
from asterism.verification.verify import Verification, verification_warnings
from tests.asterism.verification.printed import design, shape

OF = design()
PLAN = layout(OF)
EXACT = {
    "is_minimum": True, "self_intersections": 0, "stars_total": 7, "stars_down": [], "stars_off_branch": [],
    "mesh_error_percent": None, "mesh_change_percent": None, "energy_n_mm": 1.0,
}  # fmt: skip

OFF = "1 of 7 stars of the exact shape is not on the side that the design asks for: star 3"


def bowl(depth: float) -> Any:
    def place(points: Floats) -> Floats:
        return np.column_stack([points, depth * (points**2).sum(axis=1)])

    return place


@cache
def bowls(exact: float, preview: float) -> Verification:
    one, other = replace(shape(OF, bowl(exact)), summary=EXACT), shape(OF, bowl(preview))
    return Verification(
        OF, other, {"release": one}, {"release": compare_shapes(one, other, PLAN, symmetries(OF, PLAN))}
    )


def said(depths: tuple[float, float] = (0.01, 0.01), preview: dict[str, Any] | None = None, **exact: Any) -> list[str]:
    found = bowls(*depths)
    one = replace(found.exact["release"], summary=EXACT | exact)
    return verification_warnings(
        replace(found, preview=replace(found.preview, summary=preview or {}), exact={"release": one}),
        0.0,
    )


def test_nothing_is_said_of_shapes_that_are_alike() -> None:
    assert said(preview={"expected_rms_percent": 1.0}) == []
    assert said(preview={"warnings": ["a star is beyond the law's range"]}) == ["a star is beyond the law's range"]


@pytest.mark.parametrize(("times", "surprising"), [(1.9, False), (2.1, True)])
def test_a_distance_far_above_the_expected_one_is_told_with_both_numbers(times: float, surprising: bool) -> None:
    distance = bowls(0.01, 0.0107).comparison.rms_percent
    lines = said((0.01, 0.0107), {"expected_rms_percent": distance / times})
    estimate = f"the estimated error of the preview ({distance / times:.1f} %)"
    line = f"the distance ({distance:.1f} %) is more than twice {estimate}"
    assert lines == ([line] if surprising else [])


@pytest.mark.parametrize(
    ("depths", "wrong"),
    [((0.01, 0.0107), False), ((0.01, 0.0093), False), ((0.01, 0.0115), True), ((0.01, 0.0085), True),
     ((1e-6, 3e-6), False)],
)  # fmt: skip
def test_heights_that_differ_are_told_unless_the_sheet_is_flat(depths: tuple[float, float], wrong: bool) -> None:
    exact, preview = bowls(*depths).comparison.record.heights_mm
    off = 100.0 * abs(preview / exact - 1.0)
    line = f"the preview is {preview:.1f} mm high, the exact shape {exact:.1f} mm: {off:.0f} % off"
    assert said(depths) == ([line] if wrong else [])


@pytest.mark.parametrize(("times", "surprising"), [(1.9, False), (2.1, True)])
@pytest.mark.parametrize("depths", [(0.01, 0.0105), (0.01, 0.008)])
def test_heights_that_were_expected_to_differ_are_no_surprise(
    depths: tuple[float, float], times: float, surprising: bool
) -> None:
    """However little or much they do."""
    exact, preview = bowls(*depths).comparison.record.heights_mm
    expected = 100.0 * abs(preview / exact - 1.0) / times
    lines = said(depths, {"expected_height_percent": expected})
    assert len(lines) == surprising
    assert all(line.endswith(f"% off, more than twice its estimated error ({expected:.1f} %)") for line in lines)


@pytest.mark.parametrize(
    ("down", "off", "line"),
    [
        ([2, 5], [2, 5], "2 of 7 stars of the exact shape bump down: stars 2, 5"),
        ([2, 5], [], "2 of 7 stars of the exact shape bump down: stars 2, 5"),
        (
            [],
            [3],
            "the exact model: 1 of 7 stars of the exact shape is not on the side that the design asks for: star 3",
        ),
    ],
)
def test_stars_on_another_side_are_named_once(down: list[int], off: list[int], line: str) -> None:
    warnings = list(off_branch(ExactRecord.from_json({"stars_off_branch": off, "stars_total": 7})))
    assert said(stars_down=down, stars_off_branch=off, warnings=warnings) == [line]


def test_an_exact_shape_that_is_no_minimum_has_no_other_warnings() -> None:
    line = "not a minimum: smallest eigenvalue -1.0e-03 N/mm is not positive"
    assert said((0.01, 0.0115), is_minimum=False, warnings=[line]) == [f"the exact model: {line}"]


def with_other(apart: float, one: dict[str, Any], other: dict[str, Any]) -> list[str]:
    """What is said of two exact shapes so far apart, with summaries of their own."""
    found = bowls(0.01, 0.01)
    shapes = {
        name: replace(found.exact["release"], summary=EXACT | own)
        for name, own in (("release", one), ("preview", other))
    }
    both = replace(found, exact=shapes, comparisons=dict.fromkeys(shapes, found.comparison))
    return verification_warnings(both, apart)


@pytest.mark.parametrize(
    ("energy", "apart", "told"),
    [(1.0001, 3.0, True), (0.9999, 3.0, True), (1.006, 3.0, False), (1.0001, 2.4, False)],
)
def test_two_minima_of_nearly_one_energy_are_told(energy: float, apart: float, told: bool) -> None:
    line = (
        "the exact model has two minima, 3.0 % of the diameter apart, whose energies differ by 0.01 %: "
        "a print may rest in either"
    )
    assert with_other(apart, {}, {"energy_n_mm": energy}) == ([line] if told else [])
    # a start that has come to no minimum is no second form; and how high a sheet hangs makes two no more alike
    assert with_other(apart, {}, {"energy_n_mm": energy, "is_minimum": False}) == []
    assert with_other(apart, *({"energy_n_mm": each, "gravity": 99.0} for each in (100.0, 100.1))) == []


def test_what_the_exact_model_said_is_passed_on_once() -> None:
    """But what the preview said of the same pins, and what is said here in other words."""
    roll, pins = "the radius of a free roll depends on the mesh", "the pins let the sheet swing"
    crossing = "the sheet passes through itself (4 crossings); --contact prevents this"
    lines = said(
        preview={"warnings": [pins]}, self_intersections=4, self_contact=None, stars_down=[3], stars_off_branch=[3],
        warnings=[crossing, roll, OFF, pins],
    )  # fmt: skip
    assert lines == [
        pins,
        "1 of 7 stars of the exact shape bumps down: star 3",
        f"the exact model: {crossing}",
        f"the exact model: {roll}",
    ]


def test_an_unknown_mesh_error_is_told_where_meshes_differ_by_more_than_the_distance() -> None:
    distance = bowls(0.01, 0.0107).comparison.rms_percent
    lines = said((0.01, 0.0107), mesh_change_percent=1.1 * distance)
    assert len(lines) == 1 and lines[0].endswith(f"more than the distance ({distance:.1f} %)")
    assert said((0.01, 0.0107), mesh_error_percent=1.1 * distance, mesh_change_percent=1.1 * distance) == []
