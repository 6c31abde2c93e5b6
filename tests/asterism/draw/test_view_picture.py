"""One view of a sheet: the scale is the one asked for, and one scale for several sheets."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from asterism.draw.picture import fitting_scale, view_image
from asterism.draw.render import View
from asterism.reports.write_results import write_results
from asterism.shape.release_picture import FRAMES, released
from asterism.shape.shape import Shape
from tests.asterism.commands import Cli
from tests.asterism.sheets import dome, sheet

PIXELS = (400, 300)


@pytest.fixture
def shape(monkeypatch: pytest.MonkeyPatch) -> Shape:
    monkeypatch.setattr("asterism.draw.render.SUPERSAMPLING", 1)
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


def test_a_sheet_that_is_larger_than_the_picture_is_cut_off(shape: Shape) -> None:
    image = view_image(shape, "above", PIXELS, 10.0, plain=True)
    assert image.size == PIXELS and (ink(image) == np.array(PIXELS) - 1).all()


def test_a_plain_picture_has_no_words(shape: Shape) -> None:
    assert ink(view_image(shape, "above", PIXELS, 1.0, plain=True))[1] < 100
    assert ink(view_image(shape, "above", PIXELS, 1.0, title="dome"))[1] > 200


@pytest.mark.parametrize(
    ("view", "size", "scale", "said"),
    [("below", PIXELS, None, "view"), ("above", (50, 300), None, "size"), ("above", PIXELS, 0.0, "scale")],
)
def test_what_is_no_picture(shape: Shape, view: View, size: tuple[int, int], scale: float | None, said: str) -> None:
    with pytest.raises(ValueError, match=f"^{said} must be"):
        view_image(shape, view, size, scale)


def test_shapes_show_themselves_in_notebooks(shape: Shape) -> None:
    data = shape._repr_png_()
    assert Image.open(io.BytesIO(data)).size == (2000, 1120)
    assert shape.picture("front", PIXELS, plain=True).size == PIXELS


def test_results_are_drawn_at_one_scale(shape: Shape, here: Path, cli: Cli) -> None:
    half = replace(shape, printed=shape.printed / 2, positions=shape.positions / 2)
    for name, one in {"large": shape, "small": half}.items():
        write_results(replace(one, summary={"design": {"name": name, "pins": [{}]}}), here / name)
    done = cli(["picture", "large", "small", "--view", "above", "--size", "400x300", "--plain"])
    assert done.status == 0, done.err
    sizes = [ink(Image.open(here / f"{name}-above.png")) for name in ("large", "small")]
    assert sizes[0] == pytest.approx(2.0 * sizes[1], abs=8)
    for words, said in (
        (["nothing"], "nothing"),
        (["large", "--size", "wide"], "--size"),
        (["large", "--size", "10x10"], "--size"),
        (["large", "--size", "300.5x300"], "--size"),
        (["large", "--scale", "0"], "--scale"),
        (["large", "large/shape.vtu", "small/shape.vtu", "-o", "."], "--output"),
    ):
        refused = cli(["picture", *words])
        assert refused.status == 2 and said in refused.line, words


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
    assert cli(words).status == 0
    with Image.open("dome-release.gif") as image:
        assert image.n_frames == FRAMES and image.size == (200, 150)
    refused = cli([*words, "--scale", "2"])
    assert refused.status == 2 and "--scale" in refused.err
