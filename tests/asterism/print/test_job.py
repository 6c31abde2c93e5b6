"""Rounded for the printer, on its bed, within the frame, with its needles."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from asterism import Design, ExportSettings, export, save_design
from asterism.pattern import gallery
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.layout.build import layout
from asterism.print import printer as profiles
from asterism.print.bed_placement import frame_warning, size_warning
from asterism.print.formats.needle_table import write_needle_table
from asterism.print.job import Job, print_cost
from asterism.print.needles import needles
from asterism.print.printer import adjusted_printer, load_printer
from asterism.print.rounding import better_layers, choose_rounding, size_changes
from asterism.print.solid import height_steps
from tests.asterism.print.jobs import Run, design, job
from tests.asterism.sheets import sheet


def rectangle(width: float, depth: float, fabric: dict[str, Any] | None = None) -> Design:
    """On a fabric of two stretches, if no other is given."""
    more = {} if fabric is None else {"fabric": fabric}
    return design(stars={"length_mm": 8.0}, border={"rectangle_mm": [width, depth]}, pins=[], **more)


@pytest.mark.parametrize(("thickness", "first"), [(0.3, 0.3), (0.4, 0.2), (0.45, 0.2)])
def test_the_first_layer_suits_the_design(thickness: float, first: float) -> None:
    """Equally good: the printer's usual one."""
    plan = layout(design(stars={"length_mm": 8.0, "thickness_mm": thickness}))
    assert choose_rounding(plan, load_printer("ultimaker2")).first_layer_mm == first


def test_changes_are_counted_in_stars() -> None:
    one = job()
    said = size_changes(one.drawn_plan, one.plan)["thickness"]
    exact, rounded = one.drawn_plan.arm_thickness[:, 0], one.plan.arm_thickness[:, 0]
    assert said["stars_changed"] == len(np.unique(one.plan.arm_star[np.abs(exact - rounded) > 1e-6]))
    assert abs(said["largest_change_mm"]) == pytest.approx(np.abs(exact - rounded).max())
    assert said["values_mm"] == pytest.approx(np.unique(rounded))
    assert size_changes(one.plan, one.plan)["width"]["stars_changed"] == 0


def test_better_layers_are_named_where_there_are_any() -> None:
    plan = layout(design(stars={"length_mm": 8.0, "thickness_mm": 0.35}))
    coarse = Rounding(first_layer_mm=0.2, layer_mm=0.2, line_mm=0.4)
    better = better_layers(plan, coarse)
    assert better is not None and better.thickness(np.array([0.35])) == pytest.approx(0.35)
    assert better_layers(plan, better) is None


of_gallery = cache(lambda name: job(gallery.load(name)))


@pytest.mark.slow
@pytest.mark.parametrize("name", gallery.names())
def test_the_gallery_fits_the_papers_printer(name: str) -> None:
    one = of_gallery(name)
    assert not one.placement.shift.any()
    for solid in one.solids:
        assert solid.box[0].min() >= 0 and solid.box[1, :2].max() <= 223.0


def test_a_print_that_hangs_over_is_moved_onto_the_bed() -> None:
    # arms point down: the plastic is not symmetric about the origin
    one = job(printer={"bed_mm": (76.0, 83.0)})
    low, high = np.reshape(shapely.bounds(one.pattern[0].region), (2, 2))
    assert one.placement.shift[0] == 0 and one.placement.shift[1] > 0
    assert low[1] == pytest.approx(-41.5, abs=0.002)
    assert (low >= np.array([-38.0, -41.5])).all() and (high <= np.array([38.0, 41.5])).all()
    # the border does not fit any more, and is left out
    assert one.border is None and len(one.solids) == 1


def test_a_sheet_drawn_away_from_the_origin_lies_in_the_middle() -> None:
    corners = np.array([[100.0, 100.0], [200.0, 100.0], [200.0, 200.0], [100.0, 200.0]])
    for margin in (8.0, 25.0):  # of stars that would be on the bed far from its middle, and of some that would not
        border = {"polygon_mm": corners.tolist(), "star_margin_mm": margin}
        one = job(design(stars={"length_mm": 7.0}, border=border, pins=[{"where": "border", "scale": 0.8}]))
        assert one.placement.points(corners).mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-3)
        assert one.border is not None
        assert all(np.abs(one.placement.points(n.printed)).max() < 111.5 for n in one.needles)


