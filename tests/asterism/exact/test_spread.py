"""The range of shapes: its response against exact shapes, scalings that change nothing, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asterism
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.levels import model_on
from asterism.discrete.release.prolongation import fit_to_surface
from asterism.exact.spread import MAX_SOLVES, RESPONSE_ERROR, check_spread, spread, varied
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.materials import rest_curvature
from asterism.pattern.design.spread import Spread
from asterism.pattern.layout.build import layout
from asterism.results.records.exact import VALUES, SpreadRecord
from tests.asterism.commands import Cli
from tests.asterism.previews.designs import edited

# each value a little off: the response is linear
NARROW = {
    "modulus_ratio_factor": 1.01,
    "stretch_percent": 0.5,
    "bending_factor": 1.02,
    "kappa_bar_error_per_mm": 1e-4,
    "thickness_error_mm": 0.001,
}
KNOWN = {name: 1.0 if name.endswith("factor") else 0.0 for name in VALUES}


def star(intervals: dict[str, float], **sections: dict[str, Any]) -> Design:
    """A single star on a coarse mesh."""
    return edited("star", mesh={"edge_mm": 4.0}, spread=intervals, **sections)


def ranged(design: Design) -> tuple[asterism.Shape, SpreadRecord]:
    shape = spread(asterism.simulate(design, starts=1))
    return shape, shape.summary.spread  # type: ignore[union-attr]


@pytest.fixture(scope="module")
def narrow() -> tuple[asterism.Shape, SpreadRecord]:
    return ranged(star(NARROW))


@pytest.mark.slow
def test_the_response_is_that_of_exact_shapes_of_changed_designs(narrow: tuple[asterism.Shape, SpreadRecord]) -> None:
    (shape, record), data = narrow, narrow[0].summary["design"]
    assert record.solves == MAX_SOLVES and shape.summary.warnings == []
    assert [end.comes_back for end in record.ends].count(True) == 1
    up = {share.value: share.heights_mm[1] - shape.height_mm for share in record.shares}
    computed = {end.value for end in record.ends if end.end == 1}
    assert {"kappa_bar_error_per_mm", "stretch_percent"} <= computed < set(up)  # the others are linear
    for name, change in {
        "modulus_ratio_factor": {"plastic": {"modulus_ratio": 3200.0 * 1.01}},
        "stretch_percent": {"fabric": {"stretch": 1.0 + 0.35 * 1.005}},
        "kappa_bar_error_per_mm": {"plastic": {"kappa_bar_per_mm": data["plastic"]["kappa_bar_per_mm"] + 1e-4}},
        "thickness_error_mm": {"stars": {"thickness_mm": data["stars"]["thickness_mm"] + 0.001}},
    }.items():
        off = asterism.simulate(star(NARROW, **change), starts=1).height_mm - shape.height_mm
        assert up[name] == pytest.approx(off, rel=1e-5 if name in computed else 0.01, abs=1e-7), name
    # all at once: the sum, up to second order
    design = Design.from_dict(shape.summary["design"])
    t = dict.fromkeys(up, 1.0)
    model = model_on(*varied(design, layout(design), t), 4.0)
    found = solve_on_mesh(model, fit_to_surface(model, shape.positions))
    together = float(np.ptp(found.state.positions @ shape.upright.T, axis=0).min()) - shape.height_mm
    assert abs(sum(up.values())) > 1e-3
    assert together == pytest.approx(sum(up.values()), rel=0.03)


def test_one_value_has_the_quantiles_of_its_normal_distribution() -> None:
    shape, record = ranged(star(KNOWN | {"modulus_ratio_factor": 1.01}))
    assert [share.value for share in record.shares] == ["modulus_ratio_factor"]
    assert record.shares[0].variance_percent == pytest.approx(100.0)
    low, high = sorted(record.shares[0].heights_mm)
    # 5 % of a normal distribution are beyond 1.645 standard deviations, the end of the interval is 1.96 away, and the
    # error of the response counts as independent
    assert record.height_median_mm == pytest.approx(shape.height_mm, abs=0.05 * (high - low))
    wide = 1.645 / 1.96 * np.sqrt(1.0 + RESPONSE_ERROR**2)
    assert record.height_high_mm - record.height_low_mm == pytest.approx(wide * (high - low), rel=0.05)
    line = np.array(record.line_median_mm)
    assert np.ptp(line[:, 1]) == pytest.approx(shape.height_mm, rel=0.05)


def test_equal_scale_of_both_moduli_changes_nothing(narrow: tuple[asterism.Shape, SpreadRecord]) -> None:
    stiffer = ranged(star(NARROW, fabric={"modulus_mpa": 30.0}))[1]
    for one, other in zip(narrow[1].shares, stiffer.shares, strict=True):
        assert one.value == other.value
        assert one.heights_mm == pytest.approx(other.heights_mm, abs=1e-7)


def test_another_form_within_the_intervals_is_said() -> None:
    shape, record = ranged(star(KNOWN | {"kappa_bar_error_per_mm": 0.1}))
    lower = next(end for end in record.ends if end.end < 0)
    assert (lower.stars_turned, lower.comes_back) == (1, False)
    assert [line for line in shape.summary.warnings if "kappa_bar at its lower end" in line and "another form" in line]


def test_values_follow_their_formulas() -> None:
    """Eq. (1) of an arm, the tensor of the bending, and the strain."""
    design = star({"modulus_ratio_factor": 1.3, "bending_factor": 2.0, "stretch_percent": 10.0})
    plastic, fabric = design.plastic, design.fabric
    eq1 = float(rest_curvature(0.3, fabric, plastic)) - float(plastic.kappa_bar_per_mm)  # type: ignore[arg-type]
    plan = layout(design)
    stiff, _ = varied(design, plan, {"modulus_ratio_factor": -1.0})
    more = float(rest_curvature(0.3, stiff.fabric, stiff.plastic)) - plastic.kappa_bar_per_mm
    assert more == pytest.approx(1.3 * eq1)
    soft = varied(design, plan, {"bending_factor": -0.5})[0].fabric
    assert soft.bending_tensor == pytest.approx([each / np.sqrt(2.0) for each in fabric.bending_tensor])
    assert soft.modulus == fabric.modulus
    assert varied(design, plan, {"stretch_percent": 1.0})[0].fabric.stretch == pytest.approx(1.0 + 1.1 * 0.35)


def test_only_values_that_count_are_varied() -> None:
    pair = {"modulus_mpa": [10.0, 5.0], "grain_deg": 178.0}
    assert check_spread(star({}), layout(star({}))) == [name for name in VALUES if name != "grain_error_deg"]
    grained, bare = star({}, fabric=pair), star({}, fabric={"bending": "none"})
    assert check_spread(grained, layout(grained)) == list(VALUES)
    assert varied(grained, layout(grained), {"grain_error_deg": 1.0})[0].fabric.grain_deg == pytest.approx(3.0)
    assert "bending_factor" not in check_spread(bare, layout(bare))
    assert check_spread(star(KNOWN | {"stretch_percent": 1.0}), layout(bare)) == ["stretch_percent"]
    with pytest.raises(DesignError, match="spread: must have an interval"):
        check_spread(star(KNOWN), layout(bare))


def test_drawn_rods_are_varied_too() -> None:
    rods = {"thickness_mm": 0.4, "draw": [{"line_mm": [[-20, 0], [20, 0]], "kappa_bar_per_mm": 0.002}]}
    design = Design.from_dict({"rods": rods, "border": {"rectangle_mm": [60, 40]}})
    _, plan = varied(design, layout(design), {"thickness_error_mm": 1.0, "kappa_bar_error_per_mm": -1.0})
    assert [(rod.thickness[0], rod.kappa_bar) for rod in plan.graph.rods] == [pytest.approx((0.43, 0.0005))]


@pytest.mark.parametrize(
    ("sections", "field", "problem"),
    [
        ({"spread": {"thickness_error_mm": 0.4}}, "spread.thickness_error_mm", "from 0.05 to 5"),
        ({"spread": {"stretch_percent": 50.0}, "fabric": {"stretch": 2.5}}, "spread.stretch_percent", "from 1 to 3"),
        ({"spread": {}, "plastic": {"modulus_ratio": 1.2}}, "spread.modulus_ratio_factor", "at least 1"),
    ],
)
def test_an_end_that_cannot_be_printed_is_refused(sections: dict, field: str, problem: str) -> None:
    design = star(sections.pop("spread"), **sections)
    with pytest.raises(DesignError, match=problem) as caught:
        check_spread(design, layout(design))
    assert caught.value.field == field and "\n" not in str(caught.value)


def test_what_is_no_exact_minimum_is_refused() -> None:
    with pytest.raises(TypeError, match="Shape is needed, not Design"):
        spread(gallery.load("star"))  # type: ignore[arg-type]
    with pytest.raises(DesignError, match="must be a stable exact shape"):
        spread(asterism.preview(gallery.load("star")))


@pytest.mark.slow
def test_the_command_writes_the_range_and_its_picture(tmp_path: Path, cli: Cli) -> None:
    design = tmp_path / "d.toml"
    text = "[stars]\nlength_mm = 10.0\n[border]\nrings = 0\n[mesh]\nedge_mm = 4.0\n"
    design.write_text(text)
    words = ["simulate", str(design), "--starts", "1"]
    done = cli([*words, "--spread"]).done
    assert "in nine of ten prints" in done.out and "range comes from" in done.out and "spread.png" in done.out
    assert "spread: thickness at its lower end" in done.err
    summary = json.loads((tmp_path / "d" / "summary.json").read_text())
    assert summary["spread"]["height_low_mm"] < summary["height_mm"] < summary["spread"]["height_high_mm"]
    assert summary["spread"]["intervals"] == Spread().model_dump()
    assert (tmp_path / "d" / "spread.png").read_bytes().startswith(b"\x89PNG")
    again = asterism.spread(asterism.read_shape(tmp_path / "d"))
    low = again.summary.spread.height_low_mm  # type: ignore[union-attr]
    assert low == pytest.approx(summary["spread"]["height_low_mm"], abs=1e-6)
    # the range of an earlier result does not stay beside a new one
    assert cli(words).status == 0
    assert not (tmp_path / "d" / "spread.png").exists()
    design.write_text(text + "[spread]\nthickness_error_mm = 0.28\n")
    assert "d.toml: spread.thickness_error_mm = 0.28: is too wide" in cli([*words, "--spread"]).line
