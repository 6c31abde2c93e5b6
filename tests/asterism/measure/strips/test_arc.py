"""Arcs and their boxes, against the circle itself."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asterism.measure.strips import arc

angles = st.floats(1e-4, 2 * np.pi - 1e-3)
radii = st.floats(1.0, 1e4)


def drawn_box(angle: float, radius: float, thickness: float = 0.0) -> tuple[float, float]:
    """Box of many points of an arc that lies on both sides of the top of its circle, or of its two sides."""
    turn = np.linspace(-angle / 2, angle / 2, 20001)
    rings = [(r * np.sin(turn), r * np.cos(turn)) for r in (radius - thickness / 2, radius + thickness / 2)]
    x, y = np.concatenate(rings, axis=1)
    return float(np.ptp(x)), float(np.ptp(y))


@given(angle=angles, radius=radii)
def test_box_is_that_of_the_drawn_arc(angle: float, radius: float) -> None:
    width, height = arc.box(1 / radius, angle * radius)
    assert (width, height) == pytest.approx(drawn_box(angle, radius), rel=1e-6, abs=1e-9 * radius)


@given(angle=angles, radius=radii)
def test_a_box_gives_curvature_and_length_back(angle: float, radius: float) -> None:
    """Beyond half a circle, too, where the box's width is the diameter."""
    width, height = arc.box(1 / radius, angle * radius)
    assert float(arc.curvature(width, height)) == pytest.approx(1 / radius, rel=1e-9)
    assert float(arc.arc_length(width, height)) == pytest.approx(angle * radius, rel=1e-6)


def test_a_flat_box() -> None:
    assert float(arc.curvature(60.0, 0.0)) == 0.0
    assert float(arc.arc_length(60.0, 0.0)) == 60.0
    assert [float(side) for side in arc.box(0.0, 60.0)] == pytest.approx([60.0, 0.0])


@given(angle=st.floats(0.05, 6.0), thickness=st.floats(0.1, 1.5))
def test_outside_of_a_thick_strip(angle: float, thickness: float) -> None:
    radius = 30.0
    width, height = drawn_box(angle, radius, thickness)
    if width > 4 * thickness:
        found = arc.line_box(width, height, thickness)
        # the box of the line is that of its own arc, up to what the drawn points leave out
        assert found == pytest.approx(drawn_box(angle, radius), rel=1e-4, abs=1e-4)


def test_outside_of_a_flat_strip() -> None:
    assert arc.line_box(60.0, 1.0, 1.1) == (60.0, 0.0)
    with pytest.raises(ValueError, match="does not bend"):
        arc.line_box(4.0, 3.0, 1.1)
