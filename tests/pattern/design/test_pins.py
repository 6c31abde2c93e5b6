"""Pins: which places of the sheet are held, and where; those further apart than fabric stretches are refused."""

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.planar import triangle_angles
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout


def plan(*tables, border=None, **more):
    border = border or {"rectangle_mm": [100, 60]}
    return layout(Design.from_dict({"stars": {"length_mm": 10}, "border": border, "pins": list(tables), **more}))


def pins(*tables, border=None):
    return plan(*tables, border=border).pins


def test_border_scaled():
    (held,) = pins({"where": "border", "scale": 0.74}, border={"rings": 3})
    assert held.edges == tuple(range(6)) and len(held.points) == 0 and held.fixed == (True, True, True)
    np.testing.assert_allclose(held.places(np.array([[10.0, -20.0]])), [[7.4, -14.8, 0]])


@pytest.mark.parametrize(
    ("table", "printed", "places"),
    [
        ({"corners": [0, 2], "offset_mm": [1, 2, 3]}, [[-50, -30], [50, 30]], [[-49, -28, 3], [51, 32, 3]]),
        ({"points_mm": [[10, 5]], "target_mm": [1, 2, 3]}, [[10, 5]], [[1, 2, 3]]),
        ({"points_mm": [[10, 5]], "target_mm": [[1, 2, 3]]}, [[10, 5]], [[1, 2, 3]]),
    ],
)
def test_places_of_points(table, printed, places):
    (held,) = pins(table)
    np.testing.assert_allclose(held.points, printed)
    np.testing.assert_allclose(held.places(held.points), places)


@pytest.mark.parametrize(
    "other", [{"where": "border"}, {"edges": [0]}, {"corners": [1, 3]}, {"points_mm": [[-20, -10]]}]
)
@pytest.mark.parametrize("swapped", [False, True])
def test_targets_beside_other_pins(other, swapped):
    masts = {"points_mm": [[10, 5], [0, -5]], "target_mm": [[9, 4, 20], [0, -5, 15]]}
    sets = [masts, {**other, "scale": 0.8}]
    held = pins(*sets[::-1] if swapped else sets)[swapped]
    np.testing.assert_allclose(held.places(held.points), masts["target_mm"])


@pytest.mark.parametrize(("slide", "fixed"), [("z", (True, True, False)), ("plane", (False, False, True))])
def test_slides(slide, fixed):
    (held,) = pins({"edges": [1], "slide": slide})
    assert held.edges == (1,) and held.fixed == fixed


def test_neighbouring_edges_that_slide_share_a_corner_that_both_hold_in_z():
    assert len(pins({"edges": [0], "scale": 0.7, "slide": "plane"}, {"edges": [1], "slide": "plane"})) == 2
    with pytest.raises(DesignError, match=r"pins\[1\].*: must hold the corner as pins\[0\] does"):
        pins({"edges": [0], "scale": 0.7, "slide": "z"}, {"edges": [1], "slide": "z"})


@pytest.mark.parametrize("off", [-0.15, -1e-4, 1e-4, 0.15])
def test_points_written_with_few_digits_are_on_the_outline(off):
    (held,) = pins({"points_mm": [[50 + off, 12], [-50 - off, 30 + off], [10, 30 - off], [0, 29]], "scale": 0.9})
    np.testing.assert_allclose(held.points, [[50, 12], [-50, 30], [10, 30], [0, 29]], atol=1e-12)
    np.testing.assert_allclose(held.places(held.points)[0], [45, 10.8, 0])


def test_points_off_the_sheet_or_nearly_the_same_are_refused():
    with pytest.raises(DesignError, match=r"pins\[0\].points_mm\[1\] = \[50.3, 0.0\]: must be on the sheet"):
        pins({"points_mm": [[0, 0], [50.3, 0]]})
    with pytest.raises(DesignError, match=r"must not hold the same place twice, within 0.25 mm"):
        pins({"points_mm": [[0, 0], [0.1, 0]]})
    with pytest.raises(DesignError, match=r"pins\[1\].*must not hold what pins\[0\] holds already"):
        pins({"points_mm": [[0, 0]]}, {"points_mm": [[0.1, 0]], "step": 1})


def test_corners_of_a_finely_drawn_outline_may_be_close():
    corners = [[30 * np.cos(t), 30 * np.sin(t)] for t in 2 * np.pi * np.arange(1000) / 1000]
    (held,) = pins({"where": "corners", "scale": 0.8}, border={"polygon_mm": corners})
    assert len(held.points) == 1000


@pytest.mark.parametrize(
    ("tables", "pulled"),
    [
        ([], False),
        ([{"points_mm": [[0, 0]]}], False),
        ([{"where": "corners", "slide": "plane"}, {"points_mm": [[0, 0]]}], False),
        ([{"where": "border", "slide": "plane"}], False),
        ([{"where": "corners", "slide": "z"}], True),
        ([{"points_mm": [[0, 0]]}, {"points_mm": [[10, 0]], "step": 1}], True),
        ([{"edges": [0]}], True),
    ],
)
def test_pins_that_pull(tables, pulled):
    assert plan(*tables).is_supported_in_plane == pulled


