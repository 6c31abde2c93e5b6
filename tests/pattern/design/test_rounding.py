"""Sizes rounded to what a printer can make."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asterism.pattern.design.design import Design, save_design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.layout.build import layout, load_design

FINE = {"first_layer_mm": 0.2, "layer_mm": 0.1, "line_mm": 0.4}


def design(**stars: object) -> Design:
    return Design.from_dict({"stars": {"length_mm": 8.0, **stars}, "border": {"rings": 2}})


def test_thickness_is_a_first_layer_and_whole_layers() -> None:
    exact = np.array([0.05, 0.2, 0.24, 0.25, 0.26, 0.30, 0.44, 1.0])
    assert Rounding(**FINE).thickness(exact) == pytest.approx([0.2, 0.2, 0.2, 0.3, 0.3, 0.3, 0.4, 1.0], abs=1e-12)


def test_width_is_one_line_or_more() -> None:
    assert Rounding(**FINE).width(np.array([0.1, 0.59, 0.6, 1.2, 1.39])) == pytest.approx([0.4, 0.4, 0.8, 1.2, 1.2])


@given(st.floats(0.05, 5), st.floats(0.05, 0.5), st.floats(0.05, 0.5))
def test_rounded_sizes_stay_and_are_near(size: float, first: float, layer: float) -> None:
    rule = Rounding(first_layer_mm=first, layer_mm=layer, line_mm=layer)
    for once, least in ((rule.thickness(np.array([size])), first), (rule.width(np.array([size])), layer)):
        assert abs(once[0] - size) <= max(layer / 2, least - size) + 1e-8
    assert rule.thickness(rule.thickness(np.array([size]))) == rule.thickness(np.array([size]))
    assert rule.width(rule.width(np.array([size]))) == rule.width(np.array([size]))


def test_every_star_is_rounded_those_changed_by_hand_too(tmp_path) -> None:
    thickness = {"profile": "radial", "from": 0.6, "to": 0.2, "over_mm": 30.0}
    change = [{"star": 1, "thickness_mm": 0.47, "width_mm": 1.0}]
    exact = layout(design(thickness_mm=thickness, override=change))
    rounded_design = design(thickness_mm=thickness, override=change, rounding=FINE)
    rounded = layout(rounded_design)
    assert rounded.arm_thickness == pytest.approx(Rounding(**FINE).thickness(exact.arm_thickness))
    assert rounded.arm_thickness[rounded.arm_star == 1] == pytest.approx(0.5)
    assert rounded.arm_width[rounded.arm_star == 1] == pytest.approx(1.2)
    save_design(rounded_design, tmp_path / "rounded.toml")
    assert load_design(tmp_path / "rounded.toml") == rounded_design


def test_rounding_does_not_excuse_a_wrong_size() -> None:
    with pytest.raises(DesignError, match=r"stars\.thickness_mm = -1\.0: must be from 0\.05 to 5"):
        layout(design(thickness_mm=-1.0, rounding=FINE))
    with pytest.raises(DesignError, match=r"stars\.rounding\.layer_mm"):
        design(rounding={**FINE, "layer_mm": 0.0})
