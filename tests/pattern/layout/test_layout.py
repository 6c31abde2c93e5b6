"""From designs to layouts: lattice, border, stars and arms."""

from typing import Any

import numpy as np
import pytest
from shapely import LineString, Point, Polygon

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.free_motions import check_weight_is_supported

D = 10 * np.sqrt(3)


def lay(**tables):
    stars = {"length_mm": 10, "thickness_mm": 0.4, **tables.pop("stars", {})}
    if "length_fraction" in stars:
        del stars["length_mm"]
    return layout(Design.from_dict({"stars": stars, "border": {"rings": 3}, **tables}))


@pytest.mark.parametrize("rings", [0, 1, 3])
def test_rings(rings):
    sheet = lay(border={"rings": rings, "overhang": "refuse"})
    assert len(sheet.centres) == 1 + 3 * rings * (rings + 1)
    assert len(sheet.arm_tip) == 3 * len(sheet.centres)
    radius = np.linalg.norm(sheet.outline, axis=1)
    np.testing.assert_allclose(radius, (rings * np.sqrt(3) + 1.5) * 10)
    assert np.degrees(np.arctan2(*sheet.outline[0][::-1])) == pytest.approx(30)
    # 3 n (3 n + 1) nearest pairs on a hexagon of n rings
    assert len(sheet.sample_pairs) == 3 * rings * (3 * rings + 1)
    np.testing.assert_allclose(np.linalg.norm(np.diff(sheet.centres[sheet.sample_pairs], axis=1), axis=2), D)


def test_stars_touch_neighbours_at_full_length():
    sheet = lay(stars={"length_fraction": 1.0}, border={"rings": 2})
    inner = np.abs(sheet.arm_length - D) < 1e-9
    gap = np.linalg.norm(sheet.arm_tip[inner][:, None] - sheet.centres, axis=2).min(axis=1)
    np.testing.assert_allclose(gap, 0, atol=1e-9)
    assert 0 < (~inner).sum() < len(inner)  # outer arms are cut
    arms = sheet.arm_tip[sheet.arm_star == 0]
    np.testing.assert_allclose(np.degrees(np.arctan2(arms[:, 1], arms[:, 0])), [-90, 30, 150])


@pytest.mark.parametrize("arms", [3, 8])
@pytest.mark.parametrize("kind", ["triangular", "square"])
def test_arm_counts_and_lattices(arms, kind):
    sheet = lay(
        lattice={"kind": kind, "arms": arms, "orientation_deg": 10, "spacing_mm": 20},
        stars={"length_mm": 7},
        border={"rectangle_mm": [100, 100]},
    )
    assert len(sheet.arm_tip) == arms * len(sheet.centres)
    first = sheet.arm_tip[0] - sheet.centres[sheet.arm_star[0]]
    assert np.degrees(np.arctan2(first[1], first[0])) == pytest.approx(-80)
    assert len(sheet.centres) == (25 if kind == "square" else 23)


def test_polygon_either_way_round():
    corners = [[-50, -40], [50, -40], [60, 30], [0, 5], [-60, 30]]
    one, two = (lay(border={"polygon_mm": c}) for c in (corners, corners[::-1]))
    np.testing.assert_allclose(one.centres, two.centres)
    x, y = one.outline.T
    assert np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0
    assert {tuple(c) for c in one.outline} == {tuple(c) for c in two.outline}


def test_arm_stops_where_it_first_leaves_the_sheet():
    notch = [[-40, -40], [40, -40], [40, 40], [-40, 40], [-40, 20], [10, 14], [-40, 8]]
    sheet = lay(border={"polygon_mm": notch, "star_margin_mm": 1}, stars={"length_mm": 16, "width_mm": 0.2})
    for centre, tip in zip(sheet.centres[sheet.arm_star], sheet.arm_tip, strict=True):
        assert Polygon(notch).contains(LineString([centre, tip]))


def test_short_stars_are_not_printed():
    table = {"profile": "table", "distance_mm": [0, 20, 29], "values": [10, 10, 0.5]}
    sheet = lay(stars={"length_mm": table})
    assert len(sheet.centres) == 7  # the second ring starts at 30 mm
    sheet = lay(stars={"length_mm": {**table, "values": [0, 0, 10]}})
    assert len(sheet.centres) == 37 - 7
    # other sizes of what is not printed may be anything
    radial = {"profile": "radial", "over_mm": 30}
    stars = {"length_mm": radial | {"from": 8, "to": 0.5}, "thickness_mm": radial | {"from": 0.3, "to": 0.0}}
    assert len(lay(border={"rings": 2}, stars=stars).centres) == 7