@pytest.mark.parametrize(
    ("written", "place"),
    [
        ([15.0, 8.66], [15.0, 8.660254]),  # a star's centre
        ([8.66, 5.0], [8.660254, 5.0]),  # a tip
        ([0.05, -5.0], [0.0, -5.0]),  # on an arm
        ([0.5, -5.0], [0.5, -5.0]),  # beside it
        ([27.9, 0.0], [27.9, 0.0]),  # on the outline, to which it was taken
    ],
    ids=["centre", "tip", "arm", "beside", "outline"],
)
def test_points_beside_the_plastic_are_on_it(written, place):
    """No mesh has good triangles between a pin and an arm that are nearer than a needle is thick."""
    sheet = plan({"points_mm": [written]}, border={"rings": 1}, mesh={"edge_mm": 2.0})
    (held,) = sheet.pins
    near = written if place != written else held.points[0]
    assert np.linalg.norm(held.points[0] - near) < 0.25
    if place != [27.9, 0.0]:
        np.testing.assert_allclose(held.points[0], place, atol=1e-6)
    mesh = mesh_layout(sheet, 2.0)
    assert triangle_angles(mesh.points, mesh.triangles).min() > 10.0
    assert mesh.points[mesh.pin_vertices[0][0]] == pytest.approx(held.points[0], abs=1e-9)


@pytest.mark.slow
def test_many_pins_agree_soon():
    """A thousand sets of one point or one edge, as many as are allowed, and one that is wrong."""
    corners = [[200 * np.cos(t), 200 * np.sin(t)] for t in 2 * np.pi * np.arange(1000) / 1000]
    border = {"polygon_mm": corners}
    sets = [{"edges": [k]} for k in range(998)]
    assert len(pins(*sets, border=border)) == 998
    with pytest.raises(DesignError, match=r"pins\[998\] = 'edge 700': must not hold what pins\[700\] holds already"):
        pins(*sets, {"edges": [700]}, border=border)
    with pytest.raises(DesignError, match=r"pins\[998\].*: must hold the corner as pins\[997\] does"):
        pins(*sets, {"edges": [998], "scale": 0.9}, border=border)


@pytest.mark.parametrize("count", [2, 3, 10_000])
def test_many_points_in_one_place_are_one_mistake(count):
    places = [[10.0 + 1e-6 * k, 5.0] for k in range(count)]
    with pytest.raises(DesignError, match=r"pins\[0\] = \[10.0, 5.0\]: must not hold the same place twice"):
        pins({"points_mm": places})


@pytest.mark.parametrize(
    "tables",
    [
        [{"where": "corners", "scale": 4.0}],
        [{"where": "border", "scale": 4.0}],
        [{"corners": [0]}, {"corners": [3], "offset_mm": [0.0, 0.0, 2000.0]}],
        [{"points_mm": [[-20.0, 0.0], [20.0, 0.0]], "target_mm": [[-2000.0, 0.0, 0.0], [20.0, 0.0, 0.0]]}],
        [{"points_mm": [[x, 0.5 * x] for x in range(-30, 31)], "scale": 9.0}],
    ],
)
def test_pins_that_are_too_far_apart_are_named(tables):
    with pytest.raises(DesignError, match=r"pins\[\d\]: pulls the sheet to .* at most 3 times") as caught:
        pins(*tables, border={"rings": 2})
    assert caught.value.place_mm is not None


@pytest.mark.parametrize(
    "tables",
    [
        [{"where": "corners", "scale": 2.9}],
        [{"corners": [0, 1]}, {"corners": [3], "offset_mm": [0.0, 0.0, 2000.0], "slide": "z"}],
        [{"points_mm": [[0.0, 0.0], [1.0, 0.0]], "target_mm": [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]]}],
    ],
)
def test_pins_within_reach_are_allowed(tables):
    pins(*tables, border={"rings": 2})


def test_both_ends_of_a_bent_strip_may_be_far_apart():
    """Their distance on the print is short, but the sheet between them is long."""
    border = {"polygon_mm": [[0, 0], [150, 0], [150, 100], [110, 100], [110, 40], [40, 40], [40, 100], [0, 100]]}
    ends = {"points_mm": [[40.0, 100.0], [110.0, 100.0]]}
    pins({**ends, "target_mm": [[-80.0, 100.0, 0.0], [230.0, 100.0, 0.0]]}, border=border)
    with pytest.raises(DesignError, match="times its printed length"):
        pins({**ends, "target_mm": [[-800.0, 100.0, 0.0], [900.0, 100.0, 0.0]]}, border=border)
