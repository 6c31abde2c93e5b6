"""What the history says about a step."""

from __future__ import annotations

from typing import Any

import pytest

from asterism.studio.history import step_words

AT = [[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]]
POINTS = [[0.0, 0.0], [30.0, 0.0]]
NEEDLES = [{"points_mm": POINTS, "target_mm": [[0.0, 0.0, 0.0], [20.0, 0.0, 0.0]]}]
FABRIC = {"stretch": 1.4, "e_mpa": 2.0, "nu": 0.3, "thickness_mm": 0.6}


def plan(*sizes: tuple[float, float]) -> dict[str, Any]:
    return {"at_mm": AT, "sizes_mm": [[*size, 1.2] for size in sizes]}


@pytest.mark.parametrize(
    ("sizes", "words"),
    [
        ([(7.5, 0.3), (7.5, 0.3), (8.0, 0.3)], "Star length 6 → 7.5 mm, 2 stars"),
        ([(7.0, 0.3), (6.0, 0.3), (7.0, 0.4)], "Star length 6 to 8 → 7 mm, 2 stars; Star thickness "),
        ([(6.0, 0.3), (0.0, 0.3), (0.0, 0.3)], "2 stars removed"),
    ],
)
def test_sizes_of_stars_have_values_and_a_number(sizes: list[tuple[float, float]], words: str) -> None:
    plans = plan((6.0, 0.3), (6.0, 0.3), (8.0, 0.3)), plan(*sizes)
    assert step_words({}, {"stars": {"length_mm": 3.0}}, plans).startswith(words)


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        (
            {"pins": NEEDLES},
            {"pins": [{**NEEDLES[0], "target_mm": [[0, 0, 0], [20, 0, 12.5]]}]},
            "Height 0 → 12.5 mm",
        ),
        ({"pins": NEEDLES}, {"pins": [{**NEEDLES[0], "target_mm": [[0, 0, 0], [22, 0, 0]]}]}, "1 needle moved"),
        ({"pins": NEEDLES}, {"pins": [{"points_mm": POINTS[:1], "target_mm": [[0, 0, 0]]}]}, "1 needle removed"),
        ({"pins": NEEDLES}, {"pins": [*NEEDLES, {"where": "border", "scale": 0.7}]}, "Supports"),
        ({"border": {"rings": 3}}, {"border": {"circle_mm": {}}}, "Outline circle; Outline rings 3 → none"),
        (  # what is too much is counted
            {"fabric": FABRIC},
            {"fabric": {key: 2 * value for key, value in FABRIC.items()}},
            "Fabric e 2 → 4 MPa; Fabric nu 0.3 → 0.6; Fabric stretch 1.4 → 2.8 and 1 more",
        ),
    ],
)
def test_needles_and_other_values_are_told(before: dict[str, Any], after: dict[str, Any], words: str) -> None:
    assert step_words(before, after, ()).startswith(words)
