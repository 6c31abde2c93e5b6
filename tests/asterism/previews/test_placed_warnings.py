"""Warnings of a preview carry the stars they are about, and name sites off the sheet."""

from __future__ import annotations

import json
from typing import Any

import asterism
from asterism.results.placed_warning import PlacedWarning


def dome(override: list[dict[str, Any]]) -> asterism.Design:
    data = asterism.new("dome").to_dict() | {"mesh": {"edge_mm": 4.0}}
    return asterism.Design.from_dict(data | {"stars": data["stars"] | {"override": override}})


def test_stars_outside_the_law_are_marked() -> None:
    entries = [{"site": [0, 0], "thickness_mm": 1.6}, {"site": [1, 0], "thickness_mm": 1.7}]
    summary = asterism.preview(dome(entries)).summary
    (warning,) = [line for line in summary["warnings"] if "outside the law" in line]
    assert isinstance(warning, PlacedWarning) and len(warning.stars) == 2 and warning.stars[0] == 0
    assert json.loads(json.dumps(list(summary["warnings"]))) == list(summary["warnings"])


def test_sites_off_the_sheet_are_named() -> None:
    summary = asterism.preview(dome([{"site": [0, 9], "remove": True}, {"site": [8, 1], "length_mm": 5.0}])).summary
    (warning,) = [line for line in summary["warnings"] if "outside of the sheet" in line]
    assert warning == "2 entries of stars.override are for sites outside of the sheet, and ignored: [0, 9], [8, 1]"
    assert not any("outside of the sheet" in line for line in asterism.preview(dome([])).summary["warnings"])


def test_arms_that_are_bonded_where_they_meet_are_named() -> None:
    meeting = asterism.Design.from_dict({"stars": {"length_fraction": 1.0}, "border": {"rings": 1}})
    (warning,) = [line for line in asterism.preview(meeting).summary["warnings"] if "print as one" in line]
    assert isinstance(warning, PlacedWarning) and set(warning.stars) == set(range(7))
    assert not any("print as one" in line for line in asterism.preview(dome([])).summary["warnings"])
