"""The view in space: the sheet without bumps, and the target surface."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from tests.asterism.studio.browser import IS_MEASURED, StudioPage


def cap(path: Path, half_mm: float = 40.0) -> Path:
    """A square part of a sphere, away from the origin."""
    grid = np.linspace(-half_mm, half_mm, 16)
    x, y = (values.ravel() for values in np.meshgrid(grid, grid))
    number = np.arange(256).reshape(16, 16)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    triangles = np.concatenate([np.stack(part, axis=-1).reshape(-1, 3) for part in ((a, b, c), (a, c, d))])
    points = np.column_stack([x, y, np.sqrt(90.0**2 - x**2 - y**2)]) + 300.0
    trimesh.Trimesh(points, triangles, process=False).export(path)
    return path


def test_bumps_are_left_out_and_a_target_is_laid_on_the_sheet_and_a_reload_keeps_both(
    shared: StudioPage, tmp_path: Path
) -> None:
    page = shared
    page.open_again("file-plain.toml")
    assert not page.get("studio.isSmooth")
    page.item("show-bumps").click()
    page.wait("studio.isSmooth")
    page.load_target(cap(tmp_path / "cap.stl"))
    assert page.get("studio.ghost") == 450
    fitted = page.get("studio.targetDistance.rms_mm")
    assert 0.1 < fitted < 5.0
    page.item("view-colour").select_option("target")
    page.wait("!document.querySelector('[data-testid=legend]').hidden")
    assert "target" in page.item("legend").inner_text()

    page.page.reload()
    page.wait(f"window.studio && studio.connected && studio.isSmooth && studio.ghost === 450 && {IS_MEASURED}")
    assert page.get("studio.targetDistance.rms_mm") == pytest.approx(fitted)
    page.item("show-bumps").click()
    page.wait("!studio.isSmooth")
    page.item("tab-shape").click()
    page.item("file-target").click()
    page.wait(f"!studio.target.is_fitted && {IS_MEASURED}")
    assert page.get("studio.targetDistance.rms_mm") > 100.0
    page.item("show-target").uncheck()
    page.wait("studio.ghost === 0")
    page.item("show-target").check()
    page.item("remove-target").click()
    page.wait("!studio.target")
    assert page.item("view-colour").input_value() == "none"


def violet(page: StudioPage) -> int:
    """Pixels of a saved picture with the colour of the ghost."""
    page.item("picture").click()
    page.fill("picture-width", 400)
    page.fill("picture-height", 300)
    with page.page.expect_download() as download:
        page.item("picture-go").click()
    red, green, blue = np.asarray(Image.open(Path(download.value.path())).convert("RGB"), dtype=int).transpose(2, 0, 1)
    return int((np.minimum(red, blue) - green > 15).sum())


def test_a_saved_picture_shows_the_target_only_beside_the_distance_to_it(shared: StudioPage, tmp_path: Path) -> None:
    page = shared
    page.open_again("file-plain.toml")
    page.load_target(cap(tmp_path / "cap.stl"))
    assert violet(page) == 0 and page.get("studio.ghost") == 450
    page.item("view-colour").select_option("target")
    page.wait("!document.querySelector('[data-testid=legend]').hidden")
    with_ghost = violet(page)
    page.item("show-target").uncheck()
    page.wait("studio.ghost === 0")
    assert with_ghost - violet(page) > 100
    page.item("show-target").check()
    page.item("view-colour").select_option("none")
    page.item("remove-target").click()
    page.wait("!studio.target")


def test_a_shape_that_is_forgotten_before_it_is_drawn_does_not_stop_the_next_ones(shared: StudioPage) -> None:
    page = shared
    page.open_again("file-plain.toml")
    hold = "window.requestAnimationFrame = (draw) => held.push(draw)"
    page.get(f"void (window.held = [], window.paint = requestAnimationFrame, {hold})")
    page.open_without_shape("file-even.toml")
    page.wait("studio.stage !== null && held.length > 0")
    page.open_without_shape("file-canopy.toml")
    page.get("(window.requestAnimationFrame = window.paint, held.forEach((draw) => draw()))")
    page.rest()
    drawn = page.get("studio.drawn")
    page.item("ortho").click()
    page.wait(f"studio.drawn > {drawn}")


def test_the_camera_follows_a_sheet_that_leaves_the_picture_or_becomes_small(shared: StudioPage) -> None:
    page = shared
    page.open_again("file-seven.toml", "outline")

    def distance() -> float:
        return float(page.get("studio.camera.distance"))

    def rings(number: int) -> float:
        page.changed(lambda: page.fill("shape-rings", number))
        return distance()

    def is_seen() -> bool:
        corners = page.get("studio.document.plan.outline_mm.map(([x, y]) => studio.viewOf([0.74 * x, 0.74 * y, 0]))")
        box = page.item("view").bounding_box()
        return all(0 <= x <= box["width"] and 0 <= y <= box["height"] for x, y in corners)

    near = distance()
    far = rings(3)
    assert far > 1.5 * near and is_seen()
    assert rings(1) == pytest.approx(near, rel=0.05)
    # nothing moves under a hand, only when it has let go
    corner = page.get("studio.document.plan.outline_mm[0]")
    page.draw(corner, [2.5 * value for value in corner])
    page.wait("studio.stage === 'equilibrium' && studio.shownRevision > studio.revision")
    assert distance() == pytest.approx(near, rel=0.05)
    page.changed(page.page.mouse.up)
    assert distance() > 1.2 * near
    page.changed(lambda: page.item("undo").click())
    # a hand has turned it: only a sheet that leaves the picture is fitted again
    rings(3)
    box = page.item("view").bounding_box()
    page.press((box["x"] + 20, box["y"] + 200), (box["x"] + 60, box["y"] + 200))
    page.page.mouse.up()
    turned = page.get("studio.camera.turn")
    assert rings(1) == pytest.approx(far, rel=0.05)
    page.page.mouse.wheel(0, -200)
    page.wait(f"studio.camera.distance < {0.9 * far}")
    assert rings(3) > 0.9 * far and page.get("studio.camera.turn") == turned
    # a part that a hand has chosen stays
    page.page.mouse.wheel(0, -800)
    page.wait(f"studio.camera.distance < {0.5 * far}")
    chosen = distance()
    assert rings(2) == chosen


def test_the_light_of_the_sky_is_there_for_each_shape_of_a_surface(shared: StudioPage) -> None:
    errors = """async () => {
        const { Renderer } = await import("./page/view/gl.js");
        const renderer = new Renderer(document.createElement("canvas"));
        const [{ gl }, surface] = [renderer, renderer.makeSurface()];
        const camera = { matrix: new Float32Array(16).fill(1), eye: [0, 0, 1], towards: [0, 0, 1] };
        const errors = [];
        for (const size of [1, 2]) {
            const normals = new Float32Array([0, 0, 1, 0, 0, 1, 0, 0, 1]);
            const positions = new Float32Array([0, 0, 0, size, 0, 0, 0, size, 0]);
            renderer.fill(surface, { positions, normals, triangles: new Uint32Array([0, 1, 2]) });
            const surfaces = [{ surface, base: [1, 1, 1], casts: true }];
            renderer.shade(surfaces, { low: [0, 0, 0], high: [size, size, 1] }, 1);
            renderer.draw({ surfaces, camera, width: 8, height: 8, isSoft: true });
            errors.push(gl.getError());
        }
        gl.getExtension("WEBGL_lose_context").loseContext();
        return errors;
    }"""
    assert shared.page.evaluate(errors) == [0, 0]


TABLET = {"viewport": {"width": 1024, "height": 768}, "device_scale_factor": 0.5, "has_touch": True, "is_mobile": True}


def test_a_tablet_has_bars_of_one_row_and_the_menu_has_what_does_not_fit(browser: Any, address: str) -> None:
    context = browser.new_context(**TABLET)
    page = StudioPage(context.new_page(), address)
    page.open("file-plain.toml")
    for bar in ("plan-bar", "view-bar"):
        tops = page.get(
            f"[...document.querySelectorAll('#{bar} :is(select, button)')].filter((one) => one.offsetParent)"
            ".map((one) => Math.round(one.getBoundingClientRect().bottom))"
        )
        assert len(tops) > 3 and max(tops) - min(tops) <= 1, bar
    note = page.page.locator("#plan-note").inner_text()
    assert "Drag to paint" in note and "Shift" not in note
    page.item("tool-needles").click()
    page.item("support-0").wait_for()
    middles = page.get(
        "((item) => [item, item.firstElementChild].map((one) => one.getBoundingClientRect())"
        ".map(({ top, height }) => top + height / 2))(document.querySelector('[data-testid=support-0]'))"
    )
    assert abs(middles[0] - middles[1]) < 1
    assert not page.item("show-bumps").is_visible()
    page.item("named-view").select_option("showBumps")
    page.wait("studio.isSmooth")
    page.item("named-view").select_option("showBumps")
    page.wait("!studio.isSmooth")
    assert page.complaints == []
    context.close()


TICKS = {7.6: "8 6 4 2 0", 0.37: "0.4 0.3 0.2 0.1 0.0", 10.2: "12 9 6 3 0"}


def test_a_legend_has_round_numbers(shared: StudioPage) -> None:
    shown = """async (largest) => {
        const { fieldDomain } = await import("./page/view/colours.js");
        const { showLegend } = await import("./page/view/legend.js");
        const element = document.createElement("div");
        showLegend(element, "distance", fieldDomain("distance", [0, largest]));
        return [...element.querySelectorAll(".ticks span")].map((one) => one.textContent).join(" ");
    }"""
    assert {largest: shared.page.evaluate(shown, largest) for largest in TICKS} == TICKS
