"""Curves on the page: edges that are bent, ellipses that are turned, smooth outlines and holes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import shapely

from tests.asterism.studio.browser import StudioPage

# the README's tests open the page in `test_page` only
pytestmark = pytest.mark.slow


@pytest.fixture
def page(flat: StudioPage) -> StudioPage:
    flat.open_again("file-plain.toml")
    flat.item("tool-outline").click()
    flat.changed(lambda: flat.fill("shape-rings", 2))
    flat.changed(lambda: flat.item("shape-rectangle").click())
    flat.changed(lambda: flat.fill("shape-width", 100))
    flat.changed(lambda: flat.fill("shape-height", 70))
    return flat


def border(page: StudioPage) -> dict[str, Any]:
    table: dict[str, Any] = page.get("studio.document.design.border")
    return table


def dragged(page: StudioPage, start: Sequence[float], end: Sequence[float]) -> float:
    """Drag in the plan; mm between the outline and holes drawn while dragging and those that the server makes."""
    revision = page.get("studio.revision")
    mouse = page.page.mouse
    mouse.move(*page.point(start))
    mouse.down()
    mouse.move(*page.point(end), steps=4)
    drawn = page.get("[studio.sheet.outline, ...studio.sheet.holes]")
    mouse.up()
    page.wait(f"studio.revision !== {revision} && !studio.isWaiting")
    page.rest()
    made = page.get("[studio.document.plan.outline_mm, ...studio.document.plan.holes_mm]")
    pairs = zip(drawn, made, strict=True)
    return max(shapely.hausdorff_distance(*map(shapely.LinearRing, pair)) for pair in pairs)


def test_an_edge_is_bent_by_its_middle_and_by_its_number(page: StudioPage) -> None:
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
    flat.open_again("file-held.toml")
    flat.item("tool-outline").click()

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


def test_an_outline_becomes_a_smooth_curve_through_its_points(page: StudioPage) -> None:
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


def test_an_ellipse_is_turned_by_its_handle_and_by_its_number(page: StudioPage) -> None:
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


def test_holes_have_corners_arcs_and_curves_too(page: StudioPage) -> None:
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
