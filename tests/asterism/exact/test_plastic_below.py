"""Plastic below the fabric: the mirror image of plastic above, in both models; stars and lines on both faces."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.draw.scene import ribbons
from asterism.exact.simulation import exact_shape
from asterism.homogenize.campaign.design_plan import plan_for_design
from asterism.homogenize.errors import ForeignLaw
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews.session import Preview, preview
from asterism.shape.shape import Shape
from asterism.studio.star_sizes import split
from tests.asterism.print.jobs import job

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


SHEET: dict[str, Any] = {"border": {"rectangle_mm": [44.0, 44.0]}, "mesh": {"edge_mm": 4.0}}
NET = {"kind": "square", "spacing_mm": 10.0}


def net(rows: str = "above", columns: str = "below", **more: Any) -> Design:
    """A square net of drawn lines, four along x and four along y."""
    draw = [
        {"name": f"{name} {at:g}", "line_mm": [(at, -20), (at, 20)] if name == "column" else [(-20, at), (20, at)]}
        | {"side": side}
        for name, side in (("row", rows), ("column", columns))
        for at in (-15.0, -5.0, 5.0, 15.0)
    ]
    return Design.from_dict({"rods": {"draw": draw, "thickness_mm": 0.4}, **SHEET, **more})


def motif(first: str | None = None, second: str | None = "below", **rods: Any) -> Design:
    """The same net as a motif."""
    sides = [{} if side is None else {"side": side} for side in (first, second)]
    lines = [{"line_mm": line} | side for line, side in zip(([(0, 0), (10, 0)], [(0, 0), (0, 10)]), sides, strict=True)]
    return Design.from_dict({"rods": {"motif": lines, "thickness_mm": 0.4, **rods}, "lattice": NET, **SHEET})


def test_lines_of_two_faces_share_the_place_and_no_joint() -> None:
    designs = net(), net("above", "above")
    both, one = (layout(design).graph for design in designs)
    assert len(one.joints) == 16 and len(one.links) == 0
    assert both.joints == () and len(both.links) == 32 and len(both.nodes) == len(one.nodes) + 16
    crossing = [node for node, ends in enumerate(both.ends_at) if len(ends) == 2]
    assert len(np.unique(both.nodes[crossing].round(9), axis=0)) == 16
    for node in crossing:
        first, second = both.ends_at[node]
        assert both.rods[first.rod].name == both.rods[second.rod].name
    assert [len(symmetries(design, layout(design))) for design in designs] == [4, 8]


def test_corners_and_branches_of_one_face_are_joints_beside_lines_of_the_other() -> None:
    lines = [
        {"line_mm": [(-15, 0), (0, 0), (0, 15)], "side": "below"},
        {"line_mm": [(-12, -12), (12, 12)]},
        {"line_mm": [(0, 0), (15, -6)]},
    ]
    plan = layout(Design.from_dict({"rods": {"draw": lines}, **SHEET}))
    (below,) = [node for node in plan.graph.joints if len(plan.graph.ends_at[node]) == 2]
    (above,) = [node for node in plan.graph.joints if len(plan.graph.ends_at[node]) == 3]
    assert np.abs(plan.graph.nodes[[above, below]]).max() < 1e-9
    model = DiscreteModel(Design.from_dict({"rods": {"draw": lines}, **SHEET}), plan, mesh_layout(plan, 4.0))
    assert model.joints.vertices[0] == model.joints.vertices[1] and len(model.joints.edge) == 5


def test_tips_of_stars_on_two_faces_are_not_bonded() -> None:
    """As for lines: with the middle one of seven stars below, no tip bonds to it."""
    data: dict[str, Any] = {"lattice": {"orientation_deg": 30}, "border": {"rings": 1}}
    sheets = [
        layout(Design.from_dict({**data, "stars": {"length_mm": 10.0, "override": changes}})).graph
        for changes in ([], [{"star": 0, "side": "below"}])
    ]
    met = [sorted(len(graph.ends_at[node]) for node in graph.joints) for graph in sheets]
    assert met == [[2] * 3 + [3] * 3, [2] * 6] and len(sheets[1].paired) == 7


def test_the_exact_shape_bends_both_ways_and_exchanged_faces_mirror_it() -> None:
    """A narrow strip: its left half curls down, its right half up."""

    def strip(left: str, right: str) -> Design:
        lines = [{"line_mm": [(-28, 0), (-3, 0)], "side": left}, {"line_mm": [(3, 0), (28, 0)], "side": right}]
        sizes = {"thickness_mm": 0.6, "width_mm": 2.4}
        sheet: dict[str, Any] = {"border": {"rectangle_mm": [64.0, 4.0]}, "fabric": {"modulus_mpa": 7.2}}
        return Design.from_dict({"rods": {"draw": lines, **sizes}, **sheet})

    def sag(shape: Shape, ends: tuple[float, float]) -> float:
        """mm, of the middle of a line over its chord."""
        first, middle, last = shape.at(np.array([[ends[0], 0.0], [sum(ends) / 2, 0.0], [ends[1], 0.0]]), 3.0)
        (x, _, z), chord = last - first, middle - first
        return float((x * chord[2] - z * chord[0]) / np.hypot(x, z))

    shape, other = (exact_shape(strip(*sides), edge_mm=2.0) for sides in (("above", "below"), ("below", "above")))
    assert shape.summary.is_minimum and other.summary.is_minimum
    left, right = sag(shape, (-27.0, -4.0)), sag(shape, (4.0, 27.0))
    assert left > 0.2 and right == pytest.approx(-left, rel=1e-6)
    assert other.summary.energy_n_mm == pytest.approx(shape.summary.energy_n_mm, rel=1e-9)
    np.testing.assert_allclose(other.positions, MIRROR * shape.positions, atol=1e-5)
    for key in ("curvature_per_mm", "peel_n_per_mm", "shear_n_per_mm"):  # as seen from the face of each line
        np.testing.assert_allclose(other.rod_fields[key], shape.rod_fields[key], atol=1e-5)


@pytest.mark.slow
def test_the_preview_is_a_saddle_and_exchanged_faces_mirror_it() -> None:
    shape, other = preview(motif()), preview(motif(second=None, first="below"))
    is_mirror_image(shape, other)
    at = shape.at(np.array([[0.0, 0.0], [18.0, 0.0], [-18.0, 0.0], [0.0, 18.0], [0.0, -18.0]]), 3.0)[:, 2]
    assert at[0] > at[1:3].mean() + 1.0 and at[0] < at[3:].mean() - 1.0
    session = Preview(motif(second=None))
    np.testing.assert_allclose(session.update(motif()).positions, shape.positions, atol=1e-5)


def test_cells_are_those_of_the_first_line_above() -> None:
    plans = [plan_for_design(each) for each in (motif(), motif("below", "above"), motif("above", None, side="below"))]
    assert plans[0].design == plans[1].design == plans[2].design
    lines = plans[0].design.required_rods.motif
    assert [line.side for line in lines] == [None, "below"]
    for same in (motif("below", None), motif(None, "above", side="below")):
        plans[0].check(same)
    with pytest.raises(ForeignLaw, match=r"^rods\.motif\[1\]\.side = the same face as line 0: .* of the other face"):
        plans[0].check(motif("below", "below"))


@pytest.mark.parametrize("fraction", [0.4, 0.5])
def test_a_board_of_stars_whose_tips_meet_across_the_fabric_keeps_its_symmetries(fraction: float) -> None:
    data: dict[str, Any] = {"lattice": {"kind": "square", "arms": 4, "spacing_mm": 15.0}}
    data |= {"border": {"rectangle_mm": [76.0, 76.0]}, "stars": {"length_fraction": fraction}}
    sites = layout(Design.from_dict(data)).sites.tolist()
    data["stars"]["override"] = [{"site": site, "side": "below"} for site in sites if sum(site) % 2]
    board = Design.from_dict(data)
    assert len(symmetries(board, layout(board))) == 8


def test_prints_have_the_lines_below_in_a_file_of_their_own() -> None:
    volumes = []
    for design in (net(), net("above", "above")):
        prints = job(design).prints
        volumes.append({solid.name: solid.volume_mm3 for solids in prints.values() for solid in solids})
    assert list(volumes[0]) == ["rods", "border", "rods-below"]
    # lines that meet on one face share their crossings
    lines = 4 * 40.0 * 1.2 * 0.4
    assert volumes[0]["rods"] == pytest.approx(lines, rel=0.05) == volumes[0]["rods-below"]
    assert volumes[1]["rods"] == pytest.approx(2.0 * lines - 16 * 1.2**2 * 0.4, rel=0.05)


def test_a_layer_of_a_drawing_has_a_face(tmp_path: Path) -> None:
    paths = "".join(f'<g id="{name}"><path d="M{at} 10H50"/></g>' for name, at in (("up", 10), ("down", 20)))
    paths = paths.replace("M20 10", "M10 20")
    style = 'style="stroke:black;fill:none"'
    text = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="30mm" viewBox="0 0 60 30" {style}>{paths}</svg>'
    )
    (tmp_path / "two.svg").write_text(text, encoding="utf-8")
    entry = {"file": "two.svg", "layers": {"up": {}, "down": {"side": "below"}}}
    design = Design.from_dict({"rods": {"import": [entry]}, **SHEET}, tmp_path)
    assert {rod.name: rod.side for rod in layout(design).graph.rods} == {"up": 1, "down": -1}


def drawn(*lines: dict[str, Any]) -> dict[str, Any]:
    return {"rods": {"draw": list(lines)}, **SHEET}


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"stars": {"length_mm": 10.0, "side": "under"}}, r"^stars\.side = 'under': .*above.*below"),
        ({"stars": {"length_mm": 10.0, "override": [{"star": 0}]}}, r"^stars\.override\[0\]: must .* branch or side"),
        (drawn({"line_mm": [(0, 0), (9, 0)], "side": "under"}), r"^rods\.draw\[0\]\.side = 'under': .*above.*below"),
        (
            drawn({"name": "a", "line_mm": [(-9, 0), (9, 0)]}, {"line_mm": [(-9, 1), (9, 1)], "side": "below"}),
            r"^rods: a and draw\[1\] are 1\.00 mm apart at .* and would lie on each other through the fabric \(widths",
        ),
        (
            drawn({"name": "a", "line_mm": [(-9, 0), (9, 0)]}, {"line_mm": [(0, 0), (9, 2)], "side": "below"}),
            r"^rods: a and draw\[1\] meet at 13 deg at .*: 20 or more, also on two faces of the fabric",
        ),
    ],
)
def test_mistakes_are_one_line(data: dict[str, Any], words: str) -> None:
    with pytest.raises(DesignError, match=words) as caught:
        layout(Design.from_dict(data))
    assert "\n" not in str(caught.value)