def test_overrides():
    override = [
        {"star": 0, "length_mm": 5, "thickness_mm": 0.8},
        {"at_mm": [0, 17.3], "remove": True},
        {"star": 36, "width_mm": 2},
    ]
    sheet = lay(stars={"override": override})
    assert len(sheet.centres) == 36
    np.testing.assert_allclose(sheet.arm_length[:3], 5)
    np.testing.assert_allclose(sheet.arm_thickness[:3], 0.8)
    np.testing.assert_allclose(sheet.arm_thickness[3:], 0.4)
    np.testing.assert_allclose(sheet.arm_width[-3:], 2)
    assert np.linalg.norm(sheet.centres - [0, D], axis=1).min() > 1


def test_a_star_on_the_axis_is_first_of_its_ring_whatever_its_rounding():
    lattice = {"kind": "square", "spacing_mm": 17.3, "arms": 4, "origin_mm": [0, 51.9]}
    sheet = lay(lattice=lattice, stars={"length_mm": 6}, border={"rectangle_mm": [80, 80]})
    np.testing.assert_allclose(sheet.centres[1], [17.3, 0.0], atol=1e-9)


def test_sizes_along_arms_of_a_star_changed_by_hand():
    """The field counts where the tips of the changed star are."""
    field = {"formula": "0.6 + 0.004*y"}
    plan = {"thickness_mm": field, "vary_along_arms": True}
    changed = lay(stars={"length_mm": 4.0, "override": [{"star": 0, "length_mm": 9.0}], **plan})
    np.testing.assert_allclose(changed.arm_thickness[:3, 1], 0.6 + 0.004 * changed.arm_tip[:3, 1])
    np.testing.assert_allclose(changed.arm_length[:3], 9.0)
    flat = lay(stars={"length_mm": 4.0, "thickness_mm": field}).arm_thickness
    np.testing.assert_array_equal(flat[:, 0], flat[:, 1])


def test_cut_arm_keeps_the_taper_of_the_full_one():
    # star centres at x = 0 and 20; the right arm of the right star is cut from 12 to 9.5 mm
    sheet = lay(
        lattice={"kind": "square", "spacing_mm": 20, "arms": 4},
        border={"rectangle_mm": [60, 30], "star_margin_mm": 10},
        stars={
            "length_mm": {"formula": "where(x > 10, 12, 4)"},
            "thickness_mm": {"formula": "0.1 + 0.01*abs(x)"},
            "vary_along_arms": True,
        },
    )
    arm = int(sheet.arm_tip[:, 0].argmax())
    assert sheet.arm_tip[arm] == pytest.approx([29.5, 0], abs=1e-9)
    assert sheet.arm_thickness[arm] == pytest.approx([0.3, 0.395])


def test_cut_arms_are_rounded_too():
    rule = {"first_layer_mm": 0.3, "layer_mm": 0.2, "line_mm": 0.4}
    sheet = lay(
        stars={"thickness_mm": {"formula": "0.3 + 0.01*r"}, "vary_along_arms": True, "rounding": rule},
        border={"rectangle_mm": [80, 60], "star_margin_mm": 5.0},
    )
    layers = (sheet.arm_thickness - 0.3) / 0.2
    np.testing.assert_allclose(layers, np.round(layers), atol=1e-6)


@pytest.mark.parametrize("angle", [0, 30, 210])
def test_arms_that_lie_on_each_other_are_refused_however_they_are_turned(angle: int) -> None:
    x, y = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    lattice = {"kind": "custom", "vectors_mm": [[17 * x, 17 * y], [-17 * y, 17 * x]], "arms": 4}
    corners = 40.0 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ np.array([[x, y], [-y, x]])
    with pytest.raises(DesignError, match=r"stars: arms of the stars .* overlap"):
        lay(
            lattice=lattice | {"orientation_deg": angle},
            stars={"length_fraction": 1.0},
            border={"polygon_mm": corners.tolist()},
        )


