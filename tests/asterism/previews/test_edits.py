"""Edits that are broken off, dragged on, stopped, overtaken or undone; moved pins, snapshots, forms that were met."""

from __future__ import annotations

import copy
import itertools
import pickle
from functools import partial
from typing import Any

import numpy as np
import pytest

import asterism.previews.solve as solve_module
from asterism.equilibrium.errors import Error
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.previews.session import Preview, SearchLimitError
from tests.asterism.previews import designs

edited = partial(designs.edited, mesh={"edge_mm": 4.0})


def break_off_while_it_settles(preview: Preview, design: Design, monkeypatch: pytest.MonkeyPatch) -> None:
    """The factor then is of some state on the way."""

    def interrupted(shell: Any, x: Any, factor: Any, *_: Any) -> None:
        factor.factorise(2.0 * shell.hessian(x))
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(solve_module, "follow", interrupted)
        with pytest.raises(KeyboardInterrupt):
            preview.update(design)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "key", "ends"), [("dome", "length_mm", (9.0, 7.0)), ("tube", "thickness_mm", (0.4, 0.5))]
)
def test_who_drags_through_linear_responses_sees_a_sheet(name: str, key: str, ends: tuple[float, float]) -> None:
    """Each starts from the last equilibrium, not from the last response."""
    preview = Preview(edited(name))
    size = preview.shell.extent
    for value in np.linspace(*ends, 9):
        stage = next(preview.edit(edited(name, stars={key: float(value)})))
        assert stage.name == "linear" and np.ptp(stage.x, axis=0).max() < 1.5 * size
        assert not preview.equilibrium.is_minimum or value == ends[0]
    # the last of them is that of a single edit
    once = next(Preview(edited(name)).edit(edited(name, stars={key: ends[1]})))
    assert stage.x == pytest.approx(once.x, abs=1e-9 * size)
    final = preview.update(edited(name, stars={key: ends[1]}))
    assert final.summary["is_minimum"]


def test_an_edit_after_one_that_was_broken_off_while_it_settled(monkeypatch: pytest.MonkeyPatch) -> None:
    preview, other = Preview(edited("dome")), edited("dome", stars={"thickness_mm": 0.33})

    break_off_while_it_settles(preview, other, monkeypatch)
    assert not preview.equilibrium.is_minimum and preview.shape().summary["warnings"]
    linear, _ = preview.edit(edited("dome", stars={"thickness_mm": 0.32}))
    once = next(Preview(edited("dome")).edit(edited("dome", stars={"thickness_mm": 0.32})))
    # with the stiffness of the sheet as it was being edited: nearly the same
    assert np.abs(linear.x - once.x).max() < 0.02 * preview.shell.extent
    assert preview.equilibrium.is_minimum


def test_an_edit_that_was_overtaken_says_so_and_one_that_is_refused_overtakes_none() -> None:
    preview = Preview(edited("dome"))
    pending = preview.edit(edited("dome", stars={"thickness_mm": 0.33}))
    next(pending)
    with pytest.raises(DesignError):
        preview.update(edited("dome", border={"rings": 2}, pins=[{"edges": [0]}, {"edges": [1], "scale": 0.5}]))
    assert next(pending).name == "equilibrium" and preview.equilibrium.is_minimum
    first = preview.edit(edited("dome", stars={"length_mm": 7.0}))
    next(first)
    preview.update(edited("dome", border={"rings": 2}))
    with pytest.raises(RuntimeError, match="overtaken"):
        next(first)
    assert preview.equilibrium.is_minimum and len(preview.sheet.layout.centres) == 19


def test_stages_and_snapshots_are_the_callers_own_and_a_preview_is_not_copied() -> None:
    """A copy would share the shell that edits change."""
    preview = Preview(edited("dome"))
    snapshot = preview.snapshot()
    with pytest.raises(ValueError, match="read-only"):
        snapshot.x[0] = 0.0
    before = snapshot.x.copy()
    for stage in preview.edit(edited("dome", stars={"thickness_mm": 0.32})):
        assert (snapshot.x == before).all()
        height = np.ptp(preview.equilibrium.x[:, 2])
        stage.x[:] *= 1.5
        assert np.ptp(preview.equilibrium.x[:, 2]) == height
        assert stage.name != "linear" or (preview.snapshot().x == before).all()
    for copied in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="cannot be copied or pickled"):
            copied(preview)


