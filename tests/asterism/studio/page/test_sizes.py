"""Star sizes on the page: gradients, formula, picture, brush with symmetry and lines, selections, hatching."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image

from tests.asterism.studio.browser import StudioPage

LASSO = [(-24, -24), (24, -24), (24, 24), (-24, 24), (-24, -23)]  # around the star of the middle and its six neighbours


@pytest.fixture
def page(flat: StudioPage) -> StudioPage:
    flat.open_again("file-plain.toml")
    return flat


def repainted(page: StudioPage, act: Callable[[], None]) -> list[tuple[float, float]]:
    """Places of the stars whose sizes something changes."""
    before = page.get("studio.sizes")
    page.changed(act)
    sites = page.get("studio.document.plan.sites")
    return [tuple(site["at_mm"]) for site, a, b in zip(sites, before, page.get("studio.sizes"), strict=True) if a != b]


def has_image(places: list[tuple[float, float]], x: float, y: float) -> bool:
    return any(abs(x - a) + abs(y - b) < 0.1 for a, b in places)


def is_kind(page: StudioPage, kind: str) -> bool:
    return bool(page.item(f"gradient-kind-{kind}").get_attribute("aria-checked") == "true")


@pytest.mark.parametrize(("kind", "line"), [("linear", ("start_mm", "end_mm")), ("radial", ("centre_mm",))])
def test_a_gradient_is_dragged_from_the_first_value_to_the_second(
    page: StudioPage, kind: str, line: tuple[str, ...]
) -> None:
    page.item("tool-gradient").click()
    page.item(f"gradient-kind-{kind}").click()
    page.rest()
    page.changed(lambda: page.drag((-40.0, 30.0), (35.0, 30.0)))
    profile = page.get("studio.document.design.stars.length_mm")
    assert profile["profile"] == kind and is_kind(page, kind)
    assert [profile[key][0] for key in line] == pytest.approx([-40.0, 35.0][: len(line)], abs=0.5)


def test_a_gradient_over_the_whole_sheet_comes_with_one_click_and_is_taken_back(flat: StudioPage) -> None:
    flat.open("new", "gradient")
    assert is_kind(flat, "number")
    before = flat.get("studio.sizes")
    note = flat.page.locator("#plan-note")
    assert not note.is_visible()
    flat.drag((-40.0, 30.0), (35.0, 30.0))  # draws nothing: the size is the same everywhere
    flat.changed(lambda: flat.item("gradient-kind-linear").click())
    assert "Drag from the first value" in note.inner_text() and not flat.page.locator(".toast.bad").count()
    profile = flat.get("studio.document.design.stars.length_mm")
    assert profile["profile"] == "linear"
    assert profile["start_mm"][0] == pytest.approx(-profile["end_mm"][0])
    flat.changed(lambda: flat.item("undo").click())
    assert is_kind(flat, "number")
    flat.changed(lambda: flat.item("gradient-kind-radial").click())
    message = flat.page.locator(".toast", has_text="radial gradient")  # says what it replaces
    flat.changed(lambda: message.get_by_text("Undo").click())
    assert flat.get("studio.sizes") == before


def test_a_formula_gives_the_sizes_and_a_mistake_in_it_is_told_below(page: StudioPage) -> None:
    page.item("tool-gradient").click()
    page.item("gradient-kind-formula").click()
    page.item("formula").fill("10 - nonsense(x)")
    page.item("use-formula").click()
    page.wait("!document.querySelector('[data-testid=formula-fault]').hidden")
    assert "nonsense" in page.item("formula-fault").inner_text()
    assert page.get("typeof studio.document.design.stars.length_mm.formula") == "undefined"
    page.item("formula").fill("6 + x/50")
    page.changed(lambda: page.item("use-formula").click())
    sites = page.get("studio.document.plan.sites")
    lengths = [size[0] for size in page.get("studio.sizes")]
    assert lengths == pytest.approx([6 + site["at_mm"][0] / 50 for site in sites], abs=1e-6)


def test_a_picture_gives_the_sizes_from_black_to_white(page: StudioPage, tmp_path: Path) -> None:
    Image.linear_gradient("L").rotate(90).save(tmp_path / "skätch.png")
    page.item("tool-gradient").click()
    page.item("gradient-kind-image").click()
    page.fill("image-low", 5)
    page.fill("image-high", 9)
    page.changed(lambda: page.upload("upload-image", tmp_path / "skätch.png"))
    profile = page.get("studio.document.design.stars.length_mm")
    assert (profile["low"], profile["high"], profile["pixels"]) == (5, 9, [256, 256])
    assert profile["image"] == "skätch.png"
    assert is_kind(page, "image")
    stars = list(zip(page.get("studio.document.plan.sites"), page.get("studio.sizes"), strict=True))
    left, right = (end(stars, key=lambda star: star[0]["at_mm"][0])[1][0] for end in (min, max))
    assert left < 6 < 8 < right


def test_the_radius_of_a_brush_follows_the_sheet_until_the_user_changes_it(new_flat: Callable[[], StudioPage]) -> None:
    page = new_flat()
    for name, radius in (("dome", 20), ("star", 11), ("doubly-curved", 35), ("leaf", 6)):
        page.open_without_shape(f"gallery-{name}")
        page.item("tool-brush").click()
        assert page.item("radius").input_value() == str(radius)
    page.fill("target", 1.5)  # another setting of the brush leaves the radius to the sheet
    page.open_without_shape("gallery-dome")
    page.item("tool-weight").click()
    page.fill("weight", 3)
    assert page.item("weight-radius").input_value() == "20"
    page.item("tool-brush").click()
    assert page.item("radius").input_value() == "20"
    page.page.keyboard.press("]")
    changed = page.item("radius").input_value()
    assert float(changed) > 20
    page.open_without_shape("gallery-doubly-curved")
    assert page.item("radius").input_value() == changed
    page.item("tool-weight").click()
    assert page.item("weight-radius").input_value() == "35"


def test_symmetries_repeat_a_stroke_and_a_shifted_click_paints_a_straight_line(page: StudioPage) -> None:
    page.item("tool-brush").click()
    page.fill("target", 4)
    page.fill("radius", 8)
    page.item("mirrorX").check()
    places = repainted(page, lambda: page.drag((45.0, 8.7), (45.0, 9.5)))
    assert len(places) == 2 and all(has_image(places, -x, y) for x, y in places)
    page.item("mirrorX").uncheck()
    page.item("sixfold").check()
    places = repainted(page, lambda: page.drag((15.0, 43.3), (15.0, 43.8)))
    assert len(places) == 6 and all(has_image(places, -x, -y) for x, y in places)
    page.item("sixfold").uncheck()

    def line() -> None:
        page.page.mouse.click(*page.point((-30.0, 17.3)))
        page.page.keyboard.down("Shift")
        page.page.mouse.click(*page.point((30.0, 17.3)))
        page.page.keyboard.up("Shift")

    page.fill("radius", 7)
    places = repainted(page, line)
    assert len(places) == 3 and all(abs(y - 17.3) < 7 for _, y in places)


def test_stars_are_selected_by_lasso_ring_same_size_and_inverted_and_changed(page: StudioPage) -> None:
    page.item("tool-select").click()
    page.drag(*LASSO)
    assert len(page.get("studio.selection")) == 7
    page.page.mouse.click(*page.point((15.0, 8.7)))
    assert len(page.get("studio.selection")) == 1
    page.item("select-ring").click()
    assert len(page.get("studio.selection")) == 6
    page.item("select-invert").click()
    assert len(page.get("studio.selection")) == 31
    page.page.mouse.click(*page.point((0.0, 0.0)))
    page.item("select-same").click()
    assert len(page.get("studio.selection")) == 1
    page.changed(lambda: page.fill("selected-thickness", 0.5))
    assert [size[1] for size in page.get("studio.sizes")].count(0.5) == 1
    page.item("plan").focus()
    page.page.keyboard.press("Escape")
    assert page.get("studio.selection") == []


def test_alt_takes_stars_away_and_sizes_are_copied_to_the_others(page: StudioPage) -> None:
    page.item("tool-select").click()
    page.drag(*LASSO)
    page.page.keyboard.down("Alt")
    page.drag((-6, -6), (6, -6), (6, 6), (-6, 6), (-6, -5))
    page.page.mouse.click(*page.point((15.0, 8.7)))
    page.page.keyboard.up("Alt")
    assert len(page.get("studio.selection")) == 5
    page.item("selecting-less").click()
    page.page.mouse.click(*page.point((-15.0, 8.7)))
    page.item("selecting-new").click()
    assert len(page.get("studio.selection")) == 4
    page.page.mouse.click(*page.point((0.0, 0.0)))
    page.page.keyboard.press("Control+c")
    page.item("selecting-more").click()
    for at in ((0.0, 17.3), (0.0, -17.3)):
        page.page.mouse.click(*page.point(at))
    page.item("selecting-new").click()
    middle = page.get("studio.sizes[0]")
    assert len(repainted(page, lambda: page.page.keyboard.press("Control+v"))) == 2
    assert page.get("studio.sizes").count(middle) == 3
    page.changed(lambda: page.item("undo").click())
    assert page.get("studio.sizes").count(middle) == 1


def test_lattice_spacing_and_arms_are_edited(flat: StudioPage) -> None:
    page = flat
    page.open_again("file-canopy.toml")
    page.item("tab-sheet").click()
    page.fill("lattice-spacing_mm", 18.5)
    page.wait("studio.document.plan.spacing_mm === 18.5 && !studio.isWaiting")
    outline = page.get("studio.document.plan.outline_mm")
    page.item("lattice").select_option("square")
    page.fill("lattice-arms", 4)
    page.fill("lattice-orientation_deg", 45)
    page.wait("studio.document.design.lattice.orientation_deg === 45")
    design, sites = page.get("studio.document.design"), page.get("studio.document.plan.sites")
    assert design["lattice"] == {"kind": "square", "spacing_mm": 18.5, "arms": 4, "orientation_deg": 45}
    assert design["border"]["polygon_mm"] == [[round(value, 3) for value in at] for at in outline]
    assert all(len(site["arms"]) == 4 for site in sites)
    for _ in range(4):
        page.item("undo").click()
    page.wait("studio.document.design.lattice === undefined")
    assert page.get("studio.document.design.border.rings") == 2
