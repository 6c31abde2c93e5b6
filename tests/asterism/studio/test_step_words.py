"""What the history says about a step."""

from __future__ import annotations

from typing import Any

import pytest

from asterism.studio.history import step_words

AT = [[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]]


def plan(*sizes: list[float]) -> dict[str, Any]:
    return {"at_mm": AT, "sizes_mm": list(sizes)}


STARS = plan([6.0, 0.3, 1.2], [6.0, 0.3, 1.2], [8.0, 0.3, 1.2])
POINTS = [[0.0, 0.0], [30.0, 0.0]]
NEEDLES = {"pins": [{"points_mm": POINTS, "target_mm": [[0.0, 0.0, 0.0], [20.0, 0.0, 0.0]]}]}


@pytest.mark.parametrize(
    ("plans", "words"),
    [
        ([[7.5, 0.3, 1.2], [7.5, 0.3, 1.2], [8.0, 0.3, 1.2]], "Star length 6 → 7.5 mm, 2 stars"),
        ([[7.0, 0.3, 1.2], [6.0, 0.3, 1.2], [7.0, 0.4, 1.2]], "Star length 6 to 8 → 7 mm, 2 stars; Star thickness "),
        ([[6.0, 0.3, 1.2], [0.0, 0.3, 1.2], [0.0, 0.3, 1.2]], "2 stars removed"),
    ],
)
def test_sizes_of_stars_have_values_and_a_number(plans: list[list[float]], words: str) -> None:
    assert step_words({}, {"stars": {"length_mm": 3.0}}, (STARS, plan(*plans))).startswith(words)


@pytest.mark.parametrize(
    ("pins", "words"),
    [
        ([{"points_mm": POINTS, "target_mm": [[0, 0, 0], [20, 0, 12.5]]}], "Height 0 → 12.5 mm, 1 needle"),
        ([{"points_mm": POINTS, "target_mm": [[0, 0, 0], [22, 0, 0]]}], "1 needle moved"),
        ([{"points_mm": POINTS[:1], "target_mm": [[0, 0, 0]]}], "1 needle removed"),
        ([*NEEDLES["pins"], {"where": "border", "scale": 0.7}], "Supports"),
    ],
)
def test_needles_are_told_by_their_printed_places(pins: list[dict[str, Any]], words: str) -> None:
    assert step_words(NEEDLES, {"pins": pins}, ()) == words


def test_other_values_are_named_and_what_is_too_much_is_counted() -> None:
    assert (
        step_words({"border": {"rings": 3}}, {"border": {"circle_mm": {}}}, ())
        == "Outline circle; Outline rings 3 → none"
    )
    many = {"fabric": {"stretch": 1.4, "e_mpa": 2.0, "nu": 0.3, "thickness_mm": 0.6}}
    other = {"fabric": {"stretch": 1.5, "e_mpa": 2.5, "nu": 0.4, "thickness_mm": 0.7}}
    assert (
        step_words(many, other, ()) == "Fabric e 2 → 2.5 MPa; Fabric nu 0.3 → 0.4; Fabric stretch 1.4 → 1.5 and 1 more"
    )
