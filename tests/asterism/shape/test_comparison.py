"""Distances of shapes that are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.shape.comparison import Comparison, compare_shapes, image
from asterism.shape.measures import CellMean
from asterism.shape.surface import surface_triangle_areas
from asterism.verification.verify import alike
from tests.asterism.verification.printed import design, lumpy, rolled, shape

UNIFORM = design()
# nothing but the identity maps this one onto itself
UNLIKE = design(stars={"length_mm": {"profile": "axis", "axis": "x", "from": 8.0, "to": 5.0, "over_mm": 40.0,
                                     "centre_mm": [7.0, 3.0]}})  # fmt: skip


def compared(of: Design, one, other) -> Comparison:
    plan = layout(of)
    return compare_shapes(one, other, plan, symmetries(of, plan))


def test_outlines_may_be_symmetric_to_a_few_decimals_only():
    corners = layout(UNIFORM).outline.round(5)
    drawn = design(border={"polygon_mm": corners.tolist()})
    assert len(symmetries(drawn, layout(drawn))) == 6
    one = shape(drawn, lumpy)
    assert compared(drawn, one, one).record.max_percent == pytest.approx(0.0, abs=1e-9)


def test_the_relief_is_what_repeats_from_star_to_star():
    plan = layout(UNIFORM)
    one = shape(UNIFORM, rolled(30.0))
    waves = 2.0 * np.pi * one.printed @ np.linalg.inv(plan.lattice_vectors)
    bumps = np.column_stack([np.zeros((len(waves), 2)), np.cos(waves).sum(axis=1)])
    right = replace(one, positions=one.positions + bumps)
    other = replace(one, positions=one.positions + 0.7 * bumps)
    found = compared(UNIFORM, right, other)
    assert found.record.relief_error_percent == pytest.approx(30.0, abs=4.0)
    assert found.rms_percent < 0.2


def test_images_number_stars_and_their_arms_as_the_design_does():
    """Where a star was removed the numbers are not the places in a list."""
    of = design(stars={"length_mm": 8.0, "override": [{"star": 0, "remove": True}]}, mesh={"edge_mm": 4.0})
    plan, one = layout(of), exact_shape(of)
    assert plan.star_number.min() == 1
    centres = dict(zip(plan.star_number.tolist(), plan.centres, strict=True))
    for symmetry in symmetries(of, plan):
        found = image(one, symmetry)
        for number, centre in centres.items():
            assert found.printed[found.star == number] == pytest.approx(centre[None], abs=1e-6)
        edge = 0
        for path in found.rods:
            numbers = found.rod_fields["star"][edge : edge + len(path) - 1]
            edge += len(path) - 1
            assert found.printed[path[0]] == pytest.approx(centres[int(numbers[0])], abs=1e-6)
            assert (numbers == numbers[0]).all()


def test_normals_differ_by_the_angle_of_the_slopes():
    """A flat sheet and a shallow roof, whose sides go down by 10 degrees, but for the cells at the ridge."""
    slope = np.tan(np.radians(10.0))
    flat = shape(UNIFORM, lambda p: np.column_stack([p, np.zeros(len(p))]))
    roof = shape(UNIFORM, lambda p: np.column_stack([p, -slope * np.abs(p[:, 0])]))
    assert 8.0 < compared(UNIFORM, flat, roof).record.normals_rms_deg < 10.0


@settings(max_examples=6)
@given(st.tuples(*4 * [st.floats(-1.0, 1.0)]).filter(lambda q: sum(x * x for x in q) > 0.01), st.floats(-500.0, 500.0))
def test_distances_do_not_depend_on_where_the_other_shape_lies(quaternion, far):
    one, other = shape(UNLIKE, lumpy), shape(UNLIKE, rolled(30.0))
    turn = Rotation.from_quat(quaternion).as_matrix()
    moved = replace(other, positions=other.positions @ turn.T + [far, 1.0, -far])
    here, there = compared(UNLIKE, one, other), compared(UNLIKE, one, moved)
    for name in ("rms_percent", "max_percent", "rms_stars_percent", "normals_rms_deg"):
        assert there.record[name] == pytest.approx(here.record[name], abs=1e-6)
    assert there.record.heights_mm[1] == pytest.approx(here.record.heights_mm[1], abs=1e-6)


@pytest.mark.parametrize(
    ("pins", "free"),
    [([], 6), ([{"edges": [0]}], 1), ([{"where": "border"}], 0), ([{"corners": [0, 2, 4]}], 0)],
)
def test_only_motions_that_the_supports_leave_free_are_taken_out(pins, free):
    """A sheet that has swung on its supports is off as it stands, though the best rigid motion takes the swing away."""
    held = design(pins=pins)
    one = shape(held, lumpy)
    edge = layout(held).outline[[0, 1]]
    line = np.append(edge[1] - edge[0], 0.0) / np.linalg.norm(edge[1] - edge[0])
    pivot = np.append(edge[0], 0.0)
    turn = Rotation.from_rotvec(np.radians(10.0) * line).as_matrix()
    swung = replace(one, positions=(one.positions - pivot) @ turn.T + pivot)
    found = compared(held, one, swung)
    assert found.free_motions == free
    assert found.record.rms_after_motion_percent == pytest.approx(0.0, abs=1e-9)
    if free:
        assert found.record.max_mm == pytest.approx(0.0, abs=1e-7)
        assert found.record.heights_mm[1] == pytest.approx(found.record.heights_mm[0], abs=1e-7)
        return
    distance = np.linalg.norm(CellMean(one.printed, one.weights, layout(held).lattice_vectors)(
        swung.positions - one.positions), axis=1)  # fmt: skip
    assert found.record.max_mm == pytest.approx(distance.max())
    assert found.record.rms_mm == pytest.approx(np.sqrt(one.weights @ distance**2))
    assert found.rms_percent == pytest.approx(100.0 * found.record.rms_mm / found.diameter_mm)
    np.testing.assert_allclose(found.other.positions, swung.positions, atol=1e-9)
    assert found.record.heights_mm[1] == pytest.approx(np.ptp(swung.positions[:, 2]))


@pytest.mark.slow
def test_weight_says_how_a_sheet_hangs():
    """On a needle it turns about the plumb line alone."""
    held = design(pins=[{"points_mm": [[0.0, 0.0]]}])
    one, plan = shape(held, lumpy), layout(held)
    motions = Rotation.from_euler("z", 70, degrees=True), Rotation.from_euler("x", 10, degrees=True)
    turned, tilted = (replace(one, positions=motion.apply(one.positions)) for motion in motions)
    for gravity, free, off in ((None, 3, False), ((0.0, 0.0, -1.0), 1, True)):
        found = [compare_shapes(one, other, plan, symmetries(held, plan), gravity) for other in (turned, tilted)]
        assert found[0].free_motions == free
        assert found[0].record.max_mm == pytest.approx(0.0, abs=1e-7)
        assert (found[1].rms_percent > 1.0) is off
        assert (found[1].record.heights_mm[1] > found[1].record.heights_mm[0] + 5.0) is off


@pytest.mark.slow
@pytest.mark.parametrize("pins", [[{"where": "border", "scale": 0.8}], [{"where": "corners", "slide": "plane"}],
                                  [{"where": "corners", "scale": 0.8, "offset_mm": [5.0, -3.0, 7.0]}]])  # fmt: skip
def test_images_of_a_supported_sheet_stand_on_its_supports(pins):
    """The image under a symmetry is at no distance from the shape, and its supported points are where they belong."""
    held = design(pins=pins)
    plan = layout(held)
    pin, same = plan.pins[0], symmetries(held, plan)
    assert len(same) == 6

    def place(points):
        """Held outline, lumpy inside."""
        inner = np.maximum(1.0 - np.abs(points @ plan.outline.T / (plan.outline**2).sum(axis=1)).max(axis=1), 0.0)
        return pin.places(points) + inner[:, None] * lumpy(points)

    one = shape(held, place)
    for symmetry in same:
        other = image(one, symmetry)
        np.testing.assert_allclose(other.at(plan.outline), pin.places(plan.outline), atol=1e-9)
        found = compare_shapes(one, other, plan, same)
        assert found.record.max_percent < 1e-6 and found.record.max_stars_percent < 1e-6


@pytest.mark.parametrize("number", range(6))
def test_images_under_the_designs_symmetries_are_the_same_shape(number):
    """A tube about one axis, and about an equivalent one; its mirror image on a mirrored print."""
    plan = layout(UNIFORM)
    same = symmetries(UNIFORM, plan)
    assert len(same) == 6
    one, symmetry = shape(UNIFORM, lumpy), same[number]
    flip = [-1.0 if symmetry.mirrors else 1.0, 1.0, 1.0]
    image = replace(one, positions=one.at(one.printed @ symmetry.turn.T + symmetry.shift) * flip)
    found = compare_shapes(one, image, plan, same)
    # the inverse of the symmetry brings it back
    assert np.allclose(found.symmetry.turn, symmetry.turn.T, atol=1e-9)
    assert found.symmetry.mirrors == symmetry.mirrors
    assert found.record.max_percent < 1e-6 and found.record.max_stars_percent < 1e-6
    assert found.record.normals_rms_deg == pytest.approx(0.0, abs=1e-6)
    assert found.record.heights_mm[0] == pytest.approx(found.record.heights_mm[1])
    assert found.record.relief_error_percent == pytest.approx(0.0, abs=1e-6)


def test_a_reflected_shape_is_another_one():
    one = shape(UNLIKE, lumpy)
    found = compared(UNLIKE, one, replace(one, positions=one.positions * [-1.0, 1.0, 1.0]))
    assert found.rms_percent > 1.0


def test_a_known_distance():
    """Two flat sheets, one a hundredth larger: every point is off by a hundredth of its radius."""
    one, other = (shape(UNIFORM, lambda p, s=s: np.column_stack([s * p, 0.0 * p[:, 0]])) for s in (1.0, 1.01))
    found = compared(UNIFORM, one, other)
    stars = np.linalg.norm(layout(UNIFORM).centres, axis=1)
    assert found.star_distance_mm == pytest.approx(0.01 * stars, abs=1e-9)
    rms_mm = np.sqrt((stars**2).mean())
    assert found.record.rms_stars_percent == pytest.approx(rms_mm / diameter(one.positions), rel=1e-9)
    assert found.record.volumes_mm3 == pytest.approx((0.0, 0.0), abs=1e-9)


def test_tubes_are_recognised():
    of = design(border={"rings": 2})
    found = compared(of, shape(of, rolled(20.0)), shape(of, rolled(22.0, 60.0)))
    assert found.record.roll_axes_deg == pytest.approx((0.0, 0.0), abs=1.0)  # 60 deg is the same by symmetry
    assert found.record.roll_radii_mm == pytest.approx((20.0, 22.0), rel=0.03)
    assert found.record.volumes_mm3 is None


def test_where_rolls_begin_does_not_part_two_that_are_alike():
    """Bowls half as curved along one direction as across it; one that is nearly round is another matter."""
    of = design(border={"rings": 2})

    def bowl(ratio):
        return shape(of, lambda p: np.column_stack([p, -(p[:, 0] ** 2 + ratio * p[:, 1] ** 2) / 60.0]))

    longer, rounder, round_ = bowl(0.45), bowl(0.6), bowl(0.9)
    assert compared(of, rounder, rounder).record.roll_axes_deg == [None, None]
    found = compared(of, longer, rounder)
    assert found.record.roll_axes_deg == pytest.approx((90.0, 90.0), abs=1.0) and found.record.roll_radii_mm is not None
    assert alike(found.record) and alike(compared(of, rounder, longer).record)
    assert compared(of, longer, round_).record.roll_axes_deg[1] is None


def test_volume_under_a_cap():
    """A paraboloid over a disc-like sheet: half of base times height; twice as high, twice as much."""
    of = design(border={"rings": 4})
    caps = [shape(of, lambda p, s=s: np.column_stack([p, -s * (p**2).sum(axis=1) / 200.0]), 3.0) for s in (1.0, 2.0)]
    one, other = compared(of, *caps).record.volumes_mm3
    area = surface_triangle_areas(caps[0].printed, caps[0].triangles).sum()
    # the mean over cells takes a little off at the outline
    assert one == pytest.approx(area**2 / np.pi / 200.0 / 2.0, rel=0.2)
    assert other == pytest.approx(2.0 * one, rel=0.02)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_rise_counts_from_what_is_held_whatever_hangs_below_or_beside_it(side):
    """A vault on two sides, which lie 2 mm high, with a dent of 1 mm at a corner that is free."""
    of = design(pins=[{"edges": [0, 3], "scale": 0.8, "offset_mm": [0.0, 0.0, 2.0]}])
    border = layout(of).outline
    across = border[0] + border[1]
    across /= across @ border[0]

    def place(rise):
        def at(points):
            dent = np.maximum(1.0 - np.linalg.norm(points - border[2], axis=1) / 5.0, 0.0)
            vault = rise * (1.0 - (points @ across) ** 2)
            return np.column_stack([points, 2.0 + side * (vault - (rise + 1.0) * dent)])

        return at

    found = compared(of, shape(of, place(5.0)), shape(of, place(5.5)))
    assert found.record.rises_mm == pytest.approx((5.0, 5.5), abs=0.06)
    assert found.record.heights_mm == pytest.approx((6.0, 6.5), abs=0.06)


@pytest.mark.slow
@pytest.mark.parametrize("pins", [[], [{"points_mm": [[0.0, 0.0]], "scale": 0.8}]])
def test_what_is_held_nowhere_or_at_one_point_has_no_rise(pins):
    of = design(pins=pins)
    assert compared(of, shape(of, lumpy), shape(of, lumpy)).record.rises_mm is None