def test_larger_than_the_bed_and_larger_than_the_frame() -> None:
    with pytest.raises(DesignError, match=r"stars = '224\.5 x .*': must be within the 223\.0 x 223\.0 mm"):
        job(rectangle(240.0, 100.0))
    # what is only described may be of any size
    assert "must be within the 223.0 x 223.0 mm" in job(rectangle(240.0, 100.0), any_size=True).too_large
    assert job(any_size=True).too_large == ""
    wide = {"rectangle_mm": [270.0, 100.0], "star_margin_mm": 40.0}
    with pytest.raises(DesignError, match=r"border = '270.0 x 100.0 mm of fabric': must be within the frame of 260.0"):
        job(design(stars={"length_mm": 8.0}, border=wide, pins=[]))


@pytest.mark.parametrize(
    ("sides", "printer", "turned", "words"),
    [
        ((240.0, 60.0), {}, 0.0, ""),
        ((280.0, 40.0), {}, 0.0, ""),  # only if the fabric fits the frame too
        ((150.0, 40.0), {"frame": {"size_mm": (150.0, 190.0), "bar_mm": 15.0}}, 0.0, "between the bars of the frame"),
        ((240.0, 60.0), {"bed_mm": (250.0, 100.0)}, 40.0, ""),  # the advice is to turn it back
    ],
)
def test_a_turn_that_helps_is_named_and_does(
    sides: tuple[float, float], printer: dict[str, Any], turned: float, words: str
) -> None:
    bar = rectangle(*sides, fabric={})
    with pytest.raises(DesignError, match=rf"{words}.*--turn [0-9]+ makes it fit$") as caught:
        job(bar, printer, turn_deg=turned)
    turn = float(str(caught.value).split("--turn ")[1].split()[0])
    assert (turn == 0.0) == (turned != 0.0)
    roomy = {"bed_mm": (300.0, 300.0), "frame": {"size_mm": (400.0, 400.0)}}
    one, straight = job(bar, printer, turn_deg=turn), job(bar, roomy)
    assert one.solids[0].volume_mm3 == pytest.approx(straight.solids[0].volume_mm3, rel=1e-4)
    assert (np.ptp(one.solids[0].box[:, :2], axis=0) <= one.printer.bed_mm).all()


def test_a_fabric_stretched_differently_in_x_and_y_cannot_be_turned_under_its_print() -> None:
    with pytest.raises(DesignError, match=r"--turn = 20\.0: must be 0 on a fabric"):
        job(rectangle(240.0, 60.0), turn_deg=20.0)
    with pytest.raises(DesignError, match=r"reaches$"):
        job(rectangle(240.0, 60.0))


@pytest.mark.slow
def test_nothing_is_printed_on_the_bars_of_the_frame() -> None:
    """Here the nozzle reaches beyond the frame."""
    bed = {"bed_mm": (300.0, 300.0)}

    def framed(size_mm: float, bar_mm: float) -> dict[str, Any]:
        return bed | {"frame": {"size_mm": (size_mm, size_mm), "bar_mm": bar_mm}}

    wide, deep = np.ptp(np.reshape(shapely.bounds(job(printer=bed).pattern[0].region), (2, 2)), axis=0)
    edge = float(np.ceil(max(wide, deep)))
    words = rf"stars = '{wide:.1f} x {deep:.1f} mm of plastic': must be within the 70\.0 x 70\.0 mm between the bars"
    with pytest.raises(DesignError, match=words):
        job(printer=framed(100.0, 15.0))
    # the plastic has room, the printed line around it has not
    tight = job(printer=framed(edge + 30.0, 15.0))
    assert tight.border is None
    low, high = np.reshape(shapely.bounds(tight.pattern[0].region), (2, 2))
    assert (low >= -edge / 2 - 1e-6).all() and (high <= edge / 2 + 1e-6).all()
    assert job(printer=framed(edge + 30.0, 5.0)).border is not None


