"""Stars that are changed by their lattice site, and the sites that a layout lists."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.painted_stars import overrides_by_site, with_painted_stars

LATTICES = [{"kind": "triangular"}, {"kind": "square"}, {"kind": "custom", "vectors_mm": [[18.0, 2.0], [-3.0, 21.0]]}]


def design(override: list[dict[str, Any]] | None = None, **sections: Any) -> Design:
    data: dict[str, Any] = {"stars": {"length_mm": 7.0, "override": override or []}, "border": {"rings": 2}}
    return Design.from_dict(data | sections)


def sizes(plan: Layout) -> np.ndarray:
    return np.column_stack([plan.arm_length, plan.arm_thickness[:, 0], plan.arm_width[:, 0]])


@pytest.mark.parametrize("lattice", LATTICES, ids=lambda lattice: lattice["kind"])
def test_sites_are_the_places_of_the_stars(lattice: dict[str, Any]) -> None:
    border = {"polygon_mm": [[-60, -45], [70, -50], [64, 60], [-20, 66]]}
    plan = layout(design([{"star": 4, "remove": True}], lattice=lattice, border=border))
    assert plan.lattice.place(plan.sites) == pytest.approx(plan.centres, abs=1e-9)
    assert (plan.sheet_sites[plan.star_number] == plan.sites).all()
    assert len(plan.sheet_sites) == len(plan.centres) + 1 and 4 not in plan.star_number
    assert plan.site_sizes_mm[4, 0] == 0.0 and (np.delete(plan.site_sizes_mm, 4, axis=0) == [7.0, 0.3, 1.2]).all()


@pytest.mark.parametrize("lattice", LATTICES, ids=lambda lattice: lattice["kind"])
def test_an_override_by_site_is_that_by_place(lattice: dict[str, Any]) -> None:
    border, changed = {"rectangle_mm": [120, 90]}, {"length_mm": 5.0, "thickness_mm": 0.4, "width_mm": 1.6}
    plain = layout(design(lattice=lattice, border=border))
    for star in (0, 3, len(plain.centres) - 1):
        entries = [{"star": star}, {"at_mm": plain.centres[star].tolist()}, {"site": plain.sites[star].tolist()}]
        layouts = [layout(design([entry | changed], lattice=lattice, border=border)) for entry in entries]
        for other in layouts[1:]:
            assert (sizes(other) == sizes(layouts[0])).all() and (other.arm_tip == layouts[0].arm_tip).all()


def test_overrides_by_site_survive_a_smaller_outline() -> None:
    data = design([{"site": [2, 0], "length_mm": 5.0}, {"site": [0, 1], "length_mm": 4.0}]).to_dict()
    large = layout(Design.from_dict(data))
    small = layout(Design.from_dict(data | {"border": {"rings": 1}}))
    assert small.ignored_sites.tolist() == [[2, 0]] and len(large.ignored_sites) == 0
    assert np.isclose(small.arm_length, 4.0).sum() == 3
    again = layout(Design.from_dict(data | {"border": {"rings": 2}}))
    assert (sizes(again) == sizes(large)).all()


@pytest.mark.parametrize(
    ("entry", "field", "allowed"),
    [
        ({"site": [0.5, 0]}, "stars.override[0].site[0]", "whole number"),
        ({"site": [0, True]}, "stars.override[0].site[1]", "whole number"),
        ({"site": [1]}, "stars.override[0].site", "is missing"),
        ({"site": [0, 10**30]}, "stars.override[0].site[1]", "at most"),
        ({"site": [0, 0], "star": 0}, "stars.override[0]", "must have one of star, at_mm and site"),
        ({}, "stars.override[0]", "must have one of star, at_mm and site"),
    ],
)
def test_what_is_no_site_is_refused(entry: dict[str, Any], field: str, allowed: str) -> None:
    with pytest.raises(DesignError, match=allowed) as caught:
        design([entry | {"length_mm": 5.0}])
    assert caught.value.field.startswith(field) and "\n" not in str(caught.value)


@pytest.mark.parametrize("second", [{"site": [0, 0]}, {"star": 0}, {"at_mm": [0.3, 0.1]}])
def test_a_star_is_changed_once(second: dict[str, Any]) -> None:
    twice = design([{"site": [0, 0], "length_mm": 5.0}, second | {"width_mm": 1.0}])
    with pytest.raises(DesignError, match="changes star 0 again") as caught:
        layout(twice)
    assert caught.value.stars == (0,) and caught.value.place_mm == (0.0, 0.0)


def test_a_site_off_the_sheet_is_named_once_and_sites_are_whole() -> None:
    with pytest.raises(DesignError, match=r"changes site \[9, 9\] again"):
        layout(design([{"site": [9, 9], "length_mm": 5.0}] * 2))
    with pytest.raises(ValueError, match="whole numbers"):
        with_painted_stars(design(), [[0.5, 0.0]], np.ones((1, 3)))


def test_painted_stars_are_overrides_by_site() -> None:
    base = design([{"star": 0, "branch": "free"}, {"at_mm": [0.0, 17.32], "length_mm": 5.0}])
    painted = with_painted_stars(
        base, [[0, 0], [0, 1], [1, 0]], [[6.0, np.nan, np.nan], [np.nan] * 3, [4.0, 0.4, 1.5]], removed=[[-1, 0]]
    )
    entries = {entry.site: entry for entry in painted.stars.override}
    assert entries[0, 0].branch == "free" and entries[0, 0].length_mm == 6.0
    assert entries[0, 1].length_mm == 5.0 and entries[-1, 0].remove
    written = Design.from_dict(painted.to_dict())
    assert written == painted
    plan = layout(painted)
    number = {
        tuple(site): row for row, site in zip(plan.site_sizes_mm.tolist(), plan.sheet_sites.tolist(), strict=True)
    }
    assert number[1, 0] == [4.0, 0.4, 1.5] and number[-1, 0][0] == 0.0 and number[0, 0] == [6.0, 0.3, 1.2]


def test_a_star_comes_back_with_the_size_of_its_profile() -> None:
    base = design()
    gone = with_painted_stars(base, [], [], removed=[[0, 0]])
    assert len(layout(gone).centres) == 18
    assert (sizes(layout(with_painted_stars(base, [], []))) == sizes(layout(base))).all()
    assert (sizes(layout(with_painted_stars(gone, [[0, 0]], [[7.0, 0.3, 1.2]]))) == sizes(layout(base))).all()


def test_numbers_of_stars_leave_out_those_that_a_hole_replaces() -> None:
    border = {"rings": 2, "holes": [{"circle_mm": {"radius": 12.0}}]}
    base = Design.from_dict(design([{"star": 3, "length_mm": 5.0}]).to_dict() | {"border": border})
    (entry,) = overrides_by_site(base)
    assert entry.site == tuple(layout(base).sheet_sites[3].tolist())
    assert (sizes(layout(with_painted_stars(base, [], []))) == sizes(layout(base))).all()


TOUCH = r"^stars: arms of the stars at \[.*\] and \[.*\]"
MARGIN = r"^border\.tip_margin_mm = \d+\.0: must be below .* mm"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"lattice": {"arms": 6}, "stars": {"length_mm": 10.0}}, TOUCH),  # facing arms overlap beyond d/2
        ({"lattice": {"arms": 6}, "stars": {"length_mm": 8.5}}, TOUCH),  # 0.32 mm between tips 1.2 mm wide
        ({"lattice": {"arms": 4, "orientation_deg": 13}, "stars": {"length_mm": 12.0}}, TOUCH),
        ({"lattice": {"arms": 5}, "stars": {"length_mm": 10.0}}, TOUCH),
        ({"stars": {"length_mm": 17.0}}, TOUCH),  # 0.32 mm short of the neighbour
        ({"lattice": {"arms": 6}, "stars": {"length_fraction": 1.0}}, TOUCH),
        ({"border": {"rings": 2, "tip_margin_mm": 20.0}}, MARGIN),
        ({"border": {"rectangle_mm": [100, 80], "tip_margin_mm": 20.0}}, MARGIN),
        ({"stars": {"length_mm": 16}, "border": {"rings": 1, "overhang": "refuse"}}, r"border\.overhang.*star \d+ at"),
        ({"stars": {"length_mm": 7, "override": [{"star": 5, "width_mm": 50}]}}, r"^stars\.override\[0\]\.width_mm"),
    ],
)
def test_errors_about_stars_carry_them(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(DesignError, match=message) as caught:
        layout(design(**changes))
    error = caught.value
    assert error.place_mm is not None and len(error.stars) >= 1 and ("override" not in message or error.stars == (5,))
    assert error.within("a.toml").stars == error.stars


def test_errors_about_places_carry_them() -> None:
    with pytest.raises(DesignError) as caught:
        design(border={"polygon_mm": [[0, 0], [60, 60], [60, 0], [0, 60]]})
    assert caught.value.place_mm == pytest.approx((30.0, 30.0))
    with pytest.raises(DesignError) as caught:
        layout(design(pins=[{"points_mm": [[500.0, 0.0]]}]))
    assert caught.value.place_mm == (500.0, 0.0)
