"""Parameters of a sweep: their words, their places in a design, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.sweeps.parameters import SweepError, SweepParameter, check_parameters, grid, latin_hypercube
from asterism.sweeps.point import MOTIF_CELL_S, MOTIF_PREVIEW_S, START_S, sweep_cost
from asterism.sweeps.sweep import check_model, sweep_design, sweep_parameters


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("stars.thickness_mm=0.2:0.6:9", (0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6)),
        ("border.rings=1:3:3", (1, 2, 3)),
        ("fabric.bending=paper,consistent", ("paper", "consistent")),
        ("gravity.on=false,true", (False, True)),
        ('fabric.stretch=1.35,[1.3, 1.4]', (1.35, [1.3, 1.4])),
        ('stars.length_mm={"profile": "table", "mm": 9}', ({"profile": "table", "mm": 9},)),
    ],
)  # fmt: skip
def test_words_are_values(text: str, values: tuple[Any, ...]) -> None:
    parameter = SweepParameter.from_text(text)
    assert parameter.path == text.partition("=")[0] and parameter.values == values
    assert [type(value) for value in parameter.values] == [type(value) for value in values]


def test_a_range_without_a_number_of_values_has_limits() -> None:
    assert SweepParameter.from_text("pins[0].scale=0.7:0.8") == SweepParameter("pins.0.scale", limits=(0.7, 0.8))


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("stars.thickness_mm", "must be PATH=FROM:TO:COUNT"),
        ("a=0.2:inf:3", "'inf' is not a number"),
        ("a=0.2:0.6:1", "the third number counts values, it must be from 2 to 10000"),
        ("a=0.6:0.2", "an empty range, the first number must be below the second"),
        ("a=0.3,0.3", "the value 0.3 is there twice"),
        ("a=0.3,,0.4", "value 2 is empty"),
        ("a=" + 20_000 * "[", "a: is nested too deeply"),
        ("a=" + 300 * "[" + 300 * "]", "a: value 1 is nested too deeply"),
        (".".join(3000 * "a") + "=1", "must have at most 20 steps"),
    ],
)
def test_wrong_words_are_refused_with_what_is_allowed(text: str, problem: str) -> None:
    with pytest.raises(SweepError, match=problem.replace("(", r"\(")) as caught:
        SweepParameter.from_text(text)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("vary", "problem"),
    [
        ({"stars.thicknes_mm": [0.3]}, r"stars.thicknes_mm = 0.3: unknown key, did you mean thickness_mm\?"),
        ({"pins.1.scale": [0.7]}, "pins.1: pins is a list, with 0 to 0"),
        ({"name.x": [1]}, "name.x: name is 'dome', which has no 'x'"),
        ({"stars.thickness_mm": ["thick"]}, "stars.thickness_mm = 'thick': must be a number"),
        ({"fabric.thickness_mm": "0:0.5"}, r"fabric.thickness_mm = 0.0: must be at least"),
        ({"border.rings": [1.5]}, "border.rings = 1.5: must be a whole number"),
        ({"stars.length_mm": [8.0], "stars.length_mm.from": [8.0]}, "is a part of stars.length_mm, which is varied"),
        ({"stars.length_mm": []}, "must have a value"),
        ({"rods.thickness_mm": [0.3]}, r"^rods.thickness_mm: the design has no \[rods\]; it has \[stars\]$"),
        ({}, "a sweep needs a parameter"),
    ],
)  # fmt: skip
def test_what_the_design_does_not_have_is_refused(vary: dict[str, Any], problem: str) -> None:
    with pytest.raises(SweepError, match=problem):
        sweep_parameters(gallery.load("dome"), vary)


def test_values_that_others_make_possible_are_not_refused_at_once() -> None:
    """Weight needs a modulus: each alone is impossible, and one of the designs is not. Numbers of arrays are plain."""
    vary = {"gravity.on": [False, True], "fabric.modulus_mpa": np.array([0.5])}
    weight, modulus = sweep_parameters(gallery.load("dome"), vary)
    assert type(modulus.values[0]) is float
    with pytest.raises(SweepError, match="is varied twice"):
        check_parameters(gallery.load("dome"), [weight, modulus, weight])


def test_previews_of_drawings_that_do_not_repeat_are_refused_at_once() -> None:
    with pytest.raises(SweepError, match="lines that do not repeat have no law; a sweep computes exact shapes with"):
        sweep_design(gallery.load("leaf"), {"rods.thickness_mm": [0.3, 0.4]})
    check_model(gallery.load("leaf"), exact=True)
    check_model(gallery.load("skew-grid"), exact=False)


def test_a_hypercube_has_one_value_in_each_part_of_each_range() -> None:
    ranges = [SweepParameter("a", limits=(0.2, 0.6)), SweepParameter("b", limits=(-1.0, 1.0))]
    parameters = [*ranges, SweepParameter("c", ("x", "y"))]
    rows = latin_hypercube(parameters, 20, seed=3)
    for path, low, high in (("a", 0.2, 0.6), ("b", -1.0, 1.0)):
        parts = sorted(int(20 * (row[path] - low) / (high - low)) for row in rows)
        assert parts == list(range(20))
    assert [row["c"] for row in rows].count("x") == 10
    assert rows == latin_hypercube(parameters, 20, seed=3) and rows != latin_hypercube(parameters, 20, seed=4)


def test_a_range_of_a_count_holds_whole_numbers() -> None:
    vary = {"border.rings": "1:4", "stars.length_mm": "6:10"}
    rings, length = sweep_parameters(gallery.load("tube"), vary)
    assert rings.whole and rings.limits == (1, 4) and not length.whole
    rows = latin_hypercube([rings, length], 20, seed=1)
    counts = [row["border.rings"] for row in rows]
    assert [counts.count(number) for number in (1, 2, 3, 4)] == [5, 5, 5, 5]
    assert {type(number) for number in counts} == {int} and rings.at(0.0) == 1 and rings.at(1.0) == 4
    assert not any(float(row["stars.length_mm"]).is_integer() for row in rows)
    with pytest.raises(SweepError, match=r"border.rings=1:3.5: must be a range of whole numbers"):
        sweep_parameters(gallery.load("tube"), {"border.rings": "1:3.5"})


def test_too_many_and_too_few_designs_are_refused() -> None:
    with pytest.raises(SweepError, match=r"1000000 designs: must be at most 10000; --samples"):
        grid([SweepParameter(name, tuple(range(1000))) for name in "ab"])
    with pytest.raises(SweepError, match=r"a=0.2:0.6: a range needs a number of values"):
        grid([SweepParameter("a", limits=(0.2, 0.6))])
    with pytest.raises(SweepError, match="--samples 1: must be from 2 to 10000"):
        latin_hypercube([SweepParameter("a", limits=(0.2, 0.6))], 1, 0)


@pytest.mark.slow
def test_previews_of_motifs_solve_their_cells_unless_a_law_is_given() -> None:
    net = gallery.load("skew-grid")
    assert sweep_cost(net, [], 10, False, 2).seconds == START_S + 5 * (MOTIF_PREVIEW_S + MOTIF_CELL_S)
    assert sweep_cost(net, [], 10, False, 2, law_is_given=True).seconds == START_S + 5 * MOTIF_PREVIEW_S
    table = net.to_dict()
    table["rods"]["thickness_mm"] = {"profile": "radial", "from": 0.3, "to": 0.5, "over_mm": 30.0}
    graded = sweep_cost(Design.from_dict(table), [], 1, False, 1).seconds
    assert graded >= START_S + MOTIF_PREVIEW_S + 4 * MOTIF_CELL_S
    table["fabric"]["bending"] = "none"  # a design without a law counts as one cell
    assert sweep_cost(Design.from_dict(table), [], 1, False, 1).seconds == START_S + MOTIF_PREVIEW_S + MOTIF_CELL_S