def test_wider_arms_that_run_into_each_other_are_refused() -> None:
    """Arms of 1.0 mm that lie 1.14 mm apart become 1.2 mm wide."""
    close = {"length_mm": 16.0, "width_mm": 1.0}
    layout(design(stars=close, pins=[]))
    with pytest.raises(DesignError, match=r"would print as one.*rounded for the Ultimaker 2\+"):
        job(design(stars=close, pins=[]))


def test_needles_along_edges_are_evenly_spaced_and_not_doubled() -> None:
    one = job(design(pins=[{"edges": [0, 1], "scale": 0.8}]), needle_spacing_mm=10.0)
    corners = one.plan.outline[[0, 1, 2]]
    printed = np.array([needle.printed for needle in one.needles])
    side = np.linalg.norm(corners[1] - corners[0])
    pieces = int(np.ceil(side / 10.0))
    assert len(printed) == 2 * pieces + 1
    line = shapely.LineString(corners)
    along = np.sort([line.project(shapely.Point(point)) for point in printed])
    assert np.diff(along) == pytest.approx(side / pieces)
    assert [needle.number for needle in one.needles] == list(range(1, len(printed) + 1))


def test_needles_that_slide_need_a_shape() -> None:
    held = [{"corners": [0], "target_mm": [1.0, 2.0, 3.0]}, {"corners": [3], "slide": "plane"}]
    fixed, free = job(design(border={"rectangle_mm": [80.0, 60.0]}, pins=held)).needles
    assert fixed.place == pytest.approx([1.0, 2.0, 3.0]) and free.place is None and free.slides == "plane"
    flat = sheet(lambda p: np.column_stack([0.5 * p, np.full(len(p), 7.0)]), 80.0, 60.0)
    plan = layout(design(border={"rectangle_mm": [80.0, 60.0]}, pins=held))
    fixed, free = needles(plan, 20.0, flat)
    assert fixed.place == pytest.approx([1.0, 2.0, 3.0])
    # x and y from the shape, z held on the ground
    assert free.place == pytest.approx([*(0.5 * plan.outline[3]), 0.0])


def test_needles_that_slide_along_z_have_a_place_and_no_height(tmp_path: Path) -> None:
    pins = [{"corners": [0], "target_mm": [30.0, 4.0, 3.0]}, {"corners": [3], "scale": 0.8, "slide": "z"}]
    held, slides = job(design(pins=pins)).needles
    assert held.height_mm == 3.0 and slides.height_mm is None and not slides.is_raised
    assert slides.place is not None and slides.place[:2] == pytest.approx(0.8 * slides.printed)
    write_needle_table(tmp_path / "needles.csv", (held, slides))
    rows = [line.split(",") for line in (tmp_path / "needles.csv").read_text().splitlines()]
    assert rows[1][3:6] == ["30.000", "4.000", "3.000"]
    assert [float(text) for text in rows[2][3:5]] == pytest.approx(0.8 * slides.printed, abs=1e-3)
    assert rows[2][5:7] == ["", "z"]
    # nothing holds any height: there is none to count from
    assert [needle.height_mm for needle in job(design(pins=pins[1:])).needles] == [None]


def test_a_shape_of_another_design_or_made_from_other_entries_is_refused() -> None:
    flat = sheet(lambda p: np.column_stack([p, np.zeros(len(p))]), 80.0, 60.0)
    with pytest.raises(DesignError, match=r"^shape = 'a sheet of 80.0 x 60.0 mm': must be of this design"):
        job(shape=flat)
    mine = design(border={"rectangle_mm": [80.0, 60.0]}, pins=[{"corners": [0]}])
    stars = len(layout(mine).centres)
    same = replace(flat, star_vertices=flat.star_vertices[:stars], summary={"design": mine.to_dict()})
    # rounding and mesh may differ
    assert job(job(mine).design.model_copy(update={"name": "other"}), shape=same).shape is same
    changes: dict[str, dict[str, Any]] = {
        "its stars are others": {"stars": {"length_mm": 7.0}},
        "its pins are others": {"pins": []},
        "its fabric was stretched otherwise": {"fabric": {"stretch": 1.2}},
        "its material is another": {"plastic": {"modulus_ratio": 1000.0}},
        "its own has a mistake: fabric.stretch": {"fabric": {"stretch": "x"}},
    }
    for words, change in changes.items():
        with pytest.raises(DesignError, match=rf"^shape: must be of this design, but {words}"):
            job(mine, shape=replace(same, summary={"design": mine.to_dict() | change}))


