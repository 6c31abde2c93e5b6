"""Pictures are made without a display, to scale, and show the side that is seen."""

from __future__ import annotations

import io
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from asterism.draw.picture import PICTURE_HEIGHT_PX, PICTURE_WIDTH_PX, caption, draw_shape
from asterism.draw.render import camera, render, scene
from asterism.draw.shading import FABRIC_SIDE, PLASTIC_SIDE
from asterism.shape.shape import Shape
from tests.asterism import sheets


def image_of(shape: Shape, title: str = "sheet") -> np.ndarray:
    stream = io.BytesIO()
    draw_shape(shape, title, stream)
    return np.asarray(Image.open(io.BytesIO(stream.getvalue())).convert("RGB"), dtype=float) / 255


@pytest.fixture
def rough_pictures() -> None:
    """Here they are as fine as anywhere else."""


@pytest.fixture
def rough(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where pictures are only compared with each other, or words are looked at."""
    monkeypatch.setattr("asterism.draw.render.SUPERSAMPLING", 1)


@pytest.mark.slow
@pytest.mark.usefixtures("rough")
@pytest.mark.parametrize("place", [sheets.flat, sheets.dome, sheets.tube, sheets.saddle])
def test_every_shape_gives_a_full_picture_on_white(place) -> None:  # type: ignore[no-untyped-def]
    image = image_of(sheets.sheet(place, edge=4.0))
    assert image.shape == (PICTURE_HEIGHT_PX, PICTURE_WIDTH_PX, 3)
    assert np.allclose(image[[0, -1]], 1) and np.allclose(image[:, [0, -1]], 1)
    assert (image[:, :1240] < 0.99).any(axis=-1).mean() > 0.1
    assert (image[:, 1240:] < 0.99).any(axis=-1).mean() > 0.1


@pytest.mark.slow
def test_a_flat_sheet_is_a_line_from_the_side() -> None:
    """A straight row of ink above its words, as wide as the sheet seen from above."""
    ink = image_of(sheets.sheet(sheets.flat, edge=4.0)).min(axis=2)[:, 1260:] < 0.6
    rows = np.flatnonzero(ink.any(axis=1))
    side = [row for row in rows if np.diff(np.flatnonzero(np.diff(np.r_[0, ink[row], 0]))).max() > 300]
    lowest = max(side)
    above = ink[[row for row in side if row < lowest - 20]]
    assert np.ptp(np.flatnonzero(ink[lowest])) == pytest.approx(np.ptp(np.flatnonzero(above.any(axis=0))), abs=4)


@pytest.mark.slow
@pytest.mark.usefixtures("rough")
def test_pictures_do_not_change_from_run_to_run() -> None:
    shape = sheets.sheet(sheets.dome, edge=5.0)
    assert np.array_equal(image_of(shape), image_of(shape))


def test_views_are_to_scale() -> None:
    shape = replace(sheets.sheet(sheets.flat, edge=5.0), rods=(), rod_fields={})
    image = render(scene(shape), camera(-90, 90, np.zeros(3)), pixels_per_mm=4.0)
    opaque = image[..., 3] > 0.5
    assert opaque.any(axis=0).sum() == pytest.approx(400, abs=3)
    assert opaque.any(axis=1).sum() == pytest.approx(320, abs=3)


def test_each_side_has_its_colour() -> None:
    shape = replace(sheets.sheet(sheets.flat, edge=5.0), rods=(), rod_fields={})
    for elevation, colour in ((90.0, PLASTIC_SIDE), (-90.0, FABRIC_SIDE)):
        image = render(scene(shape), camera(-90, elevation, np.zeros(3)), pixels_per_mm=2.0)
        middle = image[image.shape[0] // 2, image.shape[1] // 2, :3]
        assert np.allclose(middle / middle.max(), np.array(colour) / max(colour), atol=0.03)


@pytest.mark.slow
def test_arms_are_seen_from_the_plastic_side_only_at_their_width() -> None:
    shape = sheets.sheet(sheets.flat, edge=1.0)
    row = np.abs(shape.printed[:, 1] - shape.printed[np.linalg.norm(shape.printed, axis=1).argmin(), 1]) < 1e-9
    arm = np.flatnonzero(row & (np.abs(shape.printed[:, 0]) < 20))
    arm = arm[np.argsort(shape.printed[arm, 0])]
    shape = replace(shape, rods=(arm,), rod_fields={"width_mm": np.full(len(arm) - 1, 3.0)})
    length = np.ptp(shape.printed[arm, 0])
    dark = []
    for elevation in (90.0, -90.0):
        image = render(scene(shape), camera(-90, elevation, np.zeros(3)), pixels_per_mm=6.0)
        inside = image[20:-20, 20:-20]
        dark.append(float((inside[..., :3].max(axis=-1) < 0.35).sum()) / 36)
    assert dark[0] == pytest.approx(3.0 * length, rel=0.03)
    assert dark[1] == 0


@pytest.mark.slow
@pytest.mark.usefixtures("rough")
def test_a_held_sheet_keeps_z_upwards() -> None:
    tilted = sheets.sheet(lambda p: np.column_stack([p[:, 0], p[:, 1] * 0.8, p[:, 1] * 0.6]), edge=5.0)
    level = replace(tilted, positions=tilted.positions @ np.array([[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]]))
    free = image_of(tilted)
    assert not np.array_equal(image_of(replace(tilted, held=True)), free)
    # on its principal axes this one lies level
    assert np.abs(image_of(replace(level, held=True)) - free).mean() < 1e-3


def test_the_caption_says_what_is_known() -> None:
    shape = sheets.sheet(sheets.dome, edge=5.0)
    assert "certified" not in caption(shape)
    known = {"energy_n_mm": 1835.7, "converged": True, "is_minimum": True, "stars_up": 29, "stars_total": 30}
    text = caption(replace(shape, summary=known))
    assert "29 of 30 stars up" in text and "energy 1836 N mm" in text and text.endswith("certified minimum")
    assert caption(replace(shape, summary=known | {"is_minimum": False})).endswith("not certified")
    assert "energy 0 N mm" in caption(replace(shape, summary=known | {"energy_n_mm": 5.9e-14}))


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"expected_rms_percent": 1.234}, "preview, estimated error 1.2 % of the diameter"),
        (
            {"expected_rms_percent": 2.0, "diameter_mm": 150.0},
            "preview, estimated error 2.0 % of the diameter of 150.0 mm: 3.0 mm",
        ),
        ({"expected_rms_percent": None}, "preview, without an error estimate"),
        ({"expected_rms_percent": 1.234, "converged": False}, "preview, not certified"),
    ],
)
def test_the_caption_of_a_preview_says_that_it_is_one(said: dict[str, Any], words: str) -> None:
    summary = {"model": "preview", "converged": True, "is_minimum": True, "energy_n_mm": 30.0} | said
    shape = replace(sheets.sheet(sheets.dome, edge=5.0), summary=summary)
    assert caption(shape).endswith(words) and "minimum" not in caption(shape)


@pytest.mark.slow
@pytest.mark.usefixtures("rough")
def test_names_are_printed_as_they_are() -> None:
    """Dollar signs and all: no mathematics."""
    sheet = sheets.sheet(sheets.flat, edge=10.0)
    image_of(sheet, title=r"$\frac{ été #1 %s")
    ends = []
    for title in ("mmm", "$mmm$"):
        ink = image_of(sheet, title=title)[20:80].min(axis=2) < 0.5
        ends.append(np.flatnonzero(ink.any(axis=0)).max())
    assert ends[1] > ends[0] + 20


@pytest.mark.usefixtures("rough")
def test_long_names_stay_on_the_picture() -> None:
    assert np.allclose(image_of(sheets.sheet(sheets.flat, edge=10.0), title="long name " * 20)[:, -20:], 1)


@pytest.mark.slow
def test_no_display_and_no_shared_state() -> None:
    program = (
        "import io, sys\n"
        "from asterism.draw.picture import draw_shape\n"
        "from tests.asterism import sheets\n"
        "draw_shape(sheets.sheet(sheets.dome, edge=10.0), 'dome', io.BytesIO())\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    root = Path(__file__).parents[3]
    run = subprocess.run([sys.executable, "-c", program], cwd=root, capture_output=True, text=True)
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")
