"""Tables of strips, with a line for each mistake, and the fit of a material to strips whose material is known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import binom

from asterism.measure.strip_fit import FORMULAS, StripFit, UndeterminedMaterialError, fit_directions, fit_readings
from asterism.measure.strip_table import (
    STRIP_COLUMNS,
    Reading,
    arc_box,
    arc_curvature,
    arc_length,
    line_box,
    read_strips,
)
from asterism.pattern.design.materials import Fabric, Plastic, rest_curvature
from asterism.process.settings import THICKNESSES_MM, KappaBarKind, StripFitSettings, StripFormula
from asterism.results.csv_table import TableError
from tests.asterism.measure.strips.synthetic import synthetic_readings

HEAD = "strip,thickness_mm,length_mm,stretch,fabric_thickness_mm,box_width_mm,box_height_mm"
PEELED = ",peeled_box_width_mm,peeled_box_height_mm"
GOOD = "1,0.3,60,1.35,0.8,53.4,11.7"
CURVED = "strip,thickness_mm,length_mm,stretch,fabric_thickness_mm,curvature_per_mm,peeled_curvature_per_mm"


def read(tmp_path: Path, text: str | bytes, **options: object) -> list[Reading]:
    file = tmp_path / "strips.csv"
    file.write_bytes(text.encode() if isinstance(text, str) else text)
    return read_strips(file, StripFitSettings(**options))  # type: ignore[arg-type]


def test_a_strip_with_and_without_its_fabric(tmp_path: Path) -> None:
    with_fabric, peeled = read(tmp_path, f"{HEAD}{PEELED}\n{GOOD},59.5,1.4\n2,0.3,60,1.35,0.8,,,,\n")
    assert (with_fabric.peeled, peeled.peeled) == (False, True)
    assert with_fabric.curvature_per_mm == pytest.approx(8 * 11.7 / (53.4**2 + 4 * 11.7**2))
    assert peeled.curvature_per_mm == pytest.approx(8 * 1.4 / (59.5**2 + 4 * 1.4**2))
    assert with_fabric.name == "strip 1 with fabric" and with_fabric.left_out is None


@pytest.mark.parametrize(("separator", "end"), [(",", "\n"), (";", "\r\n"), ("\t", "\n"), (",", ",,\n")])
def test_separators_orders_and_remarks(separator: str, end: str, tmp_path: Path) -> None:
    names = ["length_mm", "box_height_mm", "strip", "box_width_mm", "stretch", "thickness_mm", "fabric_thickness_mm"]
    cells = ["60", " 11.7", "A", "53.4", "1.35", "0.30", "0.8"]
    rows = ["\ufeff" + separator.join(names), separator * 6, "# a remark, with a comma", separator.join(cells)]
    (found,) = read(tmp_path, end.join(rows) + end)
    assert (found.strip, found.row, found.thickness_mm) == ("A", 4, 0.3)


@pytest.mark.parametrize(
    ("cells", "curvature"),
    [
        ("60,0", None),
        ("60,flat", None),
        (",Flat", None),
        ("59.9,0.0", None),
        ("{:.2f},{:.2f}".format(*arc_box(0.08, 60.0)), pytest.approx(0.08, rel=1e-3)),  # beyond half a circle
        ("15.0,15.1", pytest.approx(2 / 15)),  # rolled over itself
        ("19.0,19.5", pytest.approx(2 / 19)),  # a circle may be read a little higher than wide
    ],
)
def test_flat_strips_and_circles(cells: str, curvature: float | None, tmp_path: Path) -> None:
    (found,) = read(tmp_path, f"{HEAD}\n1,0.2,60,1.35,0.8,{cells}\n")
    assert found.curvature_per_mm == curvature and found.left_out is None


def test_curvatures_in_place_of_boxes(tmp_path: Path) -> None:
    head = "strip,thickness_mm,length_mm,curvature_per_mm,peeled_curvature_per_mm"
    found = read(tmp_path, f"{head}\n1,0.3,60,0.0276,-0.001\n2,0.4,60,0,\n", stretch=1.35, fabric_thickness_mm=0.8)
    assert [r.curvature_per_mm for r in found] == [0.0276, -0.001, None]
    assert {(r.stretch, r.fabric_thickness_mm) for r in found} == {(1.35, 0.8)}


def test_boxes_around_the_whole_strip(tmp_path: Path) -> None:
    """A box drawn around fabric and plastic is higher by their thickness: half as much again for a flat arc."""
    width, height = (float(side) for side in arc_box(0.005, 60.0))
    text = f"{HEAD}{PEELED}\n1,0.3,60,1.35,0.8,{width:.3f},{height + 1.1:.3f},{width:.3f},{height + 0.3:.3f}\n"
    for reading in read(tmp_path, text, outside=True):
        assert reading.curvature_per_mm == pytest.approx(0.005, rel=0.02)
    assert read(tmp_path, text)[0].curvature_per_mm == pytest.approx(0.0074, rel=0.02)


def test_a_box_that_does_not_fit_its_strip(tmp_path: Path) -> None:
    (found,) = read(tmp_path, f"{HEAD}\n1,0.3,60,1.35,0.8,40,5\n")
    assert found.left_out == "its box holds an arc of 41.6 mm, the strip has 60"


@pytest.mark.parametrize(
    ("text", "place", "problem"),
    [
        ("", "strips.csv", "is empty"),
        (f"{HEAD}\n", "strips.csv", "no strips"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,,\n", "strips.csv", "no strip has been measured"),
        ("strip,h1,length_mm\n1,0.3,60\n", "row 1", "'h1'"),
        ("strip,thickness_mm\n1,0.3\n", "row 1", "length_mm is missing"),
        (f"{HEAD},strip\n{GOOD},1\n", "row 1, column strip", "twice"),
        (f"{HEAD}\n{GOOD}\n2,0.3,60,1.35,0.8,-53.4,11.7\n", "row 3, column box_width_mm", "from 0.1 to 2000"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,nan,11.7\n", "row 2, column box_width_mm", "finite"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,53.4,\n", "row 2, column box_height_mm", "empty"),
        (f"{HEAD}\n1,0.3,60,,0.8,53.4,11.7\n", "row 2, column stretch", "--stretch"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,about 53,11.7\n", "row 2, column box_width_mm", "not a number"),
        (f'{HEAD}\n1,0.3,60,1.35,0.8,"53,4",11.7\n', "row 2, column box_width_mm", "decimals with a point"),
        (f"{HEAD}\n1;0,3;60\n".replace(",thick", ";thick"), "row 1", "is known"),
        (HEAD.replace(",", ";") + "\n1;0,3;60;1.35;0.8;53.4;11.7\n", "row 2, column thickness_mm", "with a point"),
        (f"{HEAD}\n{GOOD}\n1,0.35,60,1.35,0.8,55,8\n", "row 3, column strip", "row 2"),
        (f"{HEAD}\n,0.3,60,1.35,0.8,53.4,11.7\n", "row 2, column strip", "name"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,2.10,0.46\n", "row 2, column box_width_mm", "inches"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,5.34,1.17\n", "row 2, column box_width_mm", "centimetres"),
        (f"{HEAD}\n1,0.3,2.36,1.35,0.8,2.1,0.46\n", "row 2, column length_mm", "inches"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,11.7,53.4\n", "row 2, column box_height_mm", "at most the width"),
        (f"{HEAD}\n1,0.2,60,1.35,0.8,19.0,20.6\n", "row 2, column box_height_mm", "at most the width"),
        (f"{HEAD},curvature_per_mm\n{GOOD},0.03\n", "row 2, column curvature_per_mm", "not both"),
        (f"{HEAD},curvature_per_mm\n1,0.3,60,1.35,0.8,,,-0.03\n", "row 2, column curvature_per_mm", "from 0 to 1"),
        (f"{HEAD},direction\n{GOOD},left\n", "row 2, column direction", "along or across"),
        (f"{HEAD},direction\n{GOOD},along\n2{GOOD[1:]},\n", "row 3, column direction", "other strips have one"),
        (f"{CURVED}\n1,.3,60,1.35,.8,.003,.030\n2,.4,60,1.35,.8,0,.017\n", "row 2, column peeled_curvature", "swapped"),
        (f"{HEAD}{PEELED}\na,.3,60,1.35,.8,59.8,1.35,48.4,13\n", "row 2, column peeled_box_width_mm", "swapped"),
        (f"{HEAD}\n1,.3,15,1.35,.8,105.3,49.7\n", "row 2, column length_mm", "by its box; is it in cent"),
        (f"{CURVED}\n1,.03,60,1.35,.8,.03,.003\n", "row 2, column thickness_mm", "is it in inches or centimetres"),
        (b"strip,thickness_mm,length_mm\n\xff\xfe,1,1\n", "row 2", "UTF-8"),
        ("strip,thickness_mm,length_mm\n1\0,1,1\n", "strips.csv", "not text"),
    ],
)
def test_mistakes_name_row_and_column(text: str | bytes, place: str, problem: str, tmp_path: Path) -> None:
    with pytest.raises(TableError) as caught:
        read(tmp_path, text)
    line = str(caught.value)
    assert "\n" not in line and "strips.csv" in line
    where, _, what = line.removeprefix(str(tmp_path)).partition(": ")
    assert place in where and problem in what, line


def test_options_are_for_tables_without_their_columns(tmp_path: Path) -> None:
    with pytest.raises(TableError, match=r"row 2, column stretch.*--stretch is for tables"):
        read(tmp_path, f"{HEAD}\n{GOOD}\n", stretch=1.4)
    with pytest.raises(TableError, match=r"row 3, column fabric_thickness_mm.*--fabric-thickness is for tables"):
        read(tmp_path, f"{HEAD}\n1,0.3,60,1.35,,53.4,11.7\n2{GOOD[1:]}\n", fabric_thickness_mm=0.7)


@pytest.mark.parametrize(
    ("boxes", "steps"),
    [
        (["53,12", "54,11", "53,flat"], [0.0] * 3),  # too few to tell
        (["53,12", "54,11", "53,10", "55,12"], [1.0] * 4),
        (["53.5,12", "54,11", "53,10", "55,12"], [0.5] * 4),
        (["53.257,11.7", "54.1,11.83", "53.2,11.6"], [0.0] * 3),
        # what stands beside a flat strip, and curvatures, were not read with the ruler of boxes
        *(
            ([*(f"53.{k},11.{k}" for k in range(4)), last], [0.1] * 4 + [0.0])
            for last in ("ca. 60,flat", "nan,flat", ",flat", ",,0.0161803")
        ),
    ],
)
def test_the_marks_to_which_boxes_were_read(boxes: list[str], steps: list[float], tmp_path: Path) -> None:
    head = f"{HEAD},curvature_per_mm"
    rows = [f"{number},0.3,60,1.35,0.8,{box}" for number, box in enumerate(boxes)]
    rows = [row + "," * (head.count(",") - row.count(",")) for row in rows]
    found = read(tmp_path, "\n".join([head, *rows]))
    assert [reading.step_mm for reading in found] == steps
    assert (found[-1].curvature_per_mm is None) == ("flat" in boxes[-1])


def test_files_that_are_not_there(tmp_path: Path) -> None:
    for path in (tmp_path / "none.csv", tmp_path):
        with pytest.raises(TableError, match="cannot be read"):
            read_strips(path, StripFitSettings())


def test_the_documentation_names_every_column() -> None:
    text = (Path(__file__).parents[4] / "docs" / "how-to" / "strips.md").read_text(encoding="utf-8")
    assert [name for name in STRIP_COLUMNS if f"`{name}`" not in text] == []


PAPER = 3200.0
# standard deviation of a thickness, the same for all its strips
WRONG_THICKNESSES: dict[str, Any] = {"reading_mm": 0.1, "scatter": 0.02, "count": 4, "off_mm": 0.01}


def exact(plastic: Plastic, stretch: float = 1.35, count: int = 3) -> list[Reading]:
    """Readings without errors, of curvatures in place of boxes."""
    bare = plastic.model_copy(update={"rest_curvature": "none"})
    return [
        replace(
            one,
            curvature_per_mm=float(
                rest_curvature(one.thickness_mm, Fabric(stretch=stretch), bare if one.peeled else plastic)
            ),
        )
        for one in synthetic_readings(0, stretch=stretch, count=count)
    ]


def fitted(readings: list[Reading], **settings: Any) -> StripFit:
    return fit_readings(readings, StripFitSettings(**settings))


def inside(fit: StripFit, ratio: float = PAPER) -> bool:
    return fit.found.low <= ratio <= fit.found.high


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_papers_strips_give_3200(seed: int) -> None:
    fit = fitted(synthetic_readings(seed))
    found = fit.ratio["paper"]
    assert inside(fit) and not fit.warnings
    assert (found.high - found.low) / found.value < 0.12
    assert found.value == pytest.approx(PAPER, rel=0.04)
    assert fit.kappa_bar[None].value == pytest.approx(0.003, rel=0.1)
    # what Timoshenko's formula makes of the same strips
    assert 0.44 < fit.ratio["timoshenko"].value / found.value < 0.5


@pytest.mark.slow
@settings(max_examples=20)
@given(
    ratio=st.floats(500, 20000),
    kept=st.floats(-0.002, 0.006),
    stretch=st.floats(1.1, 1.9),
    formula=st.sampled_from(FORMULAS),
)
def test_strips_without_errors_give_their_material(
    ratio: float, kept: float, stretch: float, formula: StripFormula
) -> None:
    plastic = Plastic(modulus_ratio=ratio, kappa_bar_per_mm=kept, rest_curvature=formula)
    readings = exact(plastic, stretch)
    for some in (readings, [r for r in readings if not r.peeled]):
        fit = fitted(some, rest_curvature=formula)
        assert fit.ratio[formula].value == pytest.approx(ratio, rel=1e-6)
        assert fit.kappa_bar[None].value == pytest.approx(kept, abs=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "kappa_bar", "is_peeled"),
    [
        ({}, "constant", True),
        ({"reading_mm": 0.05, "scatter": 0.05, "count": 4}, "constant", True),
        (WRONG_THICKNESSES, "constant", True),
        (WRONG_THICKNESSES, "per-thickness", True),
        (WRONG_THICKNESSES, "constant", False),
        # rounded to a ruler, and looking flat: errors that repeats do not average
        ({"reading_mm": 0.05, "step_mm": 0.5}, "constant", True),
        ({"reading_mm": 0.5, "flat_mm": 0.5, "count": 4}, "constant", True),
    ],
)
def test_intervals_hold_the_truth_as_often_as_they_say(
    case: dict[str, Any], kappa_bar: KappaBarKind, is_peeled: bool
) -> None:
    """Fewer of 150 campaigns have a chance of 1 in 1000 at 95 %; more are too many where errors are random."""
    campaigns = [synthetic_readings(seed, Plastic(kappa_bar_per_mm=0.003), **case) for seed in range(150)]
    fits = [fitted([r for r in c if is_peeled or not r.peeled], kappa_bar=kappa_bar) for c in campaigns]
    least, most = binom.ppf([0.001, 0.999], len(fits), 0.95)
    assert sum(inside(fit) for fit in fits) >= least
    kept = [list(fit.kappa_bar.values())[-1] for fit in fits]
    held = sum(low <= 0.003 <= high for _, low, high in kept)
    assert held >= least
    if not {"step_mm", "flat_mm"} & set(case):
        assert held <= most
    # a good table is not called a bad one
    assert sum(len(fit.outliers) > 0 for fit in fits) <= 7


@pytest.mark.slow
@pytest.mark.parametrize("case", [{}, {"off_mm": 0.01}])
def test_strips_in_two_directions_give_both_moduli_as_often_as_their_intervals_say(case: dict[str, Any]) -> None:
    held = np.zeros(2)
    for seed in range(60):
        part = np.sqrt(np.random.default_rng(seed).uniform(1.0, 3.0))
        readings = synthetic_readings(seed, moduli=(7.0 * part, 7.0 / part), **case)
        fits = fit_directions(readings, StripFitSettings())
        truths = (PAPER / part, PAPER * part)
        held += [inside(fit, truth) for fit, truth in zip(fits, truths, strict=True)]
    assert held.min() >= binom.ppf(0.001, 60, 0.95)


def test_directions_that_do_not_determine_a_material() -> None:
    readings = synthetic_readings(0, moduli=(10.0, 5.0))
    only_along = [r for r in readings if r.peeled or r.direction == "along"]
    with pytest.raises(UndeterminedMaterialError, match=r"^strips across the grain: no strip was measured"):
        fit_directions(only_along, StripFitSettings())
    with pytest.raises(UndeterminedMaterialError, match=r"^strips in two directions and none peeled"):
        fit_directions([r for r in readings if not r.peeled], StripFitSettings())


def test_outliers_are_named_and_used() -> None:
    strips = synthetic_readings(2)
    wrong = {6: 0.045, 17: 0.009, 40: 0.035}
    off = [replace(r, curvature_per_mm=wrong.get(i, r.curvature_per_mm)) for i, r in enumerate(strips)]
    fit = fitted(off)
    assert {one.name for one, _ in fit.outliers} == {strips[i].name for i in wrong}
    assert all(any(one.name in line and "it is used" in line for line in fit.warnings) for one, _ in fit.outliers)
    assert len(fit.used) == 80 and not fit.left_out and inside(fit)
    width = [high - low for _, low, high in (fitted(strips).ratio["paper"], fit.ratio["paper"])]
    assert width[1] > 2 * width[0]
    # of few strips too
    few = synthetic_readings(3, count=2)
    few[0] = replace(few[0], curvature_per_mm=0.06)
    assert few[0] in [one for one, _ in fitted(few).outliers]


def test_a_wrong_thickness_is_named_and_widens_the_interval() -> None:
    good = synthetic_readings(1)
    fit = fitted([replace(r, thickness_mm=0.26) if r.thickness_mm == 0.3 else r for r in good])
    assert any("0.26 mm" in line and "check their thickness" in line for line in fit.warnings)
    assert inside(fit) and not fit.outliers
    width = [high - low for _, low, high in (fitted(good).ratio["paper"], fit.ratio["paper"])]
    assert width[1] > 3 * width[0]


def test_a_kappa_bar_for_each_thickness() -> None:
    table = {"thickness_mm": THICKNESSES_MM, "per_mm": (0.006, 0.004, 0.002, 0.001)}
    strips = synthetic_readings(4, Plastic(kappa_bar_per_mm=table))
    fit = fitted(strips, kappa_bar="per-thickness")
    assert inside(fit) and list(fit.kappa_bar) == list(THICKNESSES_MM) and not fit.warnings
    for value, interval in zip(table["per_mm"], fit.kappa_bar.values(), strict=True):
        assert interval.low - 1e-4 < value < interval.high + 1e-4
    kept = fit.plastic().kappa_bar_per_mm
    assert kept.per_mm == tuple(one.value for one in fit.kappa_bar.values())  # type: ignore[union-attr]
    assert any("try --kappa-bar per-thickness" in line for line in fitted(strips).warnings)


def test_peeled_strips_that_curl_contradict_zero() -> None:
    fit = fitted(synthetic_readings(4), kappa_bar="zero")
    assert not fit.kappa_bar and any("try --kappa-bar constant" in line for line in fit.warnings)
    straight = fitted(synthetic_readings(4, Plastic()), kappa_bar="zero")
    assert inside(straight) and not straight.warnings


def test_peeled_strips_that_look_flat_bound_kappa_bar() -> None:
    strips = [replace(r, curvature_per_mm=None) if r.peeled else r for r in synthetic_readings(0, Plastic())]
    fit = fitted(strips)
    assert fit.kappa_bar[None] == pytest.approx((0.0, -4 / 60**2, 4 / 60**2)) and inside(fit)


def test_one_thickness_gives_an_interval_by_its_repeats() -> None:
    strips = [r for r in synthetic_readings(0) if r.thickness_mm == 0.3]
    fit = fitted(strips)
    assert inside(fit) and fit.freedom > 8
    assert any("print more thicknesses" in line for line in fit.warnings)


def test_strips_that_hardly_bend_leave_no_upper_bound() -> None:
    strips = synthetic_readings(0, Plastic(modulus_ratio=1e5), reading_mm=0.5, count=2)
    fit = fitted(strips, kappa_bar="zero")
    assert np.isinf(fit.ratio["paper"].high) and any("no upper bound" in line for line in fit.warnings)


def test_only_flat_strips_leave_a_bound() -> None:
    strips = [replace(r, curvature_per_mm=None) for r in synthetic_readings(0)]
    # the thinnest strip: 88.3/ratio < 8 * 0.5 / 60^2
    bound = float(rest_curvature(0.3, Fabric(), Plastic(modulus_ratio=1.0))) / (8 * 0.5 / 60**2)
    with pytest.raises(UndeterminedMaterialError, match=f"above {bound:.0f}"):
        fitted(strips)


@pytest.mark.parametrize(
    ("keep", "kappa_bar", "problem"),
    [
        (lambda r: r.peeled, "constant", "with its fabric"),
        (lambda r: not r.peeled and r.thickness_mm == 0.3, "constant", "peel some"),
        (lambda r: not (r.peeled and r.thickness_mm == 0.35), "per-thickness", "no strip of 0.35 mm"),
        (lambda r: r.strip == "1", "constant", "too few"),
    ],
)
def test_too_little(keep, kappa_bar, problem) -> None:
    with pytest.raises(UndeterminedMaterialError, match=problem):
        fitted([r for r in synthetic_readings(0) if keep(r)], kappa_bar=kappa_bar)


@pytest.mark.parametrize(
    ("strips", "formula"),
    [
        ([(0.3, 1.0, False)] * 4 + [(0.3, 0.0, True)] * 2, "paper"),
        ([(0.4, 0.0, False), (0.05, 0.01, False), (0.3, 0.0, False), (5.0, 0.02, False)], "timoshenko"),
        ([(0.3, 0.003, False)] * 3 + [(0.3, 0.004, True)] * 3, "paper"),
    ],
)
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_strips_that_no_plastic_makes_are_refused(
    strips: list[tuple[float, float, bool]], formula: StripFormula
) -> None:
    like = synthetic_readings(0)[0]
    given = [replace(like, thickness_mm=h, curvature_per_mm=k, peeled=bare) for h, k, bare in strips]
    peeled: KappaBarKind = "constant" if any(bare for *_, bare in strips) else "zero"
    with pytest.raises(UndeterminedMaterialError, match=r"no plastic on this fabric|no more than peeled ones"):
        fitted(given, rest_curvature=formula, kappa_bar=peeled)


angles = st.floats(1e-4, 2 * np.pi - 1e-3)
radii = st.floats(1.0, 1e4)


def drawn_box(angle: float, radius: float, thickness: float = 0.0) -> tuple[float, float]:
    """Box of many points of an arc that lies on both sides of the top of its circle, or of its two sides."""
    turn = np.linspace(-angle / 2, angle / 2, 20001)
    rings = [(r * np.sin(turn), r * np.cos(turn)) for r in (radius - thickness / 2, radius + thickness / 2)]
    x, y = np.concatenate(rings, axis=1)
    return float(np.ptp(x)), float(np.ptp(y))


@given(angle=angles, radius=radii)
def test_a_box_is_that_of_the_drawn_arc_and_gives_it_back(angle: float, radius: float) -> None:
    """Beyond half a circle, too, where the box's width is the diameter."""
    width, height = arc_box(1 / radius, angle * radius)
    assert (width, height) == pytest.approx(drawn_box(angle, radius), rel=1e-6, abs=1e-9 * radius)
    assert float(arc_curvature(width, height)) == pytest.approx(1 / radius, rel=1e-9)
    assert float(arc_length(width, height)) == pytest.approx(angle * radius, rel=1e-6)


def test_a_flat_box() -> None:
    assert float(arc_curvature(60.0, 0.0)) == 0.0
    assert float(arc_length(60.0, 0.0)) == 60.0
    assert [float(side) for side in arc_box(0.0, 60.0)] == pytest.approx([60.0, 0.0])
    assert line_box(60.0, 1.0, 1.1) == (60.0, 0.0)
    with pytest.raises(ValueError, match="does not bend"):
        line_box(4.0, 3.0, 1.1)


@given(angle=st.floats(0.05, 6.0), thickness=st.floats(0.1, 1.5))
def test_outside_of_a_thick_strip(angle: float, thickness: float) -> None:
    radius = 30.0
    width, height = drawn_box(angle, radius, thickness)
    if width > 4 * thickness:
        found = line_box(width, height, thickness)
        # the box of the line is that of its own arc, up to what the drawn points leave out
        assert found == pytest.approx(drawn_box(angle, radius), rel=1e-4, abs=1e-4)
