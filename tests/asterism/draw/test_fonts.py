"""Letters that no font has are shown as their numbers, those of other scripts by the fonts that have them."""

from __future__ import annotations

import io
import warnings

import pytest

from asterism.draw import fonts
from asterism.draw.picture import draw_shape
from tests.asterism import sheets


@pytest.fixture
def only_the_usual_font(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fonts, "OTHER_FAMILIES", ())
    for name in ("families", "_letters"):
        monkeypatch.setattr(fonts, name, getattr(fonts, name).__wrapped__)


@pytest.mark.usefixtures("only_the_usual_font")
def test_no_letter_is_a_box() -> None:
    assert fonts.printable("\u661f\u5f62 7") == "<U+661F><U+5F62> 7"
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a letter without a glyph is a warning
        draw_shape(sheets.sheet(sheets.dome, edge=8.0), "\u661f", io.BytesIO())


def test_letters_of_the_usual_font_stay() -> None:
    assert fonts.printable("D\u00f4me 7 \u00d7 3, \u041a\u0443") == "D\u00f4me 7 \u00d7 3, \u041a\u0443"
    assert fonts.families()[0] == fonts.USUAL_FAMILY
