"""Plastic below the fabric: the mirror image of plastic above, in both models, and sheets with both."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.draw.scene import ribbons
from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.session import Preview, preview
from asterism.shape.shape import Shape
from asterism.studio.star_sizes import split

STARS: dict[str, Any] = {"stars": {"length_mm": 10.0, "thickness_mm": 0.4}, "border": {"rings": 1}}
LINES: dict[str, Any] = {
    "rods": {"thickness_mm": 0.4, "motif": [{"line_mm": [(0, 0), (10, 0)]}]},
    "lattice": {"kind": "square", "spacing_mm": 10.0},
    "border": {"rectangle_mm": [60.0, 40.0]},
}
MIRROR = np.array([1.0, 1.0, -1.0])


def turned(data: dict[str, Any]) -> dict[str, Any]:
    """The same design with all plastic below."""
    section = "stars" if "stars" in data else "rods"
    return {**data, section: {**data[section], "side": "below"}}


def half_below(data: dict[str, Any]) -> Design:
    """The same stars, those with x > 1 mm below."""
    sheet = layout(Design.from_dict(data))
    below = [{"site": site, "side": "below"} for site in sheet.sites[sheet.centres[:, 0] > 1.0].tolist()]
    return Design.from_dict({**data, "stars": {**data["stars"], "override": below}})


def is_mirror_image(shape: Shape, other: Shape) -> None:
    assert shape.summary.is_minimum and other.summary.is_minimum and shape.height_mm > 1.0
    assert other.summary.energy_n_mm == pytest.approx(shape.summary.energy_n_mm, rel=1e-9)
    np.testing.assert_allclose(other.positions, MIRROR * shape.positions, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("data", [STARS, LINES], ids=["stars", "rods"])
def test_the_exact_shape_with_plastic_below_is_the_mirror_image(data: dict[str, Any]) -> None:
    data = {**data, "mesh": {"edge_mm": 3.0}, "fabric": {"modulus_mpa": 1.0, "stretch": [1.35, 1.3]}}
    shape, other = (exact_shape(Design.from_dict(each)) for each in (data, turned(data)))
    is_mirror_image(shape, other)
    for key in ("stars_up", "stars_off_branch", "peel_n_per_mm"):
        assert other.summary[key] == pytest.approx(shape.summary[key])
    for key in ("curvature_per_mm", "peel_n_per_mm", "shear_n_per_mm"):
        np.testing.assert_allclose(other.rod_fields[key], shape.rod_fields[key], atol=1e-6)
    assert (other.rod_fields["side"] == -1).all() and "side" not in shape.rod_fields


@pytest.mark.parametrize("data", [STARS, pytest.param({}, marks=pytest.mark.slow)], ids=["stars", "motif"])
def test_the_preview_with_plastic_below_is_the_mirror_image(data: dict[str, Any]) -> None:
    data = data or gallery.load("parallel-lines").to_dict()
    shape, other = (preview(Design.from_dict(each)) for each in (data, turned(data)))
    is_mirror_image(shape, other)
    bumps = shape.point_fields.get("bump_mm")
    if bumps is not None:
        np.testing.assert_allclose(other.point_fields["bump_mm"], MIRROR * bumps, atol=1e-6)


def test_a_star_that_starts_down_is_inverted_towards_the_fabric_on_either_side() -> None:
    """A branch counts from the plastic's side."""
    stars = {"length_mm": 10.0, "thickness_mm": 0.3, "branch": "down"}
    data = {"stars": stars, "border": {"rings": 0}, "mesh": {"edge_mm": 2.4}}
    up, down = (exact_shape(Design.from_dict(each)).summary for each in (data, turned(data)))
    assert up["stars_up"] == down["stars_up"] and up["stars_off_branch"] == down["stars_off_branch"]


def test_a_sheet_with_both_sides_bends_both_ways_in_both_models() -> None:
    """The preview is as near to the exact shape as for plastic on one side: 4 % at most for free sheets."""
    design = half_below({**STARS, "border": {"rings": 2}, "mesh": {"edge_mm": 2.4}})
    quick = preview(design)
    exact = exact_shape(design, near=quick, edge_mm=2.4)
    curvature = quick.point_fields["mean_curvature_per_mm"]
    x = quick.printed[:, 0]
    assert np.nanmean(curvature[x < -10.0]) > 0.005 and np.nanmean(curvature[x > 10.0]) < -0.005
    assert exact.summary.is_minimum and exact.summary.stars_up == 19
    assert quick.height_mm == pytest.approx(exact.height_mm, rel=0.08)


def test_arms_below_are_drawn_below() -> None:
    design = half_below(STARS)
    shape = preview(design)
    _, normals, _ = ribbons(shape)
    edges = shape.rod_edges
    assert (shape.rod_fields["side"] < 0).any() and (shape.rod_fields["side"] > 0).any()
    assert len(normals) == 2 * (len(edges) + len(shape.rods))
    first = np.cumsum([0, *(len(rod) for rod in shape.rods)])[:-1]
    up = normals[first][:, 2] > 0.0
    side = shape.rod_fields["side"][np.cumsum([0, *(len(rod) - 1 for rod in shape.rods)])[:-1]]
    assert (up == (side > 0)).all()


def test_designs_without_a_side_are_unchanged_and_edits_keep_it() -> None:
    assert "side" not in Design.from_dict(STARS).to_dict()["stars"]
    design = half_below(STARS)
    assert Design.from_dict(design.to_dict()) == design
    session = Preview(Design.from_dict(STARS))
    np.testing.assert_allclose(session.update(design).positions, preview(design).positions, atol=1e-5)
    assert [len(symmetries(each, layout(each))) for each in (Design.from_dict(STARS), design)] == [6, 1]
    rest, sites, _, _ = split(design.to_dict())  # what the studio's engine gets
    assert len(sites) == 0 and rest["stars"]["override"] == design.to_dict()["stars"]["override"]


@pytest.mark.parametrize(
    ("stars", "words"),
    [
        ({"length_mm": 10.0, "side": "under"}, r"^stars\.side = 'under': .*above.*below"),
        ({"length_mm": 10.0, "override": [{"star": 0}]}, r"^stars\.override\[0\]: must either .* branch or side"),
    ],
)
def test_mistakes_are_one_line(stars: dict[str, Any], words: str) -> None:
    with pytest.raises(DesignError, match=words):
        Design.from_dict({"stars": stars})
