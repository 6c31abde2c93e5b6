"""The widget's module in a real browser, with a small model in place of a notebook's."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

import asterism
from asterism.notebook.show import LiveSheet, Traits, shape_traits
from asterism.notebook.widget import widget_module
from asterism.pattern.design.design import Design

pytestmark = pytest.mark.slow

ADDRESS = "http://127.0.0.1:9/"
VIEWPORT = {"width": 900, "height": 700}
# a model as anywidget gives it: Python answers a request with several changes
MODEL = """
class Model {
  constructor(traits) { this.traits = traits; this.listeners = {}; this.requests = []; }
  get(name) { return this.traits[name]; }
  set(name, value) { this.traits[name] = value; }
  on(name, listener) { (this.listeners[name] ??= []).push(listener); }
  off(name, listener) { this.listeners[name] = this.listeners[name].filter((one) => one !== listener); }
  async save_changes() {
    this.requests.push(this.traits.request);
    for (const changes of await window.ask(this.traits.request)) this.take(changes);
  }
  take(changes) {
    const changed = decoded(changes);
    Object.assign(this.traits, changed);
    for (const name of Object.keys(changed)) (this.listeners[`change:${name}`] ?? []).forEach((call) => call());
  }
}
function decoded(traits) {
  const view = (text) => new DataView(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  return Object.fromEntries(
    Object.entries(traits).map(([name, value]) => [name, ["mesh", "frame"].includes(name) ? view(value) : value]),
  );
}
"""
SHOW = (
    "async ({ source, traits, places }) => {"
    + MODEL
    + """
  const url = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
  const widget = (await import(url)).default();
  const model = new Model({ ...decoded(traits), height_px: 300, request: {} });
  widget.initialize({ model });
  window.model = model;
  window.ends = Array.from({ length: places }, () => {
    const el = document.createElement("div");
    document.body.append(el);
    return widget.render({ model, el });
  });
}"""
)
# pixels that the sheet covers, of all; the ground is transparent
COVERED = """(k) => {
  const { view } = document.querySelectorAll(".asterism-sheet")[k].sheet;
  const { gl } = view.renderer;
  view.draw();
  const pixels = new Uint8Array(4 * view.canvas.width * view.canvas.height);
  gl.readPixels(0, 0, view.canvas.width, view.canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let [covered, dark] = [0, 0];
  for (let k = 0; k < pixels.length; k += 4) {
    if (pixels[k + 3] === 255) covered += 1;
    if (pixels[k + 3] === 255 && pixels[k] < 90) dark += 1;
  }
  return [(4 * covered) / pixels.length, (4 * dark) / pixels.length];
}"""


DESIGN = Design.from_dict(asterism.new("dome").to_dict() | {"border": {"rings": 1}})


@pytest.fixture(scope="module")
def preview() -> asterism.Preview:
    return asterism.Preview(DESIGN)


@pytest.fixture
def page(browser: Any) -> Iterator[Any]:
    with empty_page(browser) as page:
        yield page


@pytest.fixture(scope="module")
def still(browser: Any, preview: asterism.Preview) -> Iterator[Any]:
    """A page with a shape that does not change."""
    with empty_page(browser) as page:
        show(page, shape_traits(preview.shape()))
        yield page


@contextmanager
def empty_page(browser: Any) -> Iterator[Any]:
    """An empty page; afterwards it may not have complained, nor asked for anything."""
    context = browser.new_context(viewport=VIEWPORT, device_scale_factor=0.5)
    page = context.new_page()
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on(
        "request", lambda request: complaints.append(request.url) if request.url[:5] not in ("blob:", "data:") else None
    )
    page.route(ADDRESS, lambda route: route.fulfill(body="<!doctype html><body></body>", content_type="text/html"))
    page.goto(ADDRESS)
    complaints.remove(ADDRESS)
    yield page
    context.close()
    assert complaints == []


def encoded(traits: Traits) -> dict[str, Any]:
    return {name: b64encode(value).decode() if isinstance(value, bytes) else value for name, value in traits.items()}


def show(page: Any, traits: Traits, live: LiveSheet | None = None, places: int = 1) -> None:
    def ask(request: dict[str, Any]) -> list[dict[str, Any]]:
        assert live is not None
        return [encoded(changes) for changes in live.answer(request)]

    page.expose_function("ask", ask)
    page.evaluate(SHOW, {"source": widget_module(), "traits": encoded(traits), "places": places})


def settled(page: Any) -> None:
    """Wait until the last request is answered."""
    page.wait_for_function(
        "model.get('panel').answered === model.get('request').seq && !model.requests.at(-1).is_dragging"
    )


def test_a_shape_is_drawn_with_its_arms_and_colours(still: Any) -> None:
    assert still.locator("canvas").first.bounding_box()["height"] == 300
    covered, dark = still.evaluate(COVERED, 0)
    assert 0.15 < covered < 0.9 and 0.01 < dark < 0.3
    still.get_by_test_id("arms").uncheck()
    assert still.evaluate(COVERED, 0)[1] < 0.5 * dark
    assert still.get_by_test_id("legend").is_hidden()
    still.get_by_test_id("colour").select_option("height")
    assert "Height, mm" in still.get_by_test_id("legend").inner_text()
    assert "by the preview" in still.get_by_test_id("figures").inner_text()
    options = still.get_by_test_id("colour").locator("option").all_inner_texts()
    assert options == ["Plain sheet", "Height", "Curvature", "Strain"]


def test_the_sheet_turns_and_the_wheel_zooms_after_a_click(still: Any) -> None:
    camera = (
        "(() => { const { turn, distance } = document.querySelector('.asterism-sheet').sheet.view.camera;"
        " return [turn, distance]; })()"
    )
    turn, distance = still.evaluate(camera)
    box = still.get_by_test_id("view").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    still.mouse.move(x, y)
    # the browser gives wheel events on by a way of their own: this one must not come after the click
    still.evaluate("void (window.turns = 0, addEventListener('wheel', () => (turns += 1), { capture: true }))")
    still.mouse.wheel(0, -300)
    still.wait_for_function("turns > 0")
    still.mouse.down()
    still.mouse.move(x + 60, y, steps=3)
    still.mouse.up()
    turned, same = still.evaluate(camera)
    assert turned < turn - 0.2 and same == distance
    still.mouse.wheel(0, -300)
    still.wait_for_function(f"{camera}[1] < {distance - 1}")
    still.keyboard.press("f")
    still.wait_for_function(f"{camera}[1] > {0.8 * distance}")


def test_a_slider_changes_all_pictures_of_the_sheet_by_the_newest_request(page: Any, preview: asterism.Preview) -> None:
    live = LiveSheet(preview, ["thickness", "stretch"])
    show(page, live.opening(), live, places=2)
    before = page.get_by_test_id("figures").first.inner_text()
    slider = page.get_by_test_id("thickness").first
    slider.focus()
    for _ in range(10):
        page.keyboard.press("ArrowRight")
    page.wait_for_function("Math.abs(model.requests.at(-1)?.values.thickness - 1.1) < 1e-6")
    settled(page)
    assert preview.design.stars.thickness_mm == pytest.approx(0.33)
    for place in (0, 1):
        assert page.get_by_test_id("figures").nth(place).inner_text() != before
        assert page.get_by_test_id("thickness").nth(place).input_value() == "1.1"
    # the newest of waiting requests wins
    page.evaluate("void (window.begun = model.requests.length)")
    page.evaluate(
        """() => {
          const root = document.querySelector(".asterism-sheet").shadowRoot;
          const slider = root.querySelector("[data-testid=thickness]");
          for (const value of [1.02, 1.04, 1.06, 1.08]) {
            slider.value = value;
            slider.dispatchEvent(new Event("input"));
          }
          slider.dispatchEvent(new Event("change"));
        }"""
    )
    settled(page)
    requests = page.evaluate(
        "model.requests.slice(begun).map(({ values, is_dragging }) => [values.thickness, is_dragging])"
    )
    assert requests == [[1.02, True], [1.08, False]]
    page.get_by_test_id("reset").last.click()
    settled(page)
    assert preview.design == DESIGN
    page.wait_for_function(
        "document.querySelectorAll('.asterism-sheet')[0].sheet.store.get('frame').stage === 'equilibrium'"
    )
    assert page.get_by_test_id("figures").first.inner_text() == before
    page.evaluate("ends.forEach((end) => end())")
    assert page.evaluate("Object.values(model.listeners).flat().length") == 1  # that of the flow of requests


def test_a_refused_request_is_told_and_light_text_makes_it_dark(still: Any) -> None:
    colour = (
        "getComputedStyle(document.querySelector('.asterism-sheet').shadowRoot.querySelector('.frame')).backgroundColor"
    )
    light = still.evaluate(colour)
    still.evaluate("document.body.style.color = 'rgb(230, 230, 230)'")
    still.wait_for_function(f"{colour} !== '{light}'")
    still.evaluate(
        "model.take({ panel: { ...model.get('panel'), problem: 'stars: too thin.', warnings: ['the sheet curls'] } })"
    )
    notes = still.get_by_test_id("notes")
    assert "stars: too thin. The last good shape is shown." in notes.inner_text()
    assert "Warnings: 1" in notes.inner_text()
