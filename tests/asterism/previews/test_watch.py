"""Searches that are watched, stopped, or given up after a while leave the last good shape."""

from __future__ import annotations

import itertools
from functools import partial

import numpy as np
import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.previews.session import Preview, SearchLimitError
from tests.asterism.previews.designs import edited

dome = partial(edited, "dome")


class Stopped(Exception):
    pass


class Countdown:
    """Lets so many calls pass, and stops all later ones; None passes all."""

    def __init__(self) -> None:
        self.calls = 0
        self.left: int | None = None

    def __call__(self) -> None:
        self.calls += 1
        if self.left is not None:
            self.left -= 1
            if self.left < 0:
                raise Stopped


THINNER = dome(stars={"thickness_mm": 0.27})
CUT = dome(border={"rings": 2})


@pytest.mark.slow
@pytest.mark.parametrize("design", [THINNER, CUT, dome(pins=[])], ids=["stars", "outline", "free"])
def test_every_edit_can_be_stopped_at_any_moment(design: Design) -> None:
    check = Countdown()
    preview = Preview(gallery.load("dome"), check=check)
    shape, before = preview.shape(), preview.equilibrium
    check.calls = 0
    list(preview.edit(design))
    total = check.calls
    assert total > 3
    list(preview.edit(gallery.load("dome")))
    for left in np.unique(np.linspace(0, total - 1, 4).astype(int)):
        check.left = int(left)
        with pytest.raises(Stopped):
            list(preview.edit(design))
        check.left = None
        assert preview.design == gallery.load("dome") and preview.equilibrium.is_minimum
        assert preview.equilibrium.energy == pytest.approx(before.energy, rel=1e-9)
    again = preview.shape()
    assert again.positions == pytest.approx(shape.positions, abs=1e-5)
    assert preview.update(design).height_mm == pytest.approx(Preview(design).shape().height_mm, rel=1e-5)


def test_flip_can_be_stopped() -> None:
    check = Countdown()
    preview = Preview(gallery.load("tube"), check=check)
    before, check.left = preview.state, 2
    with pytest.raises(Stopped):
        preview.flip()
    assert preview.state is before


def test_a_search_is_given_up_after_a_while(monkeypatch: pytest.MonkeyPatch) -> None:
    preview = Preview(gallery.load("dome"), max_seconds=30.0)
    seconds = itertools.count(0.0, 10.0)
    monkeypatch.setattr("asterism.previews.session.time.perf_counter", lambda: next(seconds))
    with pytest.raises(SearchLimitError, match="30 s"):
        preview.update(CUT)
    monkeypatch.undo()
    assert len(preview.sheet.layout.centres) == 37 and preview.equilibrium.is_minimum
    assert preview.update(THINNER).summary["is_minimum"]


@pytest.mark.parametrize("limit", [0.0, float("nan")])
def test_a_limit_is_above_zero(limit: float) -> None:
    with pytest.raises(ValueError, match="max_seconds"):
        Preview(gallery.load("star"), max_seconds=limit)
