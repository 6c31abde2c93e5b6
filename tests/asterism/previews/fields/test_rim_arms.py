"""Free rims: arms of the last stars bend them by how much fabric there is before their tips, holes have none."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.sheet_fields import (
    RIM_ARM_FULL,
    RIM_ARM_START,
    arm_curvature,
    free_normals,
    hole_sites,
    in_holes,
    rim_curvature_share,
    without,
)
from asterism.previews.fields.star_values import star_values
from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.session import Preview
from tests.asterism.previews.designs import edited
from tests.asterism.previews.laws import SPACING, places, plain_law

NONE, ALL, AMONG = RIM_ARM_START, RIM_ARM_FULL, PREVIEW_MODEL.rim_arm_among
WITHOUT = without("arms into free rims")

TUBE = gallery.load("tube")
PLAN = layout(TUBE)
VALUES = star_values(TUBE, PLAN, plain_law())
COUNT = len(PLAN.centres)
DIRECTIONS = np.asarray(TUBE.lattice.arm_directions)
RECTANGLE = {"rectangle_mm": [80.0, 60.0]}


def tube(border: dict[str, object], **sections: Any) -> Layout:
    return layout(Design.from_dict(TUBE.to_dict() | {"border": border} | sections))


def curvature(beside: sp.csr_matrix, normals: Floats, along: list[sp.csr_matrix], carried: Floats) -> Floats:
    """(n, 3) 1/mm, where stars have shares `beside` n places, and `along` half a spacing back along each arm."""
    stars = {"directions": DIRECTIONS, "normals": normals, "carried": carried}
    return arm_curvature(places(beside, VALUES, (len(normals), 1), along, **stars))


def test_arms_carry_their_curvature_into_a_free_rim() -> None:
    """Where only the star back along the first arm reaches, that direction curls, and the other one by as much less."""
    beside = sp.csr_matrix(np.full((3, 1), 0.5) * np.eye(1, COUNT))
    reaches, nothing = sp.csr_matrix(np.ones((3, 1)) * np.eye(1, COUNT)), sp.csr_matrix((3, COUNT))
    normals = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
    all_of_it = np.ones((COUNT, 3))
    found = curvature(beside, normals, [reaches, nothing, nothing], all_of_it)
    kappa = VALUES.value["kappa"][0]
    x, y = DIRECTIONS[0]
    assert found[0] @ [x * x, y * y, 2.0 * x * y] == pytest.approx(2.0 / 3.0 * kappa)
    assert found[0, 0] + found[0, 1] == pytest.approx(0.0)
    assert found[1] == pytest.approx(found[0])
    assert found[2] == pytest.approx(0.0)  # where the rim is held
    half = np.where(np.arange(3) == 0, 0.5, all_of_it)
    assert curvature(beside, normals, [reaches, nothing, nothing], half) == pytest.approx(0.5 * found)
    assert curvature(beside, normals, [0.5 * reaches, nothing, nothing], all_of_it) == pytest.approx(0.5 * found)
    assert curvature(beside, normals, 3 * [reaches], half) == pytest.approx(0.0)


def test_arms_carry_on_what_the_fabric_before_them_allows() -> None:
    """A lone star in a rectangle: arms at 30, 150 and 270 degrees."""
    x, y = 0.5 * (ALL + NONE) * SPACING * np.sqrt(0.75), (NONE + 0.1 * (ALL - NONE)) * SPACING
    plan = tube({"rectangle_mm": [2.0 * x, 2.0 * y]})
    assert len(plan.centres) == 1
    part = rim_curvature_share(plan, DIRECTIONS)[0]
    assert part[np.abs(DIRECTIONS[:, 0]) > 0.5] == pytest.approx(0.5)
    assert part[DIRECTIONS[:, 1] < -0.9] == pytest.approx(0.1)
    # stars of a hexagon: arms that lead to others, and those of the last stars
    parts = rim_curvature_share(PLAN, DIRECTIONS)
    middle = int(np.linalg.norm(PLAN.centres, axis=1).argmin())
    assert parts[middle] == pytest.approx(AMONG)
    outwards = (np.sqrt(0.75) - NONE) / (ALL - NONE)
    assert np.unique(parts.round(9)) == pytest.approx(np.sort([AMONG, outwards]))
    # arms between the lines of the lattice lead to other stars too, and none carries on more than all of its curvature
    turned = Design.from_dict(TUBE.to_dict() | {"lattice": {"orientation_deg": 30.0}})
    plan = layout(turned)
    middle = int(np.linalg.norm(plan.centres, axis=1).argmin())
    assert rim_curvature_share(plan, np.asarray(turned.lattice.arm_directions))[middle] == pytest.approx(AMONG)
    wide = tube({"rectangle_mm": [90.0, 90.0], "star_margin_mm": 35.0})
    assert rim_curvature_share(wide, DIRECTIONS) == pytest.approx(np.ones((1, 3)))


@pytest.mark.slow
def test_corners_under_arms_hang_from_a_free_hexagon() -> None:
    stars = {"length_mm": 8.0, "thickness_mm": 0.35}
    design = Design.from_dict({"border": {"rings": 1}, "stars": stars, "mesh": {"edge_mm": 2.4}})
    exact = exact_shape(design)
    corners = 0.99 * Preview(design).sheet.layout.outline

    def turns(places: np.ndarray) -> float:
        """mm, by how much three corners of the hexagon lie higher than the other three."""
        heights = places - places.mean(axis=0)
        normal = np.linalg.svd(heights)[2][2]
        return float(abs((heights[::2] - heights[1::2]).mean(axis=0) @ normal))

    right, found = turns(exact.at(corners)), turns(Preview(design).at(corners).bumpy)
    without = turns(Preview(design, model=WITHOUT).at(corners).bumpy)
    assert right > 1.0
    assert abs(found - right) < 0.7 * abs(without - right), (right, found, without)


def test_normals_are_those_of_the_nearest_side_and_vanish_where_it_is_held() -> None:
    places = np.array([[35.0, 0.0], [-35.0, 2.0], [0.0, 25.0], [3.0, -25.0]])
    free = tube(RECTANGLE)
    expected = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    assert free_normals(free, places) == pytest.approx(expected)
    middle = 0.5 * (free.outline + np.roll(free.outline, -1, axis=0))
    held = int(middle[:, 0].argmax())
    plan = tube(RECTANGLE, pins=[{"edges": [held], "scale": 0.8}])
    assert free_normals(plan, places) == pytest.approx(expected * np.array([[0.0], [1.0], [1.0], [1.0]]))
    # points on the right side and near the lower one
    pulled = tube(RECTANGLE, pins=[{"points_mm": [[40.0, 5.0], [10.0, -28.0]], "scale": 0.8}])
    assert free_normals(pulled, places) == pytest.approx(expected * np.array([[0.0], [1.0], [1.0], [0.0]]))
    sliding = tube(RECTANGLE, pins=[{"points_mm": [[40.0, 5.0], [10.0, -28.0]], "slide": "plane"}])
    assert free_normals(sliding, places) == pytest.approx(expected)
    alone = tube(RECTANGLE, pins=[{"points_mm": [[40.0, 25.0]], "scale": 0.8}])
    assert free_normals(alone, places) == pytest.approx(expected)


def test_a_side_in_pieces_is_one_side() -> None:
    """Held at a corner it keeps no curl along its whole length, however many corners lie on it."""
    corners = PLAN.outline
    pieces = np.concatenate(
        [np.linspace(a, b, 5)[:-1] for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    )
    points = np.random.default_rng(3).uniform(-60.0, 60.0, (200, 2))
    for held in (corners[:1], corners[:2], corners[::3]):
        pins = [{"points_mm": held.tolist(), "scale": 0.9}]
        rings = corners.tolist(), np.roll(pieces, 2, axis=0).tolist()
        one, other = (free_normals(tube({"polygon_mm": ring}, pins=pins), points) for ring in rings)
        np.testing.assert_allclose(one, other, atol=1e-9)


def without_stars(border: dict[str, object], *removed: int) -> Layout:
    return tube(
        border, stars=TUBE.to_dict()["stars"] | {"override": [{"star": star, "remove": True} for star in removed]}
    )


def test_places_nearer_to_a_removed_star_than_to_others_are_in_its_hole() -> None:
    assert len(hole_sites(PLAN)) == 0 and not in_holes(PLAN, PLAN.outline).any()
    wide = hole_sites(without_stars(TUBE.to_dict()["border"], *range(7)))
    assert np.sort(np.linalg.norm(wide, axis=1)) == pytest.approx([0.0, *[SPACING] * 6], abs=1e-9)
    plan = without_stars(TUBE.to_dict()["border"], 0)
    assert hole_sites(plan) == pytest.approx(np.zeros((1, 2)), abs=1e-9)
    there = np.array([[0.0, 0.0], [0.0, 0.49 * SPACING], [0.0, 0.51 * SPACING], plan.outline[0]])
    assert in_holes(plan, there).tolist() == [True, True, False, False]


def test_the_fabric_of_a_hole_does_not_dip() -> None:
    """In the exact model it is 0.1 mm above the stars around it; with a rim's fall it would be 1.6 mm below them."""
    stars = {"length_mm": 9.0, "thickness_mm": 0.5, "override": [{"star": 0, "remove": True}]}
    preview = Preview(edited("tube", border={"rings": 2}, stars=stars))
    turns = np.radians(30.0 + 60.0 * np.arange(6))
    around = preview.at(SPACING * np.column_stack([np.cos(turns), np.sin(turns)])).bumpy
    middle = around.mean(axis=0)
    normal = np.linalg.svd(around - middle)[2][2]
    above = float((preview.at(np.zeros((1, 2))).bumpy[0] - middle) @ normal * np.sign(normal[2]))
    assert abs(above) < 0.4