def test_estimate_of_a_single_star_by_hand() -> None:
    one = job(design(stars={"length_mm": 8.0, "thickness_mm": 0.4}, border={"rings": 0}, pins=[]), border=False)
    cost = print_cost([one.pattern], one.printer, one.rounding, one.plastic)
    area = one.pattern[0].region.area
    speed = one.printer.speed
    assert cost["volume_mm3"] == pytest.approx(0.4 * area)
    assert cost["mass_g"] == pytest.approx(0.4 * area * 1.22e-3)
    assert cost["filament_m"] == pytest.approx(0.4 * area / (np.pi / 4 * 2.85**2) / 1000)
    assert cost["layers"] == 2
    seconds = area / 0.4 / speed.first_layer_mm_s + area / 0.4 / speed.print_mm_s + 2 * speed.island_s
    assert cost["minutes"] == pytest.approx(speed.heating_min + seconds / 60)


@pytest.mark.slow
def test_prints_of_the_papers_size_take_about_its_twenty_minutes() -> None:
    minutes = []
    for name in ("roof", "tunnel", "u-shape", "doubly-curved"):
        one = of_gallery(name)
        minutes.append(print_cost([one.pattern], one.printer, one.rounding, one.plastic)["minutes"])
    assert 10 < np.mean(minutes) < 30


@pytest.mark.parametrize("ends", [(0.6, 0.33), (0.53, 0.6), (0.2, 0.25)])
def test_arms_change_height_where_their_rounding_does(ends: tuple[float, float]) -> None:
    """Tips that the border cut off are no whole number of layers high."""
    rounding = Rounding(first_layer_mm=0.2, layer_mm=0.1, line_mm=0.4)
    heights, at = height_steps(np.array(ends), rounding)
    along = np.linspace(0.0, 1.0, 1001)
    along = along[np.abs(along[:, None] - at).min(axis=1) > 1e-6]
    wanted = rounding.thickness(ends[0] + along * (ends[1] - ends[0]))
    np.testing.assert_allclose(heights[np.searchsorted(at, along) - 1], wanted, atol=1e-9)


def test_needles_go_around_holes() -> None:
    square = [[5, -5], [15, -5], [15, 5], [5, 5]]
    holes = [{"circle_mm": {"centre": [-9, 0], "radius": 6}}, {"polygon_mm": square}]
    border = {"rectangle_mm": (40.0, 40.0), "holes": holes}
    pins = [{"holes": [0, 1], "scale": 0.9, "offset_mm": [0.0, 0.0, 5.0]}]
    plan = layout(
        Design.from_dict({"rods": {"draw": [{"line_mm": [(-19, 16), (19, 16)]}]}, "border": border, "pins": pins})
    )
    placed = needles(plan, 5.0)
    printed = np.array([needle.printed for needle in placed])
    on_circle = np.abs(np.linalg.norm(printed - [-9.0, 0.0], axis=1) - 6.0) < 0.05
    assert on_circle.sum() == 8  # 37.7 mm around, at most 5 mm apart
    others = printed[~on_circle]
    assert len(others) == 8 and np.abs(others - [10.0, 0.0]).max(axis=1) == pytest.approx(5.0)
    assert [needle.place[2] for needle in placed if needle.place is not None] == [5.0] * 16


