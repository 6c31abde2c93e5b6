"""A pattern of rods on the page: drawn, computed exactly, changed and undone."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.asterism.studio.browser import StudioPage
from tests.asterism.studio.test_patterns import CROSS


def test_a_drawing_rises_by_the_exact_model_and_stays_grey_until_the_next(shared: StudioPage, folder: Path) -> None:
    (folder / "cross.toml").write_text(
        CROSS.replace("edge_mm = 4.0", "edge_mm = 0.7"), encoding="utf-8"
    )  # takes a while
    shared.open("file-cross.toml")
    assert not shared.item("tool-select").is_visible() and not shared.item("tool-weight").is_visible()  # for stars
    assert shared.item("stars").inner_text() == "4 rods"
    shared.item("tool-gradient").click()
    shared.wait("studio.badge.kind === 'exact'")  # without a click
    height = shared.get("studio.height")
    assert height > 1.0
    shared.item("gradient-number").fill("0.6")
    shared.page.keyboard.press("Enter")
    shared.wait("studio.document.design.rods.thickness_mm === 0.6")
    shared.wait("studio.badge.kind === 'computing' && studio.isGrey && studio.stage === 'exact'")
    shared.wait("studio.badge.kind === 'exact' && !studio.isGrey")
    assert shared.get("studio.shownRevision === studio.revision") and shared.get("studio.height") != height
    shared.item("gradient-kind-linear").click()
    shared.wait("studio.document.design.rods.thickness_mm.profile === 'linear'")
    shared.item("undo").click()
    shared.item("undo").click()
    shared.wait("studio.document.design.rods.thickness_mm === 0.4")


def test_the_brush_paints_rods_while_it_is_dragged(flat: StudioPage, folder: Path) -> None:
    (folder / "cross.toml").write_text(CROSS, encoding="utf-8")
    flat.open("file-plain.toml")  # the law of its stars holds no rods to its widths
    flat.open("file-cross.toml", "brush")
    assert not flat.item("quantity-length").is_visible() and not flat.item("mode-remove").is_visible()
    flat.item("quantity-width").click()
    for name, value in (("target", 3), ("radius", 6), ("strength", 100)):
        flat.fill(name, value)
    widest = "Math.max(...studio.rods.flatMap((rod) => rod.width_mm))"
    flat.draw((-10.0, 0.0))
    flat.wait(f"{widest} > 2.9")  # drawn before the server answers
    flat.page.mouse.up()
    flat.wait("studio.document.design.rods.width_mm?.image && !studio.isWaiting")
    drawn = flat.get("studio.document.plan.rods")
    widths = {tuple(at): width for rod in drawn for at, width in zip(rod["points_mm"], rod["width_mm"], strict=True)}
    assert widths[-10.0, 0.0] == pytest.approx(3.0, abs=0.1) and widths[14.0, 0.0] == pytest.approx(1.2)
    assert widths[0.0, 9.0] == 2.0  # the line has a width of its own
    flat.item("tool-gradient").click()  # the panel shows what is painted, as a picture
    flat.item("gradient-quantity-width").click()
    ends = [float(flat.item(f"image-{end}").input_value()) for end in ("low", "high")]
    assert ends == pytest.approx(
        flat.get("(({ low, high }) => [low, high])(studio.document.design.rods.width_mm)"), abs=0.005
    )
    flat.fill("image-high", 2.5)
    flat.wait("studio.document.design.rods.width_mm.high === 2.5 && !studio.isWaiting")
    flat.item("undo").click()
    flat.item("undo").click()
    flat.wait("studio.document.design.rods.width_mm === undefined")
    flat.item("gradient-quantity-thickness").click()


def test_one_line_gets_sizes_of_its_own_and_loses_them(flat: StudioPage, folder: Path) -> None:
    (folder / "two-lines.toml").write_text(CROSS, encoding="utf-8")
    flat.open("file-two-lines.toml", "gradient")
    assert flat.item("sizes-of").input_value() == "rods"
    assert "click a rod" in flat.page.locator("#plan-note").inner_text()
    flat.fill("gradient-number", 50)
    number = "document.querySelector('[data-testid=gradient-number]')"
    assert flat.get(f"{number}.ariaInvalid") == "true"
    (folder / "as-thick.toml").write_text(CROSS, encoding="utf-8")
    flat.open("file-as-thick.toml")  # another design of the same sizes: what was refused is not its own
    assert flat.item("gradient-number").input_value() == "0.4"
    assert flat.get(f"{number}.ariaInvalid") == "false"
    flat.open("file-even.toml")
    assert "rod" not in flat.page.locator("#plan-note").inner_text()
    flat.open("file-two-lines.toml")
    flat.page.mouse.click(*flat.point((0.0, 7.0)))  # on the second line, which has a width of its own
    flat.wait("document.querySelector('[data-testid=sizes-of]').value === 'rods.draw.1'")
    assert not flat.item("drop-own-size").is_visible() and not flat.get("studio.document.can_undo")
    flat.fill("gradient-number", 0.7)
    flat.wait("studio.document.design.rods.draw[1].thickness_mm === 0.7 && !studio.isWaiting")
    assert sorted(flat.get("studio.document.plan.rods.map((rod) => rod.thickness_mm[0])")) == [0.4, 0.4, 0.7, 0.7]
    flat.item("gradient-kind-linear").click()
    flat.wait("studio.document.design.rods.draw[1].thickness_mm.profile === 'linear' && !studio.isWaiting")
    flat.item("drop-own-size").click()
    flat.wait("studio.document.design.rods.draw[1].thickness_mm === undefined")
    for _ in range(3):
        flat.item("undo").click()
    flat.wait("studio.document.saved")
    flat.item("sizes-of").select_option("rods")
