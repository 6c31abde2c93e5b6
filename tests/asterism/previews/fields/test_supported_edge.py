"""Round outlines are shown where their pins hold them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.session import Preview
from tests.asterism.previews.laws import plain_law

REACH = PREVIEW_MODEL.supported_rim_width

SCALE = 0.8


def circle(corners: int, pins: list[dict[str, Any]]) -> tuple[Preview, np.ndarray]:
    """A round sheet of the tube's stars, and its corners with the middles of its sides."""
    turn = 2.0 * np.pi * np.arange(corners) / corners
    ring = 40.0 * np.column_stack([np.cos(turn), np.sin(turn)])
    data = gallery.load("tube").to_dict() | {"border": {"polygon_mm": ring.tolist()}, "pins": pins}
    return Preview(Design.from_dict(data), plain_law()), np.concatenate([ring, 0.5 * (ring + np.roll(ring, -1, 0))])


def on_shell(preview: Preview, points: np.ndarray) -> np.ndarray:
    return np.asarray(preview.sheet.space.locate(points).value @ preview.equilibrium.x)


@pytest.mark.parametrize("corners", [24, 60])
def test_a_round_border_is_where_it_is_held(corners: int) -> None:
    preview, outline = circle(corners, [{"where": "border", "scale": SCALE, "offset_mm": [1.0, 2.0, 3.0]}])
    offset = np.array([1.0, 2.0, 3.0])
    held = np.column_stack([SCALE * outline, np.zeros(len(outline))]) + offset
    shown = preview.at(outline)
    np.testing.assert_allclose(shown.smooth, held, atol=1e-9)
    np.testing.assert_allclose(shown.bumpy, held, atol=1e-3)
    # the shell's own is close to that, and the sheet further in is the shell's
    assert np.abs(on_shell(preview, outline) - held).max() < 0.5
    inner = 0.6 * outline
    np.testing.assert_allclose(preview.at(inner).smooth, on_shell(preview, inner), atol=1e-9)


def test_sides_that_slide_are_moved_along_what_is_held_only() -> None:
    preview, outline = circle(60, [{"edges": [0, 1, 2, 20, 21, 40], "slide": "plane"}])
    shown, shell = preview.at(outline).smooth, on_shell(preview, outline)
    np.testing.assert_allclose(shown[:, :2], shell[:, :2], atol=1e-9)
    np.testing.assert_allclose(shown[[60, 61, 62, 80, 81, 100], 2], 0.0, atol=1e-9)


def test_straight_sides_are_held_by_the_shell() -> None:
    data = gallery.load("dome").to_dict()
    preview = Preview(Design.from_dict(data), plain_law())
    points = 0.99 * preview.sheet.layout.outline
    np.testing.assert_allclose(preview.at(points).smooth, on_shell(preview, points), atol=1e-9)


def test_what_is_missing_at_the_outline_is_shared_with_the_sheet_nearby() -> None:
    preview, outline = circle(24, [{"where": "border", "scale": SCALE}])
    spacing = preview.sheet.layout.spacing_mm
    middle, away = outline[24], np.array([0.0, 0.25, 0.5, 0.75])
    points = middle * (1.0 - away * REACH * spacing / np.linalg.norm(middle))[:, None]
    moved = preview.at(points).smooth - on_shell(preview, points)
    assert np.linalg.norm(moved[0]) > 0.05
    np.testing.assert_allclose(moved, (1.0 - away)[:, None] * moved[0], atol=1e-9)


def test_the_free_outline_beside_a_held_side_is_left_alone() -> None:
    preview, outline = circle(60, [{"edges": [0, 1, 2, 30, 31, 32], "scale": SCALE}])
    beside = np.array([outline[4], outline[59], 0.5 * (outline[3] + outline[4])])
    np.testing.assert_allclose(preview.at(beside).smooth, on_shell(preview, beside), atol=1e-9)
