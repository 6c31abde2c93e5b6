"""The arms of the last stars bend a free rim along them, by how much fabric there is before their tips."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews.fields.rim_arms import RIM_ARM_FULL, RIM_ARM_START, arm_curvature, rim_curvature_share
from asterism.previews.fields.star_values import star_values
from asterism.previews.model import PREVIEW_MODEL, without
from asterism.previews.session import Preview
from tests.asterism.previews.laws import SPACING, places, plain_law

NONE, ALL, AMONG = RIM_ARM_START, RIM_ARM_FULL, PREVIEW_MODEL.rim_arm_among
WITHOUT = without("arms into free rims")

TUBE = gallery.load("tube")
PLAN = layout(TUBE)
VALUES = star_values(TUBE, PLAN, plain_law())
COUNT = len(PLAN.centres)
DIRECTIONS = np.asarray(TUBE.lattice.arm_directions)


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
    assert curvature(beside, normals, 3 * [reaches], half) == pytest.approx(0.0)


def test_arms_carry_on_what_the_fabric_before_them_allows() -> None:
    """A lone star in a rectangle: arms at 30, 150 and 270 degrees."""
    x, y = 0.5 * (ALL + NONE) * SPACING * np.sqrt(0.75), (NONE + 0.1 * (ALL - NONE)) * SPACING
    design = Design.from_dict(TUBE.to_dict() | {"border": {"rectangle_mm": [2.0 * x, 2.0 * y]}, "pins": []})
    plan = layout(design)
    directions = np.asarray(design.lattice.arm_directions)
    assert len(plan.centres) == 1
    part = rim_curvature_share(plan, directions)[0]
    assert part[np.abs(directions[:, 0]) > 0.5] == pytest.approx(0.5)
    assert part[directions[:, 1] < -0.9] == pytest.approx(0.1)
    # stars of a hexagon: arms that lead to others, and those of the last stars
    parts = rim_curvature_share(PLAN, np.asarray(TUBE.lattice.arm_directions))
    middle = int(np.linalg.norm(PLAN.centres, axis=1).argmin())
    assert parts[middle] == pytest.approx(AMONG)
    outwards = (np.sqrt(0.75) - NONE) / (ALL - NONE)
    assert np.unique(parts.round(9)) == pytest.approx(np.sort([AMONG, outwards]))


def test_arms_between_the_lattice_lines_lead_to_other_stars() -> None:
    design = Design.from_dict(TUBE.to_dict() | {"lattice": {"orientation_deg": 30.0}})
    plan = layout(design)
    middle = int(np.linalg.norm(plan.centres, axis=1).argmin())
    assert rim_curvature_share(plan, np.asarray(design.lattice.arm_directions))[middle] == pytest.approx(AMONG)


@pytest.mark.slow
def test_corners_under_arms_hang_from_a_free_hexagon() -> None:
    design = Design.from_dict(
        {
            "border": {"rings": 1},
            "stars": {"length_mm": 8.0, "thickness_mm": 0.35},
            "mesh": {"edge_mm": 1.6},
        }
    )
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


@pytest.mark.slow
def test_a_wide_rim_hangs_under_the_arms_that_point_into_it() -> None:
    """Seven stars in a rectangle: the two upper corners have arms before them, the two lower ones do not."""
    design = Design.from_dict(
        {
            "border": {"rectangle_mm": [70.0, 62.0]},
            "stars": {"length_mm": 8.0, "thickness_mm": 0.35},
            "mesh": {"edge_mm": 1.6},
        }
    )
    exact = exact_shape(design)
    border = Preview(design).sheet.layout.outline
    corners = 0.98 * border[np.argsort(border[:, 1])]

    def hang(places: np.ndarray) -> float:
        """mm, by how much the upper corners lie lower than the lower ones, seen from the middle of the sheet."""
        return float(np.linalg.norm(places[2] - places[3]) - np.linalg.norm(places[0] - places[1]))

    right, found = hang(exact.at(corners)), hang(Preview(design).at(corners).bumpy)
    without = hang(Preview(design, model=WITHOUT).at(corners).bumpy)
    assert abs(right) > 1.0
    assert abs(found - right) < 0.7 * abs(without - right), (right, found, without)


def test_no_arm_carries_on_more_than_all_of_its_curvature() -> None:
    design = Design.from_dict(TUBE.to_dict() | {"border": {"rectangle_mm": [90.0, 90.0], "star_margin_mm": 35.0}})
    plan = layout(design)
    assert len(plan.centres) == 1
    assert rim_curvature_share(plan, np.asarray(design.lattice.arm_directions)) == pytest.approx(1.0)


def test_a_rim_curls_along_an_arm_as_far_as_its_star_reaches() -> None:
    """Half of the share, half of the curvature."""
    one, nothing = np.eye(1, COUNT), sp.csr_matrix((1, COUNT))
    whole, half = (
        curvature(
            sp.csr_matrix(0.5 * one),
            np.array([[1.0, 0.0]]),
            [sp.csr_matrix(share * one), nothing, nothing],
            np.ones((COUNT, 3)),
        )
        for share in (1.0, 0.5)
    )
    assert np.abs(whole).max() > 0.0
    assert half == pytest.approx(0.5 * whole)
