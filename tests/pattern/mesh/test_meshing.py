"""Which mesh a layout gets, whose its vertices are, and the constrained Delaunay mesh."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh
from asterism.pattern.mesh.meshing import delaunay_mesh, mesh_layout
from tests.pattern.layouts import RECTANGLE, SIX, D, hexagon, layout, pin, rings, unit
from tests.pattern.mesh_rules import even_rods, obey, smallest_angle


def test_aligned_wherever_possible():
    assert mesh_layout(rings(1), 2.0).kind == "aligned"
    assert mesh_layout(rings(1), 2.0, kind="delaunay").kind == "delaunay"
    assert mesh_layout(rings(1, 10.0, [0.0, 120.0, 240.0]), 2.0).kind == "delaunay"
    eight = layout(RECTANGLE, [[0, 0]], 5.0, (45.0 * np.arange(8)).tolist(), vectors=D * np.eye(2))
    assert mesh_layout(eight, 2.5).kind == "delaunay"
    # a tip so close to the border that only small triangles fit
    sheet = rings(1, 14.98)
    mesh = mesh_layout(sheet, 2.0)
    obey(sheet, mesh)
    assert mesh.kind == "delaunay"


def test_kind_is_obeyed():
    line = r"^mesh.kind = 'aligned': an arm of star 0 does not lie on a line .*; delaunay and auto"
    with pytest.raises(MeshError, match=line):
        mesh_layout(rings(1, 10.0, [0.0, 120.0, 240.0]), 2.0, kind="aligned")
    with pytest.raises(MeshError, match="must be auto, aligned or delaunay"):
        mesh_layout(rings(1), 2.0, kind="square")


BOTH = ("aligned", "delaunay")


@pytest.mark.parametrize(
    ("sheet", "edge", "kinds"),
    [
        (rings(1, 0.0), 2.0, BOTH),
        (rings(1, 17.0), 2.0, BOTH),  # over the border
        (rings(1, 12.0, SIX), 2.0, BOTH),  # overlapping arms
        (rings(1), 0.0, BOTH),
        (rings(1), -1.0, BOTH),
        (rings(1), np.nan, BOTH),
        (rings(1), np.inf, BOTH),
        (rings(1), 1e-4, BOTH),
        (rings(1, pins=(pin([[100.0, 0.0]]),)), 2.0, BOTH),
        (rings(1, 10.0, [0.0, 120.0, 240.0]), 2.0, BOTH[:1]),  # arms between the lattice's directions
        (layout(hexagon(1), [[1.0, 0.0]]), 2.0, BOTH[:1]),  # a star beside the lattice
        (rings(1, 0.1), 2.0, BOTH[:1]),  # far shorter than an edge
        (rings(1, 8.5, SIX), D / 2, BOTH[:1]),  # no edge left for the gap
        (layout(RECTANGLE, [[0.0, 0.0]], pins=(pin([[1.0, 40.0]]),)), 2.0, BOTH[:1]),
        (rings(1, 10.0, pins=(pin([[0.0, -5.1]]),)), 2.0, BOTH[:1]),  # on an arm, between its vertices
        (layout(hexagon(1), [[0, 0], [5, 0]], 10.0, [0.0, 120.0, 240.0]), 2.0, BOTH[1:]),  # through another star
        (layout(hexagon(1), [[0, 0], [5, 5]], 10.0, [0.0, -90.0]), 2.0, BOTH[1:]),  # crossing arms
        (layout(hexagon(1), [[300, 0]]), 2.0, BOTH[1:]),
        (layout([[0, 0], [10, 10], [10, 0], [0, 10]], [[5, 8]], 1.0), 2.0, BOTH[1:]),  # a border that crosses itself
        (layout([[0, 0], [10, 0], [20, 0]], [[5, 0]], 1.0), 2.0, BOTH[1:]),  # and one without an inside
    ],
)
def test_refused(sheet, edge, kinds):
    for kind in kinds:
        with pytest.raises(MeshError) as caught:
            mesh_layout(sheet, edge, kind)
        assert "\n" not in str(caught.value)


def sound(sheet: Layout, edge: float, angle: float) -> Mesh:
    mesh = delaunay_mesh(sheet, edge)
    obey(sheet, mesh)
    assert mesh.kind == "delaunay" and even_rods(mesh) and smallest_angle(mesh) > angle
    return mesh


@pytest.mark.slow
@pytest.mark.parametrize("n", [0, 2])
@pytest.mark.parametrize("length", [2.0, 5.5, 13.0])
@pytest.mark.parametrize("edge", [3.0, 1.5])
def test_hexagon_of_rings(n, length, edge):
    assert min(len(rod) for rod in sound(rings(n, length), edge, 25).rods) >= 3


@pytest.mark.parametrize("edge", [3.0, 2.0, 1.0])
def test_edges_are_as_long_as_wished(edge):
    """As many triangles as equilateral ones of that edge would fill the sheet, within a quarter."""
    sheet = rings(2, 10.0)
    mesh = delaunay_mesh(sheet, edge)
    assert len(mesh.triangles) == pytest.approx(polygon_area(sheet.outline) / (np.sqrt(3) / 4 * edge**2), rel=0.25)


@pytest.mark.parametrize("directions", [(0.0, 120.0, 240.0), (45.0 * np.arange(8)).tolist(), (10.0, 80.0)])
def test_any_arms(directions):
    sound(rings(1, 7.0, directions), 2.0, 24)


def test_tips_that_meet_share_a_vertex():
    for miss in (0.0, 2e-7):
        sheet = rings(1, D / 2 - miss, SIX)
        mesh = delaunay_mesh(sheet, 2.0)
        obey(sheet, mesh)
        assert len({int(rod[-1]) for rod in mesh.rods}) == 30


@pytest.mark.slow
@pytest.mark.parametrize("gap", [0.05, 0.2, 0.6])
def test_small_gaps_are_refined(gap):
    """Between a tip and the next star, and between two tips."""
    for sheet in (rings(1, D - gap, [30.0]), rings(1, (D - gap) / 2, SIX)):
        sheet = layout(hexagon(3), sheet.centres, sheet.arm_length[0], [30.0] if len(sheet.arm_star) == 7 else SIX)
        # a gap of a fortieth of an edge cannot have both even arms and round triangles
        sound(sheet, 2.0, 20 if gap >= 0.2 else 5)


def test_seeds():
    sheet = rings(2, 10.0)
    one, again, two = (delaunay_mesh(sheet, 2.0, seed) for seed in (0, 0, 1))
    assert np.array_equal(one.points, again.points)
    assert np.array_equal(one.triangles, again.triangles)
    obey(sheet, two)
    shorter = min(len(one.points), len(two.points))
    assert not np.allclose(one.points[:shorter], two.points[:shorter])


def test_pins():
    on_arm = -3.3 * unit(90.0)
    corner = hexagon(1)[1]
    beside = 0.3 * hexagon(1)[0] + 0.7 * hexagon(1)[1]
    pins = (
        pin([[3.3, 6.1], corner, on_arm, beside, [0, 0], corner]),
        pin(edges=(0, 3)),
        pin([[4.0, -1.0]], edges=(1,)),
    )
    sheet = rings(1, 10.0, pins=pins)
    mesh = delaunay_mesh(sheet, 2.0)
    obey(sheet, mesh)
    assert mesh.pin_vertices[0][2] in np.concatenate(mesh.rods)
    assert smallest_angle(mesh) > 20
