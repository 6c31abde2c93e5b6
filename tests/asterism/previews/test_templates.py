"""Every template is a good start: a certified sheet within the law, of printable sizes, with a sentence."""

from __future__ import annotations

import pytest

from asterism.pattern import gallery
from asterism.pattern.layout.build import load_design
from asterism.previews.session import preview
from asterism.print.bed_placement import size_warning


def test_one_sentence_says_what_a_design_is() -> None:
    assert not set(gallery.template_names()) & set(gallery.names())
    for name in (*gallery.template_names(), *gallery.names()):
        words = gallery.words(name)
        assert words.endswith(".") and 10 <= len(words) <= 140 and "\n" not in words


@pytest.mark.slow
@pytest.mark.parametrize("name", gallery.template_names())
def test_a_template_is_certified_and_printable(name: str) -> None:
    design = load_design(gallery.path(name))
    assert design.name == name and not list(size_warning(design))
    # one or two layers of the printers that are listed
    assert design.required_stars.thickness_mm in (0.3, 0.4)
    summary = preview(design).summary
    assert summary.is_minimum and summary.law_in_range and not summary.self_intersections
    assert summary.height_mm > 25.0