def test_a_large_print_is_named_with_the_printers_and_fits_a_printer_of_the_user(tmp_path: Path) -> None:
    wide = rectangle(300.0, 120.0, fabric={})
    (line,) = size_warning(wide)
    assert "300 x 120 mm" in line and "Ultimaker 2+ 223 x 223 mm" in line and "Prusa MK4 250 x 210 mm" in line
    text = (Path(profiles.__file__).parent / "data/printers/ultimaker2.toml").read_text()
    folder = tmp_path / "home" / "printers"
    folder.mkdir(parents=True)
    (folder / "long.toml").write_text(
        text.replace("[223.0, 223.0]", "[130.0, 330.0]").replace("[260.0, 260.0]", "[160.0, 370.0]")
    )
    # it fits after a quarter of a turn, which a fabric of two stretches does not allow
    assert not list(size_warning(wide))
    assert list(size_warning(rectangle(300.0, 120.0)))
    # a file with a mistake does not hide the other printers
    (folder / "wrong.toml").write_text("name = 3\n")
    assert not list(size_warning(wide))


@pytest.mark.slow
def test_the_frame_is_an_option(here: Path, run: Run) -> None:
    save_design(seven(), here / "d.toml")
    words = ["export", "d.toml", "--printer", "ender-3"]
    # in the way of exports with a shape only
    (in_the_way := here / "d-print" / "shape.vtu").mkdir(parents=True)
    default = run(*words).done
    in_the_way.rmdir()
    assert "the frame of 260 x 260 mm is larger than the bed of 220 x 220 mm" in default.err
    assert "larger than the bed" not in run(*words, "--frame", "200x180").done.err
    assert "frame of 200 x 180 mm" in " ".join((here / "d-print" / "instructions.txt").read_text().split())
    for wrong in ("wide", "5x5", ""):
        assert "--frame" in run(*words, f"--frame={wrong}").refusal


def test_a_frame_that_stands_out_over_the_bed_is_named() -> None:
    assert not list(frame_warning(adjusted_printer(ExportSettings(frame_mm=(220.0, 220.0)))))
    assert list(frame_warning(adjusted_printer(ExportSettings(frame_mm=(260.0, 260.0)))))


def seven(**stars: Any) -> Design:
    """Stars on the paper's fabric."""
    return design(fabric={}, stars={"length_mm": 8.0, "thickness_mm": 0.4} | stars, border={"rings": 1}, pins=[])


def volumes(one: Job) -> dict[str, dict[str, float]]:
    return {name: {solid.name: solid.volume_mm3 for solid in solids} for name, solids in one.prints.items()}


def test_plastic_below_is_a_print_of_its_own_and_mirrored_and_all_below_is_one_print() -> None:
    whole, both = volumes(job(seven())), job(seven(override=[{"star": 1, "side": "below"}]))
    parts = volumes(both)
    assert list(parts) == ["print", "print-below"] and list(parts["print"]) == ["stars", "border"]
    assert list(parts["print-below"]) == ["stars-below"]
    below = parts["print-below"]["stars-below"]
    assert below == pytest.approx(whole["print"]["stars"] / 7.0, rel=1e-3)
    assert parts["print"]["stars"] + below == pytest.approx(whole["print"]["stars"], rel=1e-6)
    # the star is right of the middle of the bed, and left of it with the frame turned over
    (low, high), (star,) = both.prints["print-below"][0].box, both.plan.centres[both.plan.star_side < 0]
    across = both.placement.points(star)[0]
    assert across > 5.0 and 0.5 * (low + high)[0] == pytest.approx(both.printer.bed_centre_mm[0] - across, abs=0.01)
    turned = volumes(job(seven(side="below")))
    assert list(turned) == ["print"] and list(turned["print"]) == ["stars-below", "border"]
    assert list(turned["print"].values()) == pytest.approx(list(whole["print"].values()), rel=1e-6)


@pytest.mark.slow
def test_the_export_has_both_prints_and_says_how_to_make_them(tmp_path: Path) -> None:
    done = export(seven(override=[{"star": 1, "side": "below"}]), tmp_path)
    assert {"print.3mf", "print-below.3mf", "stars.stl", "stars-below.stl"} <= set(done.files)
    assert not {"stars.scad", "stars.lua"} & set(done.files)
    assert any("OpenSCAD and IceSL are left out" in line for line in done.warnings)
    text = " ".join((tmp_path / "instructions.txt").read_text(encoding="utf-8").split())
    assert "First print print-below.3mf" in text and "0.4 mm higher than start.gcode" in text