@pytest.mark.parametrize(("name", "said"), [("tube", True), ("dome", False)])
def test_free_sheets_say_that_an_edit_keeps_their_form(name: str, said: bool) -> None:
    """They may have lower ones, which only starts meet."""
    preview = Preview(edited(name))
    told = [
        any("start a new preview" in line for line in shape.summary["warnings"])
        for shape in (preview.shape(), preview.update(edited(name, stars={"thickness_mm": 0.42})))
    ]
    assert told == [False, said]


@pytest.mark.slow
def test_pins_on_arms_go_with_them() -> None:
    """A pin beside a tip is on it; where the arm becomes shorter it is beside again."""
    pins = [{"points_mm": [[0.0, -9.8], [-20.0, -15.0], [20.0, -15.0]]}]
    longer, shorter = (edited("tube", border={"rings": 2}, pins=pins, stars={"length_mm": mm}) for mm in (10.0, 8.0))
    preview = Preview(longer)
    shape = preview.update(shorter)
    assert shape.at([[0.0, -9.8]])[0] == pytest.approx([0.0, -9.8, 0.0], abs=1e-6)
    assert preview.equilibrium.energy == pytest.approx(Preview(shorter).equilibrium.energy, rel=1e-6)
    preview.flip()


def test_softness_is_that_of_the_sheet_after_an_edit_without_change_was_broken_off(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    preview = Preview(edited("dome"))
    before = preview.shape().summary["soft_modes_n_mm3"]

    break_off_while_it_settles(preview, edited("dome"), monkeypatch)
    assert preview.equilibrium.is_minimum
    assert preview.shape().summary["soft_modes_n_mm3"] == pytest.approx(before, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        {"border": {"polygon_mm": [[62, 30], [0, 66], [-60, 35], [-55, -38], [0, -68], [60, -33]]}},
        {"pins": [{"edges": [0, 1, 3, 4], "scale": 0.74}]},
    ],
    ids=["drawn", "fewer pins"],
)
def test_another_outline_can_keep_the_form(change: dict[str, Any]) -> None:
    design, preview = Design.from_dict(edited("dome").to_dict() | change), Preview(edited("dome"))
    (stage,) = preview.edit(design, keep_form=True)
    assert stage.name == "equilibrium" and preview.equilibrium.is_minimum and preview.equilibrium.guess == "form"
    assert preview.equilibrium.energy == pytest.approx(Preview(design).equilibrium.energy, rel=1e-6)


def test_a_much_larger_sheet_starts_anew_though_its_form_is_to_be_kept() -> None:
    preview = Preview(edited("dome", border={"rings": 1}))
    preview_stages = list(preview.edit(edited("dome", border={"rings": 3}), keep_form=True))
    assert len(preview_stages) == 1 and preview.equilibrium.guess != "form" and preview.equilibrium.is_minimum


def test_a_kept_form_can_be_searched_again() -> None:
    preview, smaller = Preview(edited("dome")), edited("dome", border={"rings": 2})
    list(preview.edit(smaller, keep_form=True))
    assert preview.equilibrium.guess == "form"
    assert preview.search_again().name == "equilibrium" and preview.equilibrium.guess != "form"
    assert np.array_equal(preview.equilibrium.x, Preview(smaller).equilibrium.x)


POINTS = [[-48.0, -30.0], [48.0, -30.0], [48.0, 30.0], [-48.0, 30.0]]


def needles(*heights: float, **stars: Any) -> Design:
    target = [[0.8 * x, 0.8 * y, z] for (x, y), z in zip(POINTS, heights, strict=True)]
    return edited("dome", pins=[{"points_mm": POINTS, "target_mm": target}], stars=stars)


