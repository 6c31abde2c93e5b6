"""Sizes of rods painted with a brush: the field, its file and its undo."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.sizing.profiles import LinearProfile, PictureProfile
from asterism.pattern.design.stars import STAR_SIZES
from asterism.pattern.layout.build import layout
from asterism.studio.document import Document
from asterism.studio.painted_field import Brush, PaintedField
from asterism.studio.server import PAGE

OUTLINE = np.array([[-20.0, -10.0], [30.0, -10.0], [30.0, 15.0], [-20.0, 15.0]])
BRUSH = Brush(mode="set", radius=8.0, strength=1.0, value=0.9, low=0.05, high=5.0)
GRID = """name = "grid"
[rods]
thickness_mm = 0.4  # of all lines
[[rods.motif]]
line_mm = [[0.0, 0.0], [10.0, 0.0]]
[[rods.motif]]
line_mm = [[0.0, 0.0], [0.0, 10.0]]

[lattice]
kind = "square"
spacing_mm = 10.0

[border]
rectangle_mm = [50.0, 40.0]
"""


@pytest.fixture
def grid(tmp_path: Path) -> Document:
    (tmp_path / "grid.toml").write_text(GRID, encoding="utf-8")
    return Document.open(tmp_path / "grid.toml")


def test_a_dab_reaches_its_value_in_the_middle_and_nothing_beyond_its_radius() -> None:
    field = PaintedField.of(0.4, OUTLINE).brushed(BRUSH, [[(5.5, 0.5)]])
    away = np.linalg.norm(field.places - [5.5, 0.5], axis=1)
    values = field.values.ravel()
    assert values.shape == (50 * 25,) and values[away < 1e-9] == pytest.approx(0.9)
    assert (values[away >= 8.0] == 0.4).all() and (values[away < 8.0] > 0.4).all()
    expected = 0.4 + 0.5 * (1.0 - (away / 8.0).clip(0, 1) ** 2) ** 2
    assert values == pytest.approx(expected)


def test_images_of_a_place_are_painted_once_where_they_overlap_and_values_stay_in_the_range() -> None:
    brush = BRUSH.model_copy(update=dict(mode="add", value=0.1))
    twice = PaintedField.of(0.4, OUTLINE).brushed(brush, [[(0.5, 0.5), (0.5, 0.5)]])
    assert twice.values.max() == pytest.approx(0.5)
    assert twice.brushed(brush.model_copy(update=dict(value=3.0, high=0.7)), [[(0.0, 0.0)]] * 3).values.max() == 0.7


def test_smoothing_lowers_hills_and_leaves_an_even_field() -> None:
    smooth = BRUSH.model_copy(update=dict(mode="smooth", radius=12.0))
    hill = PaintedField.of(0.4, OUTLINE).brushed(BRUSH, [[(5.5, 0.5)]])
    after = hill.brushed(smooth, [[(5.5, 0.5)]])
    assert 0.4 < after.values.max() < 0.8 and after.values.min() >= 0.4
    assert PaintedField.of(0.4, OUTLINE).brushed(smooth, [[(0.0, 0.0)]]).profile == 0.4


def test_a_field_begins_with_the_profile_that_is_there() -> None:
    profile = LinearProfile.model_validate(
        {"profile": "linear", "from": 0.3, "to": 0.8, "start_mm": (-20, 0), "end_mm": (30, 0)}
    )
    field = PaintedField.of(profile, OUTLINE)
    assert field.values.ravel() == pytest.approx(profile.at(field.places))
    again = PaintedField.of(PictureProfile.model_validate(field.profile), OUTLINE)
    assert np.abs(again.values - field.values).max() <= 0.5 * 0.5 / 255 + 1e-4
    assert PaintedField.of(0.4, 20.0 * OUTLINE).values.shape == (256, 256)  # at most


def test_a_stroke_is_one_step_of_undo_and_its_dabs_are_not_rounded_in_between(grid: Document) -> None:
    brush = BRUSH.model_copy(update=dict(strength=0.002))
    for _ in range(50):
        grid.brush("thickness_mm", brush, [[(0.5, 0.5)]], gesture=1)
    grid.end_gesture()
    profile = Design.from_dict(grid.table).required_rods.thickness_mm
    assert isinstance(profile, PictureProfile)
    assert profile.at(np.array([[0.5, 0.5]]))[0] == pytest.approx(0.9 - 0.5 * 0.998**50, abs=1e-3)
    grid.undo()
    assert grid.text == GRID


def test_rods_have_what_is_painted_and_the_saved_file_gives_the_same(grid: Document) -> None:
    grid.brush("thickness_mm", BRUSH, [[(0.0, 0.0)]])
    grid.end_gesture()
    thickness = np.concatenate([rod.thickness for rod in grid.layout.drawn_rods])
    assert thickness.max() == pytest.approx(0.9, abs=0.02) and thickness.min() == pytest.approx(0.4, abs=1e-6)
    grid.save()
    text = grid.path.read_text(encoding="utf-8")
    assert len(text) < 4000 and "painted in the studio" in text
    again = layout(Design.from_dict(Document.open(grid.path).table))
    assert np.array_equal(np.concatenate([rod.thickness for rod in again.drawn_rods]), thickness)


def test_a_stroke_beside_the_sheet_is_no_step_of_undo(grid: Document) -> None:
    grid.brush("thickness_mm", BRUSH, [[(200.0, 0.0)]], gesture=1)
    grid.end_gesture()
    assert not grid.history.position and grid.text == GRID


def test_thickness_and_width_are_painted_apart(grid: Document) -> None:
    grid.brush("thickness_mm", BRUSH, [[(0.0, 0.0)]])
    grid.brush("width_mm", BRUSH.model_copy(update=dict(value=2.0)), [[(0.0, 0.0)]])
    largest = [grid.table["rods"][size]["high"] for size in ("thickness_mm", "width_mm")]
    assert largest == pytest.approx([0.9, 2.0], abs=0.03)


def test_sheets_of_stars_are_refused(tmp_path: Path) -> None:
    stars = Document({"stars": {"length_mm": 9.0}, "border": {"rings": 2}}, tmp_path / "a.toml")
    with pytest.raises(DesignError, match="the brush paints sizes of rods"):
        stars.brush("thickness_mm", BRUSH, [[(0.0, 0.0)]])


def test_the_page_paints_the_sizes_of_stars() -> None:
    text = (PAGE / "format.js").read_text(encoding="utf-8")
    entries = re.findall(r'(\w+): \{ key: "(\w+)", name: "\w+", column: (\d)', text)
    assert entries == [(size.name, size.key, str(column)) for column, size in enumerate(STAR_SIZES)]
