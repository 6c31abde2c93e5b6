"""A shape is of the form that counts, or of another one that the exact model has too."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from asterism.verification.minima import (
    MAX_FORM_DISTANCE_PERCENT,
    MAX_LIKE_AXIS_DEG,
    MAX_LIKE_DISTANCE_PERCENT,
    MAX_LIKE_NORMALS_DEG,
    alike,
    same_branch,
)


def compared(rms_percent: float, axes: tuple[float | None, float | None] = (None, None), normals: float = 5.0) -> Any:
    return SimpleNamespace(rms_percent=rms_percent, roll_axes_deg=axes, normals_rms_deg=normals)


@pytest.mark.parametrize(
    ("rms", "axes", "same"),
    [
        (1.0, (None, None), True),
        (1.1 * MAX_LIKE_DISTANCE_PERCENT, (None, None), False),
        (1.0, (30.0, None), False),
        (1.0, (175.0, 175.0 + 0.9 * MAX_LIKE_AXIS_DEG - 180.0), True),  # axes have no direction
        (1.0, (30.0, 30.0 + 1.1 * MAX_LIKE_AXIS_DEG), False),
    ],
)
def test_shapes_are_alike_if_near_and_rolled_about_one_axis(
    rms: float, axes: tuple[float | None, float | None], same: bool
) -> None:
    assert alike(compared(rms, axes)) is same


def test_a_sheet_that_faces_other_ways_is_another_form_however_near() -> None:
    assert alike(compared(1.0, normals=0.9 * MAX_LIKE_NORMALS_DEG))
    assert not alike(compared(1.0, normals=1.1 * MAX_LIKE_NORMALS_DEG))


def test_of_two_exact_forms_the_one_that_counts_must_be_nearer() -> None:
    near, far, apart = compared(1.0), compared(4.0), 2.0 * MAX_FORM_DISTANCE_PERCENT
    assert same_branch(near, far, apart)
    assert not same_branch(far, near, apart)
    assert same_branch(far, near, 0.5 * MAX_FORM_DISTANCE_PERCENT)  # then both are one form
    assert not same_branch(compared(1.1 * MAX_LIKE_DISTANCE_PERCENT), far, 0.5 * MAX_FORM_DISTANCE_PERCENT)
