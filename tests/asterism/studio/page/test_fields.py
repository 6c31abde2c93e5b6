"""Fields of numbers and names: one logic for all of them, and messages without the command line."""

from __future__ import annotations

import pytest

from tests.asterism.studio.browser import StudioPage

NUMBERS = {"7,5": 7.5, "7.6 mm": 7.6, " 0,77cm ": 7.7, "2*3 + 1,8": 7.8, "(10-2)/2 + 3.9": 7.9, "−-7.4": 7.4}
REFUSED = ["", "seven", "7 kg", "7..5", "2*", "(7", "1,000.5", "7 8", "1/0"]


def test_a_field_and_the_table_take_numbers_as_people_type_them_and_refuse_others(flat: StudioPage) -> None:
    flat.open_again("file-even.toml", "gradient")
    for typed, value in NUMBERS.items():
        flat.fill("gradient-number", typed)
        flat.wait(f"Math.abs(studio.document.design.stars.length_mm - {value}) < 1e-9")
        assert float(flat.item("gradient-number").input_value()) == pytest.approx(value), typed
    revision = flat.get("studio.revision")
    for typed in REFUSED:
        flat.fill("gradient-number", typed)
        assert flat.page.locator(".field.bad .fault").inner_text() == "A number, please", typed
    assert flat.get("studio.revision") == revision
    flat.item("open-table").click()
    flat.fill("star-0-length", "2*3 + 1,8")
    flat.wait("Math.abs(studio.sizes[0][0] - 7.8) < 1e-9")
    flat.rest()  # the server's answer makes the table anew
    flat.fill("star-0-length", "7 8")
    cell = flat.item("star-0-length")
    assert (cell.get_attribute("aria-invalid"), cell.get_attribute("title")) == ("true", "A number, please")
    flat.page.keyboard.press("Escape")


def test_a_name_with_a_slash_is_refused(flat: StudioPage) -> None:
    flat.open_again("file-even.toml")
    name = flat.get("studio.document.name")
    for wanted in ("towers/star", "towers\\star"):
        flat.fill("name", wanted)
        flat.page.locator(".toast.bad", has_text="slash").wait_for()
        assert flat.item("name").input_value() == flat.get("studio.document.name") == name


SAID = {
    "the parts pass; the exact model can prevent that (solver.contact, --contact)":
        "the parts pass; the exact model can prevent that",
    "not computed (no law); use --simulate": "not computed (no law)",
    "released fabric; measure it stretched: --fabric": "released fabric; measure it stretched",
    "--name: has no slash": "has no slash",
    "a line, 7 - 3 -- as it is": "a line, 7 - 3 -- as it is",
}  # fmt: skip


def test_messages_name_no_options_of_the_command_line(flat: StudioPage) -> None:
    shown = "async (said) => said.map((await import('./page/format.js')).withoutOptions)"
    assert flat.page.evaluate(shown, list(SAID)) == list(SAID.values())
