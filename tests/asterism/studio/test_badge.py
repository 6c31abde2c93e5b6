"""The one statement about the shape, in the situations of a day, and whatever a random day brings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.pattern import gallery
from asterism.studio.jobs import JobRequests
from asterism.studio.messages import Released, Rested, ShapeSummary, StudioProblem
from asterism.studio.shape_requests import EngineRequests
from asterism.studio.studio import Studio
from tests.asterism.studio.conftest import QuickEngine
from tests.asterism.studio.flat_frames import flat_frame
from tests.asterism.studio.quick_engines import exact


class SlowEngine(QuickEngine):
    """A link to an engine that answers when the test says so."""

    asked = 0

    def ask(self, message: Any) -> None:
        self.status, self.asked = "computing", message.seq

    def frame(self, stage: str = "equilibrium", is_minimum: bool = True, seq: int | None = None) -> None:
        seq = self.asked if seq is None else seq
        if stage != "linear" and seq >= self.asked:
            self.status = "ready"
        self.receive(flat_frame(seq, stage=stage, is_minimum=is_minimum))

    def rest(self, percent: float | None = 1.52, seconds: float = 2.0, is_minimum: bool = True) -> None:
        self.receive(Rested(self.asked, None if percent is None else b"preview", seconds))
        if percent is not None:
            self.receive(ShapeSummary(self.asked, {"expected_rms_percent": percent, "is_minimum": is_minimum}))

    def fail(self) -> None:
        self.status = "ready"
        self.receive(StudioProblem(self.asked, "too long", "no equilibrium within 20 s"))


class SlowChild:
    """The process of exact shapes, which answers when the test says so."""

    def __init__(self) -> None:
        self.orders: list[Any] = []

    def send(self, order: Any) -> None:
        self.orders.append(order)


class Day:
    """A studio without processes and without an event loop.

    Attributes
    ----------
    orders : exact shapes that were asked for, and None for each that was called off.
    """

    def __init__(self, folder: Path) -> None:
        (folder / "dome.toml").write_bytes(gallery.path("dome").read_bytes())
        self.studio = Studio(folder, folder / "dome.toml")
        self.studio.engine = EngineRequests(self.studio, SlowEngine)  # type: ignore[arg-type]
        self.studio.jobs = JobRequests(self.studio)
        self.engine: SlowEngine = self.studio.engine.link  # type: ignore[assignment]
        self.child = SlowChild()
        self.studio.settling._child = self.child  # type: ignore[assignment]
        assert self.studio.document is not None
        self.document = self.studio.document
        self.studio.engine.show(self.document, is_opened=True)

    def edit(self, thickness: float = 0.4) -> None:
        self.document.change({"stars.thickness_mm": thickness})
        self.document.end_gesture()
        self.studio.engine.show(self.document)

    def preview(self, percent: float = 1.52, seconds: float = 2.0) -> None:
        self.engine.frame()
        self.engine.rest(percent, seconds)

    def settle(self, is_minimum: bool = True) -> None:
        self.studio.settling._message(self.child, exact(self.child.orders[-1].job, is_minimum))  # type: ignore[arg-type]

    @property
    def exact(self) -> bytes | None:
        """What reports and exports are given."""
        return self.studio.shown.exact_of(self.document.revision)

    @property
    def said(self) -> tuple[str, str, bool]:
        badge = self.studio.badge()
        return badge["kind"], badge["words"], badge["is_stale"]


@pytest.fixture
def day(tmp_path: Path) -> Day:
    return Day(tmp_path)


def settled(day: Day, is_minimum: bool = True) -> None:
    day.preview()
    day.settle(is_minimum)


def saddle(day: Day) -> None:
    day.engine.frame(is_minimum=False)
    day.engine.rest(is_minimum=False)


def late_preview(day: Day) -> None:
    day.engine.frame()
    day.engine.receive(ShapeSummary(day.engine.asked, {"expected_rms_percent": 9.0}))


def printed(day: Day, seconds: float = 2.0) -> None:
    day.engine.frame("printed")
    day.engine.rest(None, seconds)


# situation: what happens; kind and words of the badge, whether the shape is of an older design, whether report and
# export get the exact shape; footer, picture, panel and the kept designs say the same words (tests of the page)
MATRIX: dict[str, tuple[list[Callable[[Day], None]], tuple[str, str, bool, bool]]] = {
    "opened": ([], ("computing", "Computing", False, False)),
    "first response": ([lambda day: day.engine.frame("linear")], ("computing", "Computing", False, False)),
    "found": ([lambda day: day.engine.frame()], ("preview", "Preview", False, False)),
    "rested": ([Day.preview], ("preview", "Preview, about 1.5 %", False, False)),
    "at a saddle": ([saddle], ("doubtful", "Not an equilibrium", False, False)),
    "settled": ([settled], ("exact", "Exact, mesh error 0.7 %", False, True)),
    "settled without a minimum": ([lambda day: settled(day, False)], ("doubtful", "Not an equilibrium", False, True)),
    "late preview": ([settled, late_preview], ("exact", "Exact, mesh error 0.7 %", False, True)),
    "edited after settling": ([settled, Day.edit], ("computing", "Computing", True, False)),
    "edit without an answer": (
        [settled, Day.edit, lambda day: day.engine.fail()],
        ("outdated", "Outdated", True, False),
    ),
    "large sheet": ([lambda day: day.preview(seconds=60.0)], ("preview", "Preview, about 1.5 %", False, False)),
    "printed only": ([lambda day: printed(day, 60.0)], ("none", "Not computed", False, False)),
    "printed and under way": ([printed], ("computing", "Computing", False, False)),
    "edited without a preview": (
        [printed, Day.settle, Day.edit, lambda day: printed(day, 60.0)],
        ("outdated", "Outdated", True, False),
    ),
}


@pytest.mark.parametrize("situation", MATRIX)
def test_each_situation_has_one_statement(situation: str, day: Day) -> None:
    acts, statement = MATRIX[situation]
    for act in acts:
        act(day)
    assert (*day.said, day.exact is not None) == statement


def test_what_takes_long_waits_for_a_click_and_can_be_stopped(day: Day) -> None:
    day.preview(seconds=60.0)
    assert day.child.orders == [] and day.studio.settling.waits_s == 60.0
    day.studio.settling.begin()
    assert len(day.child.orders) == 1 and day.studio.settling.waits_s is None
    day.studio.settling.stop()
    assert day.child.orders[-1] is None and day.studio.settling.waits_s == 60.0
    assert day.said[0] == "preview"


def test_an_exact_shape_that_fails_leaves_the_preview_and_is_over(day: Day) -> None:
    day.preview()
    day.studio.settling._message(day.child, StudioProblem(day.child.orders[-1].job, "no minimum", "no minimum"))  # type: ignore[arg-type]
    assert day.studio.settling.data() is None and day.said[0] == "preview"


def test_the_form_of_the_release_is_shown_on_request_and_goes_with_an_edit(day: Day) -> None:
    settled(day)
    order, settling = day.child.orders[-1], day.studio.settling
    assert settling.release == {"progress": {"done": 0, "of": 0}} and settling.data() is None
    other = replace(exact(order.job), shape=b"released")
    settling._message(day.child, Released(order.job, False, other, -0.4, 5.0))  # type: ignore[arg-type]
    assert settling.release is not None and not settling.release["is_shown"] and day.exact == b"exact"
    settling.show_form(released=True)
    assert settling.release["is_shown"] and day.exact == b"released"
    settling.show_form(released=False)
    assert not settling.release["is_shown"] and day.exact == b"exact"
    settling.show_form(released=True)
    day.edit()
    assert settling.release is None and day.exact is None
    settling.show_form(released=True)
    assert day.exact is None


def test_a_release_that_fails_leaves_the_exact_shape(day: Day) -> None:
    settled(day)
    order, settling = day.child.orders[-1], day.studio.settling
    settling._message(day.child, StudioProblem(order.job, "error", "singular"))  # type: ignore[arg-type]
    assert settling.release is None and day.said[1] == "Exact, mesh error 0.7 %"
    settling._died(day.child)  # type: ignore[arg-type]
    settling.show_form(released=True)
    assert day.exact == b"exact" and day.said[0] == "exact"


def test_another_target_shows_the_form_of_the_release_again(day: Day) -> None:
    settled(day)
    settling, order = day.studio.settling, day.child.orders[-1]
    settling._message(day.child, Released(order.job, False, replace(exact(7), shape=b"released")))  # type: ignore[arg-type]
    settling.show_form(released=True)
    settling.show_again()
    day.settle()
    assert day.exact == b"released"
    again = replace(exact(8), shape=b"released again")
    settling._message(day.child, Released(day.child.orders[-1].job, False, again))  # type: ignore[arg-type]
    assert day.exact == b"released again"


def test_no_exact_shape_of_another_design_is_ever_shown_as_the_present_one(day: Day) -> None:
    random, exacts = np.random.default_rng(5), 0
    of_order: dict[int, dict[str, Any]] = {}
    acts: list[Callable[[], None]] = [
        lambda: day.edit(round(float(random.uniform(0.2, 1.0)), 2)),
        lambda: (day.document.undo(), day.studio.engine.show(day.document, is_opened=True)),  # type: ignore[func-returns-value]
        lambda: day.preview(),
        lambda: day.engine.frame("linear"),
        lambda: day.engine.frame(),
        lambda: day.engine.frame(seq=day.engine.asked - 1),
        lambda: day.preview(seconds=float(random.choice([2.0, 60.0]))),
        lambda: day.engine.fail(),
        lambda: day.studio.settling.stop(),
        lambda: day.studio.settling.begin(),
        lambda: day.studio.settling.show_form(bool(random.integers(2))),
    ]
    for _ in range(1500):
        orders = [order for order in day.child.orders if order is not None]
        of_order |= {order.job: order.table for order in orders}
        if orders and random.random() < 0.4:  # the process answers, maybe to an order that was called off
            job = int(random.choice([order.job for order in orders[-3:]]))
            before = day.exact
            day.studio.settling._message(day.child, exact(job))  # type: ignore[arg-type]
            if random.random() < 0.5:  # and its release does
                day.studio.settling._message(day.child, Released(job, False, exact(job)))  # type: ignore[arg-type]
            if before is None and day.exact is not None:
                assert of_order[job] == day.document.table
                exacts += 1
        else:
            acts[int(random.integers(len(acts)))]()
        kind, _, is_stale = day.said
        if kind == "exact":
            assert not is_stale and day.studio.shown.revision == day.document.revision
            assert day.exact is not None
        else:
            assert day.exact is None
    assert exacts > 20
