"""Charts as SVG: what is drawn lies where the ticks say, and nothing lies outside."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from asterism.draw.magma import magma
from asterism.draw.svg_chart import MAX_TICKS, SvgAxes, colour_bar, round_ticks, svg_picture


@pytest.mark.parametrize(("low", "high"), [(-57.9, 58.1), (0.0, 0.53), (0.0, 3e-9), (-1e4, 9e4), (7.0, 7.4)])
def test_ticks_are_few_round_and_within(low: float, high: float) -> None:
    ticks = round_ticks(low, high)
    assert 2 <= len(ticks) <= MAX_TICKS + 1
    slack = 1e-6 * (high - low)
    assert low - slack <= ticks[0] and ticks[-1] <= high + slack
    assert np.allclose(np.diff(ticks), ticks[1] - ticks[0])
    assert all(len(f"{tick:g}".lstrip("-")) <= 7 for tick in ticks)


def test_a_line_lies_at_its_ticks_and_within_the_picture() -> None:
    """Two ticks give the scale; the corners of a line follow from it."""
    corners = np.array([[-40.0, -10.0], [40.0, -10.0], [0.0, 20.0]])
    axes = SvgAxes(corners.min(axis=0), corners.max(axis=0), 400.0, "x, mm", "y, mm")
    axes.line(corners, "#123456", closed=True)
    axes.title("<a> & b")
    bar = colour_bar(410.0, 10.0, 80.0, ["#fff", "#000"], 0.5, "share")
    root = ElementTree.fromstring(svg_picture(axes.width + 80, axes.height, [axes.group(), bar]))
    places = {text.text: float(text.get("x")) for text in root.iter("text") if text.get("text-anchor") == "middle"}
    assert "<a> & b" in places
    per_mm = (places["40"] - places["-20"]) / 60.0
    assert per_mm == pytest.approx(axes.scale, rel=1e-3)
    polygon = next(root.iter("polygon"))
    drawn = np.array([[float(n) for n in pair.split(",")] for pair in polygon.get("points").split()])
    assert drawn[1, 0] == pytest.approx(places["40"], abs=0.1)
    assert (drawn[0, 1] - drawn[2, 1]) / 30.0 == pytest.approx(per_mm, rel=1e-2)
    assert np.all(drawn > 0.0) and np.all(drawn < [axes.width, axes.height])


def test_a_low_chart_is_low_and_a_tall_one_is_bounded() -> None:
    low = SvgAxes(np.zeros(2), np.array([100.0, 5.0]), 400.0, "", "", 300.0)
    tall = SvgAxes(np.zeros(2), np.array([5.0, 100.0]), 400.0, "", "", 300.0)
    assert low.height < 120.0 and tall.height == pytest.approx(300.0)
    assert re.fullmatch(r"<g .*</g>", tall.group(), re.S)


def test_colours_are_those_of_the_map() -> None:
    """matplotlib holds the complete map."""
    colormaps = pytest.importorskip("matplotlib").colormaps
    shares = np.linspace(0.0, 1.0, 256)
    assert np.abs(magma(shares) - colormaps["magma_r"](shares)[:, :3]).max() < 0.015
