"""Of two exact shapes one counts, and a preview is of its form or of another one; the progress of both."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import asterism
from asterism.equilibrium.newton.minimise import Iteration
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.planar import inside
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.reports.plots import profile_cut
from asterism.verification.verify import (
    MAX_FORM_DISTANCE_PERCENT,
    MAX_LIKE_AXIS_DEG,
    MAX_LIKE_DISTANCE_PERCENT,
    MAX_LIKE_NORMALS_DEG,
    STAGES,
    WHOLE,
    ExactProgress,
    _same_stars_down,
    alike,
    right_shape,
    same_branch,
    verify,
)


def shape(energy: float, off: tuple[int, ...] = (), minimum: bool = True, **more: Any) -> Any:
    summary = {"energy_n_mm": energy, "stars_off_branch": list(off), "is_minimum": minimum}
    return SimpleNamespace(summary=summary | more)


@pytest.mark.parametrize(
    ("release", "preview", "counts"),
    [
        (shape(10.0), shape(9.9), "preview"),
        (shape(10.0), shape(9.9, off=(3,)), "release"),
        (shape(10.0, minimum=False), shape(11.0, off=(3,)), "preview"),
        (shape(10.0), shape(10.0 - 1e-8), "release"),  # the same minimum but for rounding
        (shape(-10.0), shape(-10.1), "preview"),
    ],
)
def test_certified_ones_first_then_sides_then_energy(release: Any, preview: Any, counts: str) -> None:
    assert right_shape({"release": release, "preview": preview}) == counts


def test_starts_agree_only_on_images_of_each_other() -> None:
    """A star that is down in the middle is not one that is down at a corner; two corners are the same."""
    hexagon = Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 1}})
    plan = layout(hexagon)
    same, radius = symmetries(hexagon, plan), np.linalg.norm(plan.centres, axis=1)
    middle, corners = int(radius.argmin()), np.flatnonzero(radius > 1.0)

    def down(*stars: int) -> Any:
        return shape(1.0, stars_down=[int(star) for star in stars], stars_total=7)

    def agree(*pair: Any) -> bool:
        return _same_stars_down(*pair, plan, same)

    assert agree(down(), down()) and agree(down(corners[0]), down(corners[2]))
    assert not agree(down(middle), down(corners[0])) and not agree(down(), down(corners[0]))


def test_profiles_of_an_l_stay_on_the_sheet() -> None:
    """The middle of its stars is off the sheet."""
    legs = [[-60, -60], [60, -60], [60, -32], [-32, -32], [-32, 60], [-60, 60]]
    border = {"polygon_mm": legs, "star_margin_mm": 3}
    plan = layout(Design.from_dict({"stars": {"length_mm": 8.0}, "border": border}))
    assert not inside(plan.centres.mean(axis=0)[None], plan.outline)[0]
    seen: list[np.ndarray] = []
    sheet = SimpleNamespace(at=seen.append)
    for direction in np.eye(2):
        profile_cut(SimpleNamespace(layout=plan, reference=sheet, other=sheet), direction)  # type: ignore[arg-type]
    assert len(seen) == 4 and all(inside(points, plan.outline).all() for points in seen)
    assert all(np.ptp(points, axis=0).max() > 25.0 for points in seen)


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


STEP = Iteration(0, 0.0, 0.0, 0.0, 0.0)


def test_release_and_meshes_share_the_steps() -> None:
    told: list[int] = []
    progress = ExactProgress("exact", lambda stage, done, of: told.append(done))
    for text in (
        "300 vertices, 20 %",
        "300 vertices, 100 %",
        "300 vertices, equilibrium",
        "1000 vertices, equilibrium",
    ):
        progress.report(text, STEP)
    progress.report("300 vertices, 40 %, to the side", STEP)
    progress.report("4000 vertices, equilibrium", STEP)
    progress.finish()
    assert told == sorted(told) and told[0] == 0 and told[-1] == WHOLE and max(told[:-1]) < WHOLE
    assert told[1] == 10 and told[2] == 50 and 50 < told[3] < told[4] < told[6]


@pytest.mark.slow
@pytest.mark.parametrize("edge_mm", [6.0])
def test_a_ready_preview_is_not_made_again(edge_mm: float, monkeypatch: pytest.MonkeyPatch) -> None:
    data = asterism.new("dome").to_dict() | {"border": {"rings": 1}, "mesh": {"edge_mm": edge_mm}}
    design = Design.from_dict(data)
    ready = asterism.preview(design)
    monkeypatch.setattr("asterism.verification.verify.preview", lambda *_, **__: pytest.fail("made again"))
    told: list[tuple[str, int, int]] = []
    found = verify(design, ready=ready, progress=lambda *step: told.append(step))
    assert found.preview is ready and found.summary["preview_s"] == ready.summary["wall_s"]
    assert list(dict.fromkeys(stage for stage, _, _ in told)) == list(STAGES)
    assert all(told[-1][1:] == (1, 1) for _ in STAGES)