@pytest.mark.parametrize(
    ("pins", "direction", "along"),
    [
        ([{"corners": [0, 2], "slide": "z"}], [0.0, 0.0, -1.0], "z"),
        ([{"corners": [0, 2], "slide": "plane"}], [1.0, 0.0, 0.0], "x"),
        ([{"corners": [0, 2], "slide": "plane"}, {"corners": [1], "step": 1}], [1.0, 1.0, 0.0], "x and y"),
    ],
)
def test_weight_along_which_all_pins_slide_is_refused(
    pins: list[dict[str, object]], direction: list[float], along: str
) -> None:
    asked = {"stars": {"length_mm": 8.0}, "border": {"rings": 1}, "fabric": {"modulus_mpa": 1.0}}
    asked |= {"gravity": {"on": True, "direction": direction}}
    design = Design.from_dict(asked | {"pins": pins})
    with pytest.raises(DesignError, match=rf"^gravity\.on = True: .* slide along {along}, among the first"):
        check_weight_is_supported(design, layout(design))
    held = Design.from_dict(asked | {"pins": [*pins, {"corners": [3]}]})
    check_weight_is_supported(held, layout(held))


def test_whole_numbers_of_arrays_are_whole_numbers() -> None:
    for rings in np.arange(2):
        one = Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": rings}})
        assert one.border.rings == rings and type(one.to_dict()["border"]["rings"]) is int
    for wrong in (True, 1.0, "1", np.True_, np.float64(1.0)):
        with pytest.raises(DesignError, match="whole number"):
            Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": wrong}})


def test_arrays_mean_what_lists_mean() -> None:
    corners = [[-40.0, -40.0], [40.0, -40.0], [40.0, 40.0], [-40.0, 40.0]]

    def made(of: Any, yes: Any) -> Design:
        corner = {"corners": of([0, 2]), "offset_mm": of([0.0, 0.0, 5.0])}
        point = {"points_mm": of([[0.0, 0.0]]), "target_mm": of([0.0, 0.0, 0.0])}
        design = {"stars": {"length_mm": 8.0}, "border": {"polygon_mm": of(corners)}, "pins": [corner, point]}
        return Design.from_dict(design | {"fabric": {"stretch": of([1.3, 1.4])}, "solver": {"contact": yes}})

    assert made(np.array, np.bool_(True)).to_dict() == made(list, True).to_dict()


NOTCH = [[-40, -40], [-1, -40], [0, -8.7], [1, -40], [40, -40], [40, 40], [-40, 40]]


def test_corners_that_point_inwards_cut_no_arm_behind_them():
    """A mitre there would reach ten margins into the sheet, and take whole stars away."""
    for margin in (0.5, 3.0):
        sheet = lay(border={"polygon_mm": NOTCH, "tip_margin_mm": margin}, stars={"length_mm": 7})
        assert len(sheet.centres) == 16
        outline = Polygon(NOTCH).exterior
        for star, tip in zip(sheet.arm_star, sheet.arm_tip, strict=True):
            arm, away = LineString([sheet.centres[star], tip]), outline.distance(Point(tip))
            assert outline.distance(arm) > margin * (1 - 2e-3)
            assert away < margin * (1 + 2e-3) or arm.length == pytest.approx(7)


@pytest.mark.parametrize("corner", [0.5, 0.5001, 0.51])
def test_an_arm_along_a_corner_goes_on_behind_it(corner):
    """The corner of what is 0.5 mm inside: half a millimetre above the arm, to a hair or to the last digit."""
    border = {"polygon_mm": [[-30, -30], [12, -30], [12, corner], [5, corner], [5, 30], [-30, 30]], "star_margin_mm": 4}
    stars = {"length_mm": 4, "width_mm": 0.5, "override": [{"star": 0, "length_mm": 15}]}
    sheet = lay(border=border, stars=stars, lattice={"kind": "square", "spacing_mm": 20, "arms": 4})
    (right,) = [tip for tip in sheet.arm_tip[sheet.arm_star == 0] if tip[0] > 1]
    assert right[0] == pytest.approx(11.5, abs=1e-6)


@pytest.mark.slow
def test_a_long_sheet_across_is_no_larger_than_it_is():
    strip = [[-2400, -2400], [-2370, -2400], [2400, 2370], [2400, 2400], [2370, 2400], [-2400, -2370]]
    sheet = lay(border={"polygon_mm": strip}, stars={"length_mm": 5}, lattice={"spacing_mm": 10}, mesh={"edge_mm": 5})
    assert 2000 < len(sheet.centres) < 3300