HEAVY = {"fabric": {"modulus_mpa": 0.005}, "gravity": {"on": True}}
ON_CORNERS = {"pins": [{"where": "corners", "scale": 0.85}], "border": {"rectangle_mm": [80.0, 80.0], "rings": None}}


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (edited("dome"), edited("dome", stars={"thickness_mm": 0.32, "override": [{"star": 0, "remove": True}]})),
        (edited("dome"), edited("dome", pins=[{"where": "border", "scale": 0.76}])),
        (needles(0.0, 0.0, 0.0, 0.0), needles(-5.0, 12.0, 0.0, 3.0, thickness_mm=0.33)),
        (edited("dome", **HEAVY), edited("dome", **HEAVY, plastic={"density_kg_m3": 20000.0})),
        # the exact model's mesh, on which the softness at points depends
        (edited("dome", **ON_CORNERS), edited("dome", **ON_CORNERS | {"mesh": {"edge_mm": 1.0}})),
    ],
    ids=["stars", "scale", "far, and other stars", "weight", "mesh"],
)
def test_an_edit_leads_to_the_equilibrium_of_a_new_preview(first: Design, second: Design) -> None:
    preview = Preview(first)
    before = preview.equilibrium.energy
    stages = list(preview.edit(second))
    assert [stage.name for stage in stages] == ["linear", "equilibrium"]
    fresh = Preview(second)
    assert preview.equilibrium.is_minimum and preview.equilibrium.guess == "edit"
    assert preview.shell.loads.sum(axis=0) == pytest.approx(fresh.shell.loads.sum(axis=0))
    assert preview.equilibrium.energy == pytest.approx(fresh.equilibrium.energy, rel=1e-8)
    assert abs(preview.equilibrium.energy - before) > 1e-3 * abs(before)
    assert stages[1].x == pytest.approx(fresh.equilibrium.x, abs=1e-5 * preview.shell.extent)


def test_the_linear_response_is_right_to_first_order() -> None:
    """A tenth of the move leaves a hundredth of the error."""
    start = needles(0.0, 0.0, 0.0, 0.0)
    errors = []
    for move in (2.0, 0.2):
        preview = Preview(start)
        linear, final = preview.edit(needles(0.0, move, 0.0, 0.0))
        held = preview.at(np.array(POINTS), linear.x).smooth
        assert held[:, 2] == pytest.approx([0.0, move, 0.0, 0.0], abs=1e-9)
        nodes = preview.shell.node_positions
        errors.append(np.abs(nodes(linear.x) - nodes(final.x)).max())
    assert errors[0] < 0.2 and errors[1] < 0.02 * errors[0]
    # pins at other points start anew
    assert [stage.name for stage in preview.edit(edited("dome", pins=[{"points_mm": POINTS[:3]}]))] == ["equilibrium"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "change"), [("tube", {"stars": {"thickness_mm": 0.42}}), ("dome", {"border": {"rings": 2}})]
)
def test_a_preview_goes_back_to_a_snapshot(name: str, change: dict[str, Any]) -> None:
    start = edited(name)
    preview = Preview(start)
    shape, snapshot = preview.shape(), pickle.loads(pickle.dumps(preview.snapshot()))
    preview.update(edited(name, **change))
    assert preview.restore(snapshot).name == "equilibrium"
    assert preview.design == start and preview.equilibrium.is_minimum
    assert preview.shape().positions == pytest.approx(shape.positions, abs=1e-6)
    other = Preview(edited(name, **change))
    other.restore(snapshot)
    assert other.shape().height_mm == pytest.approx(shape.height_mm, rel=1e-8)


@pytest.mark.slow
def test_snapshots_of_other_meshes_are_refused() -> None:
    fine, coarse = Preview(edited("dome"), triangles=150), Preview(edited("dome"), triangles=60)
    before = coarse.state
    with pytest.raises(Error, match="another mesh"):
        coarse.restore(fine.snapshot())
    assert coarse.state is before
    with pytest.raises(TypeError):
        coarse.restore(before)  # type: ignore[arg-type]


@pytest.mark.slow
def test_other_forms_are_shown_and_left_again() -> None:
    """A snapshot of the design keeps them, one of another design has none."""
    start = gallery.load("fig8-l-increasing")
    preview, other = Preview(start), Preview(designs.edited("fig8-l-increasing", stars={"thickness_mm": 0.42}))
    preview.restore(preview.snapshot())
    forms = preview.forms
    assert len(forms) == 1
    for number in (-1, 1, 0.5, True):
        with pytest.raises(ValueError, match="number"):
            preview.show_form(number)  # type: ignore[arg-type]
    first, energy = preview.equilibrium.energy, forms[0].energy_n_mm
    preview.show_form(0)
    assert preview.equilibrium.energy == pytest.approx(energy, rel=1e-6) and preview.equilibrium.is_minimum
    back = [number for number, form in enumerate(preview.forms) if np.isclose(form.energy_n_mm, first, rtol=1e-6)]
    preview.show_form(back[0])
    assert preview.equilibrium.energy == pytest.approx(first, rel=1e-6)
    preview.restore(other.snapshot())
    assert not preview.forms


dome = partial(designs.edited, "dome")


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
