"""Letters that no font has are shown as their numbers, those of other scripts by the fonts that have them."""

from __future__ import annotations

import io

import pytest

from asterism.draw import fonts
from asterism.draw.picture import FIRST_RARE_LETTER, draw_shape, usual_font
from tests.asterism import sheets


@pytest.fixture
def only_the_usual_font(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fonts, "OTHER_FAMILIES", ())
    for name in ("families", "_letters"):
        monkeypatch.setattr(fonts, name, getattr(fonts, name).__wrapped__)


@pytest.mark.usefixtures("only_the_usual_font")
def test_no_letter_is_a_box() -> None:
    assert fonts.printable("\u661f\u5f62 7") == "<U+661F><U+5F62> 7"
    assert [run for _, run in fonts.font_runs("\u661f 7", bold=True)] == ["<U+661F> 7"]
    draw_shape(sheets.sheet(sheets.dome, edge=8.0), "\u661f", io.BytesIO())


@pytest.mark.parametrize("bold", [False, True])
def test_letters_of_european_languages_are_in_the_usual_font(bold: bool) -> None:
    """So that pictures need not read fonts to know."""
    letters = "".join(filter(str.isprintable, map(chr, range(FIRST_RARE_LETTER))))
    assert fonts.font_runs(letters, bold) == [(usual_font(bold), letters)]


def test_letters_of_other_scripts_have_the_font_that_has_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fonts, "_letters_of", lambda file: {ord("a"), ord("\u661f")} if "Mono" in file else {ord("b")})
    monkeypatch.setattr(fonts, "families", lambda: [fonts.USUAL_FAMILY, "DejaVu Sans Mono"])
    monkeypatch.setattr(fonts, "printable", lambda text: text)
    runs = fonts.font_runs("b\u661fab", bold=False)
    assert [(run, "Mono" in file) for file, run in runs] == [("b", False), ("\u661fa", True), ("b", False)]


def test_letters_of_the_usual_font_stay() -> None:
    assert fonts.printable("D\u00f4me 7 \u00d7 3, \u041a\u0443") == "D\u00f4me 7 \u00d7 3, \u041a\u0443"
    assert fonts.families()[0] == fonts.USUAL_FAMILY