def test_what_is_open_to_the_rim_is_no_hole() -> None:
    border = {"rectangle_mm": [100.0, 90.0], "star_margin_mm": 0.8 * SPACING}
    whole = tube(border)
    assert len(hole_sites(whole)) == 0
    # a star missing from any side of a wide rim, and a row of them from the middle to the rim
    for axis in whole.lattice_vectors @ np.array([[0.0, -1.0], [1.0, 0.0]]):
        along = whole.centres @ axis
        for star in (along.argmin(), along.argmax()):
            assert len(hole_sites(without_stars(border, int(whole.star_number[star])))) == 0
    row = PLAN.star_number[(np.abs(PLAN.centres[:, 0]) < 1.0) & (PLAN.centres[:, 1] > -1.0)]
    assert len(hole_sites(without_stars(TUBE.to_dict()["border"], *row.tolist()))) == 0
    # a narrow dent takes a site's place, with stars all around; or it runs between stars, that site alone has none
    dent = [[-60, -50], [60, -50], [60, 50], [1.5, 50], [0, -3], [-1.5, 50], [-60, 50]]
    assert len(hole_sites(tube({"polygon_mm": dent}))) == 0
    polygon = [[-60, -50], [60, -50], [60, -0.5], [3, 0], [60, 0.5], [60, 50], [-60, 50]]
    plan = tube({"polygon_mm": polygon, "star_margin_mm": 6.0})
    assert np.linalg.norm(plan.centres, axis=1).min() == pytest.approx(SPACING)
    assert (np.linalg.norm(plan.centres, axis=1) < 1.01 * SPACING).sum() == 6
    assert len(hole_sites(plan)) == 0
