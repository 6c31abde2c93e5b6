"""The radius of a rolled sheet, its height over its needles, and whether it passes through itself."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import asterism
from asterism.equilibrium.arrays import Floats, Ints
from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.results.words import direction, roll
from asterism.shape.comparison import compare_shapes
from asterism.shape.measures import needle_clearance, tube_radius
from asterism.shape.surface import meets_itself, self_intersections
from tests.asterism import sheets


@pytest.mark.parametrize(("radius", "turn"), [(10.0, 5.0), (30.0, 2.0), (80.0, 0.8)])
def test_radius_of_a_tube(radius: float, turn: float) -> None:
    """Wherever it stands, and where its normals are a little off."""
    rng = np.random.default_rng(0)
    angle, along = turn * (rng.random(60) - 0.5), 40.0 * rng.random(60)
    normals = np.column_stack([0.0 * along, np.sin(angle), np.cos(angle)])
    points = np.column_stack([along, radius * normals[:, 1], radius * normals[:, 2]])
    turned = Rotation.random(rng=rng).as_matrix().T
    shaken = normals + 0.1 * rng.standard_normal(normals.shape)
    assert tube_radius(points @ turned + 7.0, shaken @ turned) == pytest.approx(radius, rel=1e-6)


def test_what_is_as_near_to_a_plane_is_no_tube() -> None:
    """A ring that waves."""
    turns = np.arange(6) * np.pi / 3.0
    flat = 17.0 * np.column_stack([np.cos(turns), np.sin(turns)])
    waving = np.vstack([[0.0, 0.0, 0.0], np.column_stack([flat, 2.0 * np.cos(3.0 * turns)])])
    assert tube_radius(waving, np.tile([0.0, 0.0, 1.0], (7, 1))) is None


@pytest.mark.slow
def test_both_models_say_how_far_a_sheet_rolls() -> None:
    """19 stars that curl tightly; a flatter roll on so coarse a mesh has no certain radius."""
    stars = {"length_mm": 10.0, "thickness_mm": 0.35}
    design = Design.from_dict({"stars": stars, "border": {"rings": 2}, "mesh": {"edge_mm": 1.7}})
    shown, plan = asterism.preview(design), layout(design)
    released = exact_shape(design, near=shown)
    preview, exact = (shape.summary["roll_radius_mm"] for shape in (shown, released))
    assert 10.0 < exact < 20.0 and preview == pytest.approx(exact, rel=0.15)
    # and it is the one that they are compared by
    radii = compare_shapes(released, shown, plan, symmetries(design, plan)).record.roll_radii_mm
    assert (exact, preview) == pytest.approx(radii, rel=0.005)


def test_four_stars_are_on_many_tubes() -> None:
    """Two edges pushed together; a star in the middle is left out."""
    of = {
        "stars": {"length_mm": 8.0, "thickness_mm": 0.3, "override": [{"star": 2, "remove": True}]},
        "border": {"rectangle_mm": [60.0, 40.0]},
        "pins": [{"edges": [1, 3], "scale": 0.5}],
        "mesh": {"edge_mm": 4.0},
    }
    shape = asterism.preview(asterism.Design.from_dict(of))
    assert len(shape.star_vertices) == 4 and shape.summary["roll_radius_mm"] is None
    assert tube_radius(np.eye(4, 3), np.eye(4, 3)) is None
    assert [direction(axis) for axis in (0.0, 45.4, 179.4, 179.996)] == ["0", "45", "179", "0"]
    assert roll(90.0, None) == "90 deg" and roll(179.996, 68.04) == "0 deg, radius 68.0 mm"


def saddle(flat: Floats) -> Floats:
    """20 mm up at the ends along x, 8 mm down at the ends along y."""
    x, y = flat.T
    return np.column_stack([flat, 20.0 * (x / 50.0) ** 2 - 8.0 * (y / 40.0) ** 2])


@pytest.mark.parametrize(
    ("points", "above", "below"),
    [
        ([[0.0, 0.0]], 20.0, 8.0),
        ([[0.0, 0.0], [50.0, 0.0]], 0.0, 8.0),
        ([[0.0, -40.0], [0.0, 40.0]], 28.0, 0.0),
        ([], None, None),
    ],
)
def test_heights_count_from_the_highest_and_from_the_lowest_needle(
    points: list[list[float]], above: float | None, below: float | None
) -> None:
    data = {"stars": {"length_mm": 8.0}, "border": {"rectangle_mm": [100.0, 80.0]}}
    plan = layout(Design.from_dict(data | {"pins": [{"points_mm": points}] if points else []}))
    clearance = needle_clearance(plan, sheets.sheet(saddle, edge=4.0))
    if above is None or below is None:
        assert clearance is None
    else:
        assert clearance == pytest.approx((above, below), abs=0.2)


def strip(turns: float, lean: float) -> tuple[Floats, Floats, Ints]:
    """A print of 60 x 20 mm rolled by so many turns about an axis that leans from its short sides."""
    x, y = np.meshgrid(np.arange(0.0, 61.0), np.arange(0.0, 21.0), indexing="ij")
    number = np.arange(x.size).reshape(x.shape)
    a, b, c, d = number[:-1, :-1].ravel(), number[1:, :-1].ravel(), number[1:, 1:].ravel(), number[:-1, 1:].ravel()
    printed = np.column_stack([x.ravel(), y.ravel()])
    across, along = np.cos(lean) * printed[:, 0] + np.sin(lean) * printed[:, 1], printed @ [-np.sin(lean), np.cos(lean)]
    radius = 60.0 / (2 * np.pi * turns)
    # the second turn lies inside the first one up to half a turn, and outside from there
    angle = across / radius
    rolled = radius * (1.0 + 0.1 * np.cos(0.5 * angle))
    positions = np.column_stack([rolled * np.sin(angle), along, rolled * np.cos(angle)])
    return printed, positions, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


@pytest.mark.parametrize("lean", [0.0, 0.3])
@pytest.mark.parametrize(("turns", "meets"), [(0.5, False), (0.9, False), (1.7, True), (2.2, True)])
def test_rolls_meet_themselves_past_one_and_a_half_turns(turns: float, lean: float, meets: bool) -> None:
    printed, positions, triangles = strip(turns, lean)
    assert meets_itself(printed, positions, triangles) == meets
    assert (self_intersections(positions, triangles) > 0) == meets
    flat = np.column_stack([printed, np.zeros(len(printed))])
    assert not meets_itself(printed, flat, triangles) and self_intersections(flat, triangles) == 0
