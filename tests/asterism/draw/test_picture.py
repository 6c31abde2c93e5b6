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

from asterism import Shape, write_results
from asterism.draw import fonts
from asterism.draw.picture import (
    FIRST_RARE_LETTER,
    PICTURE_HEIGHT_PX,
    PICTURE_WIDTH_PX,
    caption,
    draw_shape,
    fitting_scale,
    usual_font,
    view_image,
)
from asterism.draw.render import FABRIC_SIDE, OUTLINE_COLOUR, PLASTIC_SIDE, SUPERSAMPLING, render
from asterism.draw.scene import View, camera, scene
from asterism.shape.release_picture import FRAMES, released
from tests.asterism.commands import Cli
from tests.asterism.sheets import dome, flat, sheet, tube


def image_of(shape: Shape, title: str = "sheet") -> np.ndarray:
    stream = io.BytesIO()
    draw_shape(shape, title, stream)
    return np.asarray(Image.open(io.BytesIO(stream.getvalue())).convert("RGB"), dtype=float) / 255


@pytest.fixture
def fine(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where pixels are measured, they are as fine as anywhere else."""
    monkeypatch.setattr("asterism.draw.render.SUPERSAMPLING", SUPERSAMPLING)


@pytest.mark.slow
@pytest.mark.parametrize("place", [flat, tube])
def test_every_shape_gives_a_full_picture_on_white(place) -> None:  # type: ignore[no-untyped-def]
    shape = sheet(place, edge=4.0)
    image = image_of(shape)
    assert np.array_equal(image, image_of(shape)) and image.shape == (PICTURE_HEIGHT_PX, PICTURE_WIDTH_PX, 3)
    assert np.allclose(image[[0, -1]], 1) and np.allclose(image[:, [0, -1]], 1)
    assert (image[:, :1240] < 0.99).any(axis=-1).mean() > 0.1
    assert (image[:, 1240:] < 0.99).any(axis=-1).mean() > 0.1


@pytest.mark.usefixtures("fine")
def test_views_are_to_scale_and_each_side_has_its_colour() -> None:
    shape = replace(sheet(flat, edge=5.0), rods=(), rod_fields={})
    for elevation, colour in ((90.0, PLASTIC_SIDE), (-90.0, FABRIC_SIDE)):
        image = render(scene(shape), camera(-90, elevation, np.zeros(3)), pixels_per_mm=4.0)
        opaque = image[..., 3] > 0.5
        assert opaque.any(axis=0).sum() == pytest.approx(400, abs=3)
        assert opaque.any(axis=1).sum() == pytest.approx(320, abs=3)
        row = image[image.shape[0] // 2]
        # two of the four rendered pixels at the edge are its outline, and the others are clear
        assert np.allclose(row[np.flatnonzero(row[:, 3])[0]], [*OUTLINE_COLOUR, 0.5])
        middle = row[len(row) // 2, :3]
        assert np.allclose(middle / middle.max(), np.array(colour) / max(colour), atol=0.03)


@pytest.mark.slow
@pytest.mark.usefixtures("fine")
def test_arms_are_seen_from_the_plastic_side_only_at_their_width() -> None:
    shape = sheet(flat, edge=1.0)
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
def test_a_held_sheet_keeps_z_upwards() -> None:
    tilted = sheet(lambda p: np.column_stack([p[:, 0], p[:, 1] * 0.8, p[:, 1] * 0.6]), edge=5.0)
    level = replace(tilted, positions=tilted.positions @ np.array([[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]]))
    free = image_of(tilted)
    assert not np.array_equal(image_of(replace(tilted, held=True)), free)
    # on its principal axes this one lies level
    assert np.abs(image_of(replace(level, held=True)) - free).mean() < 1e-3


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"stars_up": 29, "stars_total": 30}, "29 of 30 stars up, energy 1836 N mm, certified minimum"),
        ({"is_minimum": False, "energy_n_mm": 5.9e-14}, "energy 0 N mm, not certified"),
        ({"model": "preview", "expected_rms_percent": None}, "preview, without an error estimate"),
        (
            {"model": "preview", "expected_rms_percent": 2.0, "diameter_mm": 150.0},
            "preview, estimated error 2.0 % of the diameter of 150.0 mm: 3.0 mm",
        ),
        ({"model": "preview", "expected_rms_percent": 1.234, "converged": False}, "preview, not certified"),
    ],
)
def test_the_caption_says_what_is_known(said: dict[str, Any], words: str) -> None:
    shape = sheet(dome, edge=5.0)
    assert "certified" not in caption(shape)
    known = {"energy_n_mm": 1835.7, "converged": True, "is_minimum": True} | said
    text = caption(replace(shape, summary=known)).replace("   ·   ", ", ")
    assert text.endswith(words) and ("minimum" in text) == (words.endswith("certified minimum"))


@pytest.mark.slow
def test_names_are_printed_as_they_are_and_stay_on_the_picture() -> None:
    """Dollar signs and all: no mathematics."""
    plate = sheet(flat, edge=10.0)
    image_of(plate, title=r"$\frac{ été #1 %s")
    ends = []
    for title in ("mmm", "$mmm$"):
        dark = image_of(plate, title=title)[20:80].min(axis=2) < 0.5
        ends.append(np.flatnonzero(dark.any(axis=0)).max())
    assert ends[1] > ends[0] + 20
    assert np.allclose(image_of(plate, title="long name " * 20)[:, -20:], 1)


@pytest.mark.slow
def test_no_display_and_no_shared_state() -> None:
    program = (
        "import io, sys\n"
        "from asterism.draw.picture import draw_shape\n"
        "from tests.asterism.sheets import dome, sheet\n"
        "draw_shape(sheet(dome, edge=10.0), 'dome', io.BytesIO())\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    run = subprocess.run([sys.executable, "-c", program], cwd=Path(__file__).parents[3], capture_output=True, text=True)
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")


def test_no_letter_is_a_box(monkeypatch: pytest.MonkeyPatch) -> None:
    # with the usual font only
    monkeypatch.setattr(fonts, "OTHER_FAMILIES", ())
    for name in ("families", "_letters"):
        monkeypatch.setattr(fonts, name, getattr(fonts, name).__wrapped__)
    assert fonts.printable("\u661f\u5f62 7") == "<U+661F><U+5F62> 7"
    assert [run for _, run in fonts.font_runs("\u661f 7", bold=True)] == ["<U+661F> 7"]
    draw_shape(sheet(dome, edge=8.0), "\u661f", io.BytesIO())


@pytest.mark.parametrize("bold", [False, True])
def test_letters_of_european_languages_are_in_the_usual_font(bold: bool) -> None:
    """So that pictures need not read fonts to know."""
    letters = "".join(filter(str.isprintable, map(chr, range(FIRST_RARE_LETTER))))
    assert fonts.font_runs(letters, bold) == [(usual_font(bold), letters)] and fonts.printable(letters) == letters


PIXELS = (400, 300)


@pytest.fixture
def shape() -> Shape:
    return replace(sheet(dome, 100.0, 80.0, 5.0), held=True)


def ink(image: Image.Image) -> np.ndarray:
    """(2,) pixels, width and height of what is drawn."""
    rows, columns = np.nonzero(np.asarray(image.convert("L")) < 250)
    return np.array([np.ptp(columns), np.ptp(rows)])


@pytest.mark.parametrize(("view", "axes"), [("above", (0, 1)), ("front", (0, 2)), ("side", (1, 2))])
def test_drawings_have_the_scale(shape: Shape, view: View, axes: tuple[int, int]) -> None:
    sizes = np.ptp(shape.positions, axis=0)[list(axes)]
    image = view_image(shape, view, PIXELS, 2.5, plain=True)
    assert image.size == PIXELS
    assert ink(image) == pytest.approx(2.5 * sizes, abs=8)
    fitted = view_image(shape, view, PIXELS, plain=True)
    assert fitting_scale([shape], view, PIXELS, plain=True) > 2.5
    assert (ink(fitted) <= PIXELS).all() and (ink(fitted) >= 0.85 * np.array(PIXELS)).any()


def test_a_large_sheet_is_cut_off_and_only_a_plain_picture_has_no_words(shape: Shape) -> None:
    image = view_image(shape, "above", PIXELS, 10.0, plain=True)
    assert image.size == PIXELS and (ink(image) == np.array(PIXELS) - 1).all()
    assert ink(view_image(shape, "above", PIXELS, 1.0, plain=True))[1] < 100
    assert ink(view_image(shape, "above", PIXELS, 1.0, title="dome"))[1] > 200


def test_shapes_show_themselves_in_notebooks(shape: Shape) -> None:
    data = shape._repr_png_()
    assert Image.open(io.BytesIO(data)).size == (2000, 1120)
    assert shape.picture("front", PIXELS, plain=True).size == PIXELS


def test_results_are_drawn_at_one_scale(shape: Shape, here: Path, cli: Cli) -> None:
    half = replace(shape, printed=shape.printed / 2, positions=shape.positions / 2)
    for name, one in {"large": shape, "small": half}.items():
        write_results(replace(one, summary={"design": {"name": name, "pins": [{}]}}), here / name)
    assert cli(["picture", "large", "small", "--view", "above", "--size", "400x300", "--plain"]).done
    sizes = [ink(Image.open(here / f"{name}-above.png")) for name in ("large", "small")]
    assert sizes[0] == pytest.approx(2.0 * sizes[1], abs=8)
    for words, said in (
        (["nothing"], "nothing"),
        (["large", "--size", "wide"], "--size"),
        (["large", "--size", "10x10"], "--size"),
        (["large", "--scale", "0"], "--scale"),
        (["large", "large/shape.vtu", "small/shape.vtu", "-o", "."], "--output"),
    ):
        assert said in cli(["picture", *words]).refusal, words


def test_a_release_leads_from_the_print_to_the_shape_without_stretching_more_than_both(shape: Shape) -> None:
    edges = shape.triangles[:, [0, 1]]
    lengths = np.array([np.linalg.norm(np.diff(at[edges], axis=1)[:, 0], axis=1) for at in released(shape, 5)])
    print_lengths = np.linalg.norm(np.diff(shape.printed[edges], axis=1)[:, 0], axis=1)
    assert lengths[0] == pytest.approx(print_lengths, rel=1e-6)
    *_, last = released(shape, 5)
    assert last == pytest.approx(shape.positions, abs=1e-4)
    ends = lengths[[0, -1]]
    assert (lengths > 0.98 * ends.min(axis=0)).all() and (lengths < 1.02 * ends.max(axis=0)).all()


def test_the_command_writes_an_animated_release(shape: Shape, here: Path, cli: Cli) -> None:
    write_results(replace(shape, summary={"design": {"name": "dome", "pins": [{}]}}), here / "dome")
    words = ["picture", "dome", "--release", "--size", "200x150", "--plain"]
    assert cli(words).done
    with Image.open("dome-release.gif") as image:
        assert image.n_frames == FRAMES and image.size == (200, 150)
    assert "--scale" in cli([*words, "--scale", "2"]).refusal
