"""A preview of a kept print has the shape of one that computes everything."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews import sheet as sheets
from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.session import Preview
from asterism.previews.sheet import kept_print
from tests.asterism.previews.designs import edited

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
