"""The outline on the page: regular shapes, corners, curves, drawings, snapping, holes; ruler and printable area."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import shapely

from tests.asterism.studio.browser import StudioPage

CORNERS_MM = [(0.0, 0.0), (120.0, 0.0), (120.0, 90.0), (60.0, 70.0), (0.0, 90.0)]


@pytest.fixture
def page(flat: StudioPage) -> StudioPage:
    flat.open_again("file-plain.toml", "outline")
    return flat


def outline(page: StudioPage) -> list[list[float]]:
    corners: list[list[float]] = page.get("studio.document.plan.outline_mm")
    return corners


def test_an_outline_comes_from_a_file(page: StudioPage, tmp_path: Path) -> None:
    (tmp_path / "roof.csv").write_text("x_mm,y_mm\n" + "".join(f"{x},{y}\n" for x, y in CORNERS_MM), "utf-8")
    page.changed(lambda: page.upload("upload-outline", tmp_path / "roof.csv"))
    assert len(outline(page)) == 5
    for x, y in CORNERS_MM:
        assert min(abs(x - 60 - a) + abs(y - 45 - b) for a, b in outline(page)) < 0.01


def test_regular_outlines(page: StudioPage) -> None:
    assert page.item("shape-hexagon").get_attribute("aria-checked") == "true"  # the outline that the design has
    page.changed(lambda: page.fill("shape-rings", 2))
    page.changed(lambda: page.item("shape-rectangle").click())
    page.changed(lambda: page.fill("shape-width", 100))
    page.changed(lambda: page.fill("shape-height", 80))
    assert page.get("studio.document.design.border.rectangle_mm") == [100, 80]
    page.changed(lambda: page.item("shape-polygon").click())
    page.changed(lambda: page.fill("shape-sides", 5))
    assert len(outline(page)) == 5
    page.changed(lambda: page.item("shape-l").click())
    corners = outline(page)
    assert len(corners) == 6 and [-5.0, 0.0] in corners and [50.0, 45.0] not in corners
    page.changed(lambda: page.fill("shape-leg", 25))
    assert [-25.0, -20.0] in outline(page)
    page.fill("shape-leg", 95)
    assert page.page.locator(".field", has=page.item("shape-leg")).inner_text().endswith("From 1 mm to 89 mm")
    page.changed(lambda: page.fill("shape-leg", 60))
    page.changed(lambda: page.fill("shape-height", 50))  # a leg has at most half of the width then
    assert page.item("shape-leg").input_value() == "25"
    page.changed(lambda: page.item("shape-hexagon").click())
    assert page.get("studio.document.design.border.rings") == 2
    page.changed(lambda: page.item("undo").click())
    assert page.item("shape-hexagon").get_attribute("aria-checked") == "false"
    assert not page.item("shape-rings").is_visible()


def test_a_shape_with_a_refused_number_is_not_used(page: StudioPage) -> None:
    page.fill("shape-rings", "2.5")
    fault = page.page.locator("[data-field='border.rings'] .fault")
    assert fault.inner_text() == "A whole number, please"
    page.item("shape-rings").fill("2")
    assert not fault.is_visible()  # at once, so that what is below does not move away under a click
    page.changed(lambda: page.item("shape-rings").press("Enter"))
    assert page.get("studio.document.position") == 1  # the refused shape has sent nothing


def test_corners_snap_to_whole_millimetres_and_to_other_corners_unless_snapping_is_off(page: StudioPage) -> None:
    corner, other = outline(page)[0], outline(page)[3]
    page.changed(lambda: page.drag(corner, (corner[0] - 5.3, other[1] + 45.4)))
    x, y = outline(page)[0]
    assert x == round(x) and y == round(y)
    page.changed(lambda: page.drag((x, y), (x - 4.6, outline(page)[2][1] + 0.4)))
    assert outline(page)[0][1] == outline(page)[2][1]
    page.item("snap").click()
    start = tuple(outline(page)[0])
    page.changed(lambda: page.drag(start, (start[0] - 3.37, start[1] - 6.23)))
    page.item("snap").click()
    assert [value == round(value) for value in outline(page)[0]] == [False, False]


def test_the_ruler_measures_and_the_frame_is_in_the_picture(page: StudioPage) -> None:
    page.item("tool-ruler").click()
    page.drag((0.0, 0.0), (30.0, 0.2))
    assert page.get("studio.measured.printed") == pytest.approx(30.0, abs=0.01)
    assert "22.2 mm" in page.item("measured").inner_text()
    frame = page.get("studio.document.plan.printer.frame_mm")
    page.item("plan-print-area").click()
    width = page.get("document.getElementById('plan-canvas').clientWidth")
    left, right = (page.get(f"studio.screenOf([{sign} * {frame[0] / 2}, 0])[0]") for sign in (-1, 1))
    assert 0 < left < right < width
    page.item("plan-print-area").click()


def holes(page: StudioPage) -> list[dict[str, dict[str, object]]]:
    tables: list[dict[str, dict[str, object]]] = page.get("studio.document.design.border.holes ?? []")
    return tables


def test_a_round_hole_is_drawn_moved_resized_and_deleted(page: StudioPage) -> None:
    stars = len(page.get("studio.document.plan.sites"))
    page.changed(lambda: page.drag((0.3, 0.2), (8.0, 0.0)))
    assert holes(page) == [{"circle_mm": {"centre": [0, 0], "radius": 8}}]
    assert len(page.get("studio.document.plan.sites")) == stars - 1  # the star of the middle
    page.changed(lambda: page.drag((0.0, 0.0), (3.2, 2.1)))
    assert holes(page)[0]["circle_mm"]["centre"] == [3, 2]
    page.changed(lambda: page.drag((11.0, 2.0), (13.2, 2.0)))
    assert holes(page)[0]["circle_mm"]["radius"] == 10
    page.page.keyboard.down("Shift")
    page.changed(lambda: page.drag((3.0, 12.0), (3.0, 7.9)))
    page.page.keyboard.up("Shift")
    assert holes(page)[0]["circle_mm"]["radius"] == [10, 6]
    page.drag((3.0, 2.0), (3.0, 400.0))  # as far as there is fabric around it
    page.rest()
    assert page.page.locator("[data-testid=problem]").count() == 0
    page.item("plan").focus()
    page.changed(lambda: page.page.keyboard.press("Delete"))
    assert holes(page) == []
    page.changed(lambda: page.item("undo").click())
    assert len(holes(page)) == 1


def test_a_hole_is_cut_by_the_keyboard_and_typed(page: StudioPage) -> None:
    page.changed(lambda: page.item("add-hole").click())
    page.changed(lambda: page.fill("hole-width", 18))
    assert holes(page)[0]["circle_mm"] == {"centre": [0, 0], "radius": [9, 7]}
    page.item("plan").focus()
    page.changed(lambda: page.page.keyboard.press("+"))
    assert holes(page)[0]["circle_mm"]["radius"] == [10, 8]
    page.fill("hole-x", 500)
    assert "No room" in page.item("problem").inner_text()
    page.page.keyboard.press("Escape")
    page.item("plan").focus()
    page.page.keyboard.press("ArrowRight")
    page.page.keyboard.press("ArrowUp")
    page.changed(lambda: page.page.keyboard.press("Enter"))
    assert len(holes(page)) == 2


def test_holes_that_are_cut_at_once_are_all_there_and_supports_follow_their_numbers(page: StudioPage) -> None:
    twice = "document.querySelector('[data-testid=add-hole]').click()"
    page.changed(lambda: page.get(f"void ({twice}, {twice})"))
    page.wait("(studio.document.design.border.holes ?? []).length === 2")
    page.item("hole-0").click()
    page.changed(lambda: page.item("remove-hole").click())
    (left,) = holes(page)
    page.changed(lambda: page.item("undo").click())
    assert holes(page)[1] == left and page.get("studio.document.plan.hole_rings") == [1, 1]


def test_stars_whose_arms_an_edge_cuts_are_said(page: StudioPage) -> None:
    page.item("tool-select").click()
    page.item("select-all").click()
    page.changed(lambda: page.fill("selected-length", 13))  # the largest size that has a law
    page.item("tool-outline").click()
    page.changed(lambda: page.item("add-hole").click())
    page.item("select-cut").click()
    cut = {",".join(map(str, site)) for site in ([1, 0], [0, 1], [-1, 1], [-1, 0], [0, -1], [1, -1])}
    chosen = set(page.get("studio.selection"))
    reach = "(site) => site.arms.some(([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1]) < 12.9)"
    assert chosen == set(page.get(f"studio.document.plan.sites.filter({reach}).map((site) => site.site.join())"))
    assert chosen & cut


@pytest.fixture
def rectangle(page: StudioPage) -> StudioPage:
    page.changed(lambda: page.fill("shape-rings", 2))
    page.changed(lambda: page.item("shape-rectangle").click())
    page.changed(lambda: page.fill("shape-width", 100))
    page.changed(lambda: page.fill("shape-height", 70))
    return page


def border(page: StudioPage) -> dict[str, Any]:
    table: dict[str, Any] = page.get("studio.document.design.border")
    return table


def dragged(page: StudioPage, start: Sequence[float], end: Sequence[float]) -> float:
    """Drag in the plan; mm between the outline and holes drawn while dragging and those that the server makes."""
    revision = page.get("studio.revision")
    page.draw(start, end)
    drawn = page.get("[studio.sheet.outline, ...studio.sheet.holes]")
    page.page.mouse.up()
    page.wait(f"studio.revision !== {revision} && !studio.isWaiting")
    page.rest()
    made = page.get("[studio.document.plan.outline_mm, ...studio.document.plan.holes_mm]")
    pairs = zip(drawn, made, strict=True)
    return max(shapely.hausdorff_distance(*map(shapely.LinearRing, pair)) for pair in pairs)


def test_an_edge_is_bent_by_its_middle_and_by_its_number(rectangle: StudioPage) -> None:
    page = rectangle
    assert dragged(page, (0.0, -35.0), (1.0, -47.2)) < 0.2
    assert border(page)["bulge_mm"] == [12, 0, 0, 0]
    page.changed(lambda: page.fill("corner-1-bulge", -8.5))
    assert border(page)["bulge_mm"] == [12, -8.5, 0, 0]
    page.fill("corner-1-bulge", 35.5)  # beyond half a circle
    assert page.item("corner-1-bulge").get_attribute("aria-invalid") == "true"
    page.fill("corner-1-bulge", "nan")
    assert page.item("corner-1-bulge").get_attribute("title") == "A number, please"
    page.changed(lambda: page.fill("corner-2-bulge", -20))
    page.drag((0.0, 15.0), (0.0, -100.0))  # arcs that cross are not sent
    page.rest()
    assert page.page.locator("[data-testid=problem]").count() == 0
    assert -50 < border(page)["bulge_mm"][2] < 0
    # a corner on an arc leaves its curve as it is
    page.changed(lambda: page.fill("corner-2-bulge", 0))
    before = shapely.Polygon(page.get("studio.document.plan.outline_mm")).area
    x, y = page.get("studio.document.plan.outline_mm[5]")
    page.changed(lambda: page.page.mouse.click(*page.point((x, y))))
    assert len(border(page)["polygon_mm"]) == 5
    assert shapely.Polygon(page.get("studio.document.plan.outline_mm")).area == pytest.approx(before, rel=1e-3)
    page.item("plan").focus()
    page.changed(lambda: page.page.keyboard.press("Delete"))
    assert border(page)["bulge_mm"] == [0, -8.5, 0, 0]
    page.changed(lambda: page.item("undo").click())
    assert len(border(page)["bulge_mm"]) == 5


@pytest.mark.parametrize("is_clockwise", [False, True])
def test_supports_stay_when_corners_come_and_go(flat: StudioPage, folder: Path, is_clockwise: bool) -> None:
    corners = [[-50, -35], [50, -35], [50, 35], [-50, 35]]  # supports count them so, whatever the order in the file
    (folder / "held.toml").write_text(
        f'name = "held"\n[stars]\nlength_mm = 7.0\n[border]\npolygon_mm = {corners[:: -1 if is_clockwise else 1]}\n'
        "[[pins]]\nedges = [1]\ntarget_mm = [[40, -28, 0], [40, 28, 5]]\n"
        "[[pins]]\ncorners = [0, 3]\nscale = 0.8\n[mesh]\nedge_mm = 0.2\n",
        encoding="utf-8",
    )
    flat.open_again("file-held.toml", "outline")

    def numbers() -> list[list[int]]:
        return [table.get("edges") or table["corners"] for table in flat.get("studio.document.design.pins")]

    flat.changed(lambda: flat.drag((-50.0, 10.0), (-55.0, 10.0)))  # a corner in the edge on the left, the last one
    assert numbers() == [[1], [0, 3]]
    flat.changed(lambda: flat.drag((20.0, -35.0), (20.0, -40.0)))  # in the edge below
    assert numbers() == [[2], [0, 4]]
    flat.changed(lambda: flat.drag((50.0, 15.0), (55.0, 15.0)))  # in the edge that is held
    assert numbers() == [[2, 3], [0, 5]]
    assert flat.get("studio.document.design.pins[0].target_mm") == [[40, -28, 0], [40, 0, 2.5], [40, 28, 5]]
    flat.item("plan").focus()
    flat.changed(lambda: flat.page.keyboard.press("Delete"))
    flat.page.mouse.click(*flat.point((20.0, -40.0)))
    flat.changed(lambda: flat.page.keyboard.press("Delete"))
    assert numbers() == [[1], [0, 3]]
    assert flat.get("studio.document.design.pins[0].target_mm") == [[40, -28, 0], [40, 28, 5]]
    flat.page.mouse.click(*flat.point((50.0, 35.0)))  # an end of the edge that is held
    flat.changed(lambda: flat.page.keyboard.press("Delete"))
    assert numbers() == [[0, 2]]
    flat.changed(lambda: flat.item("undo").click())
    assert numbers() == [[1], [0, 3]]


def test_an_outline_becomes_a_smooth_curve_through_its_points(rectangle: StudioPage) -> None:
    page = rectangle
    page.changed(lambda: page.item("outline-kind-spline").click())
    assert border(page) == {"spline_mm": [[-50, -35], [50, -35], [50, 35], [-50, 35]]}
    assert dragged(page, (50.0, 35.0), (40.0, 30.0)) < 0.2
    assert border(page)["spline_mm"][2] == [40, 30]
    curve = page.get("studio.document.plan.outline_mm")
    at = min(curve, key=lambda point: abs(point[0]) + (1000 if point[1] > 0 else 0))
    page.changed(lambda: page.drag(at, (0.0, -30.0)))
    assert border(page)["spline_mm"][1] == [0, -30]
    page.item("plan").focus()
    page.changed(lambda: page.page.keyboard.press("Delete"))
    assert len(border(page)["spline_mm"]) == 4
    page.fill("corner-0-x", 200)
    assert "must not cross" in page.item("problem").inner_text()
    page.page.keyboard.press("Escape")
    page.changed(lambda: page.item("outline-kind-circle").click())
    assert set(border(page)) == {"circle_mm"}


def test_an_ellipse_is_turned_by_its_handle_and_by_its_number(rectangle: StudioPage) -> None:
    page = rectangle
    page.changed(lambda: page.item("shape-circle").click())
    assert page.item("outline-turn").input_value() == "0"
    beyond = 26 / page.get("studio.screenOf([1, 0])[0] - studio.screenOf([0, 0])[0]")
    assert dragged(page, (50.0 + beyond, 0.0), (50.0, 28.5)) < 0.2
    assert border(page)["circle_mm"] == {"centre": [0, 0], "radius": [50, 35], "turn_deg": 30}
    page.changed(lambda: page.fill("outline-turn", -90))
    assert dragged(page, (0.0, -50.0), (0.3, -55.8)) < 0.2
    assert border(page)["circle_mm"] == {"centre": [0, 0], "radius": [56, 35], "turn_deg": -90}
    # of the same axes: a circle, which has no direction
    page.changed(lambda: page.fill("outline-width", 70))
    assert border(page)["circle_mm"] == {"centre": [0, 0], "radius": 35}


def test_holes_have_corners_arcs_and_curves_too(rectangle: StudioPage) -> None:
    page = rectangle
    page.changed(lambda: page.item("add-hole").click())
    page.changed(lambda: page.item("hole-kind-spline").click())
    (table,) = border(page)["holes"]
    assert len(table["spline_mm"]) == 8
    x, y = table["spline_mm"][0]
    assert dragged(page, (x, y), (x + 6.0, y)) < 0.2
    assert border(page)["holes"][0]["spline_mm"][0] == [pytest.approx(x + 6.0, abs=0.6), y]
    page.changed(lambda: page.item("hole-kind-polygon").click())
    for _ in range(5):
        page.changed(lambda: page.item("remove-hole-corner-0").click())
    assert len(border(page)["holes"][0]["polygon_mm"]) == 3 and page.item("remove-hole-corner-0").is_disabled()
    page.changed(lambda: page.fill("hole-corner-0-bulge", 2))
    assert border(page)["holes"][0]["bulge_mm"] == [2, 0, 0]
    page.fill("hole-corner-1-x", 90)
    assert "No room" in page.item("problem").inner_text()
    page.changed(lambda: page.fill("hole-x", 20))
    assert border(page)["holes"][0]["bulge_mm"] == [2, 0, 0]
