"""The page of a sweep in a browser: pictures, filter, order, plot, table and details."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from asterism.pattern import gallery
from asterism.results.records.fit import SweepRowRecord
from asterism.sweeps.parameters import SweepParameter
from asterism.sweeps.point import quantities
from asterism.sweeps.sweep import SWEEP_PAGE, Sweep, write_sweep

# of a colour of the page's body, from 0 to 1
BRIGHTNESS = """key => {
    const [red, green, blue] = getComputedStyle(document.body)[key].match(/[0-9]+/g).map(Number);
    return (red + green + blue) / 765;
}"""


def made(path: str = "stars.thickness_mm") -> Sweep:
    """Twelve designs with made-up numbers; the last one has no shape."""
    stream = BytesIO()
    Image.new("RGBA", (40, 30), (200, 60, 40, 255)).save(stream, "WEBP")
    webp = base64.b64encode(stream.getvalue()).decode()
    points, pictures = [], []
    for number in range(1, 13):
        thickness, bending = 0.2 + 0.05 * ((number - 1) % 6), ("paper", "consistent")[(number - 1) // 6]
        values = {each.name: None for each in quantities(False)} | {"height_mm": 20.0 - number}
        values |= {"is_minimum": number != 3, "warnings": "curls tightly" if number == 5 else None}
        parameters = {path: round(thickness, 2), "fabric.bending": bending}
        failed = number == 12
        results, problem = (None, "no <law>") if failed else (values, None)
        points.append(SweepRowRecord(number=number, parameters=parameters, results=results, problem=problem))
        picture = {"webp": webp, "width_px": 40, "height_px": 30, "px_per_mm": 1.0 if number % 2 else 2.0}
        pictures.append(None if failed else picture)
    parameters = (
        SweepParameter(path, (0.2, 0.25, 0.3, 0.35, 0.4, 0.45)),
        SweepParameter("fabric.bending", ("paper", "consistent")),
    )
    return Sweep(gallery.load("dome"), parameters, tuple(points), tuple(pictures), False)


@pytest.fixture
def page(browser: Any, tmp_path: Path) -> Iterator[Any]:
    write_sweep(made(), tmp_path)
    shown = browser.new_page(viewport={"width": 1280, "height": 720})
    errors: list[str] = []
    shown.on("pageerror", lambda error: errors.append(str(error)))
    shown.goto((tmp_path / SWEEP_PAGE).as_uri())
    yield shown
    shown.close()
    assert errors == []


def numbers(page: Any) -> list[int]:
    return [int(each.get_attribute("data-number")) for each in page.query_selector_all("#cards .card")]


@pytest.mark.slow
def test_every_design_has_a_card_and_a_point_and_cards_are_sorted_and_filtered(page: Any) -> None:
    assert numbers(page) == list(range(1, 13))
    assert page.locator("#plot circle").count() == 11 and page.locator("#plot polyline").count() == 2
    assert page.locator('.card[data-number="12"]').inner_text().startswith("no <law>")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.hover('#plot circle[data-number="4"]')
    assert "is-near" in page.locator('.card[data-number="4"]').get_attribute("class")
    page.select_option("#sort", "v:height_mm")
    assert numbers(page) == [11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 12]
    page.click("#direction")
    assert numbers(page) == [*range(1, 12), 12]
    page.click('#filters button:text-is("consistent")')
    page.click('#filters button:text-is("Certified shapes only")')
    assert numbers(page) == [7, 8, 9, 10, 11] and page.locator("#count").inner_text() == "5 of 12 designs"
    assert page.locator("#plot circle").count() == 5
    page.fill('input[aria-label="height from"]', "12")
    assert numbers(page) == [7, 8]
    page.fill('input[aria-label="height from"]', "100")
    assert page.locator("#empty").is_visible() and page.locator("#plot circle").count() == 0
    page.click("#reset")
    assert len(numbers(page)) == 12
    page.select_option("#plot-y", "p:stars.thickness_mm")
    assert page.locator("#plot circle").count() == 12


def test_pictures_have_one_scale(page: Any) -> None:
    def widths() -> list[float]:
        return [page.locator(f'.card[data-number="{number}"] img').bounding_box()["width"] for number in (1, 2)]

    one, other = widths()
    assert one == pytest.approx(2.0 * other, rel=0.02)  # the second has twice the pixels a millimetre
    page.click("#scale")
    one, other = widths()
    assert one == pytest.approx(other)


@pytest.mark.slow
def test_the_table_sorts_by_its_heads_and_rows_open(page: Any) -> None:
    page.click("#view-table")
    page.click('th button:has-text("height, mm")')
    rows = page.query_selector_all("#table tbody tr")
    assert [int(row.get_attribute("data-number")) for row in rows][:3] == [11, 10, 9]
    page.click('#table tr[data-number="5"]')
    details = page.locator("#details").inner_text()
    assert "Design 5" in details and "curls tightly" in details and "stars.thickness_mm = 0.4" in details
    page.click("#close")
    assert not page.locator("#details").is_visible()


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_texts_are_readable_in_both_themes(browser: Any, tmp_path: Path, scheme: str) -> None:
    write_sweep(made(), tmp_path)
    shown = browser.new_page(viewport={"width": 1920, "height": 1080}, color_scheme=scheme)
    shown.goto((tmp_path / SWEEP_PAGE).as_uri())
    text, ground = (shown.evaluate(BRIGHTNESS, key) for key in ("color", "backgroundColor"))
    assert abs(text - ground) > 0.7 and (ground > 0.5) == (scheme == "light")
    shown.close()
