"""Previews on fabric with a grain against the exact model; every template is a certified, printable start."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout, load_design
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.session import preview
from asterism.print.bed_placement import size_warning
from asterism.shape.comparison import compare_shapes
from asterism.shape.shape import Shape

pytestmark = pytest.mark.slow


def roll_axis_deg(shape: Shape) -> float:
    """Printed direction of the axis that a sheet rolls about, from 0 to 180."""
    x, y = shape.printed.T
    terms = np.column_stack([np.ones(len(x)), x, y, 0.5 * x**2, 0.5 * y**2, x * y])
    _, along_x, along_y, *second = np.linalg.lstsq(terms, shape.positions, rcond=None)[0]
    xx, yy, xy = np.array(second) @ np.cross(along_x, along_y)
    sizes, axes = np.linalg.eigh([[xx, xy], [xy, yy]])
    flat = axes[:, np.abs(sizes).argmin()]
    return float(np.degrees(np.arctan2(flat[1], flat[0]))) % 180.0


@pytest.mark.parametrize(
    "fabric",
    [{"modulus_mpa": [11.36, 4.55], "grain_deg": 70.0}, {"stretch": [1.25, 1.5]}],
    ids=["grain", "two stretches"],
)
def test_a_free_sheet_rolls_about_the_axis_of_the_exact_model(fabric: dict[str, Any]) -> None:
    stars = {"length_mm": 8.5, "thickness_mm": 0.42}
    design = Design.from_dict({"stars": stars, "border": {"rings": 2}, "fabric": fabric, "mesh": {"edge_mm": 2.0}})
    shown = preview(design)
    exact = exact_shape(design, near=shown)
    assert shown.summary["is_minimum"] and exact.summary["is_minimum"]
    apart = abs(roll_axis_deg(shown) - roll_axis_deg(exact))
    assert min(apart, 180.0 - apart) < 5.0
    plan = layout(design)
    assert compare_shapes(exact, shown, plan, symmetries(design, plan)).rms_percent < 1.5


def test_one_sentence_says_what_a_design_is() -> None:
    assert not set(gallery.template_names()) & set(gallery.names())
    for name in (*gallery.template_names(), *gallery.names()):
        words = gallery.words(name)
        assert words.endswith(".") and 10 <= len(words) <= 140 and "\n" not in words


@pytest.mark.parametrize("name", gallery.template_names())
def test_a_template_is_certified_and_printable(name: str) -> None:
    design = load_design(gallery.path(name))
    assert design.name == name and not list(size_warning(design))
    # one or two layers of the printers that are listed
    assert design.required_stars.thickness_mm in (0.3, 0.4)
    summary = preview(design).summary
    assert summary.is_minimum and summary.law_in_range and not summary.self_intersections
    assert summary.height_mm > 25.0
