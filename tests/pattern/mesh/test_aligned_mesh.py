"""The lattice-aligned mesh."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.pattern import gallery
from asterism.pattern.design.errors import MeshError
from asterism.pattern.layout import build
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.aligned_mesh import MIN_ALIGNED_ANGLE_DEG, aligned_mesh
from asterism.pattern.mesh.mesh import Mesh
from asterism.pattern.mesh.meshing import mesh_layout
from tests.pattern.layouts import (
    L_SHAPE,
    RECTANGLE,
    ROUND,
    SIX,
    SLANTED,
    THREE,
    D,
    hexagon,
    lattice_points,
    layout,
    pin,
    rings,
    stars_on,
    unit,
)
from tests.pattern.mesh_rules import even_rods, obey, same_after, smallest_angle

BOX = np.array([[-50, -40], [50, -40], [50, 40], [-50, 40]], dtype=float)
FOUR = [0.0, 90.0, 180.0, 270.0]


def sound(sheet: Layout, edge: float, angle: float) -> Mesh:
    mesh = aligned_mesh(sheet, edge)
    obey(sheet, mesh)
    assert mesh.kind == "aligned" and even_rods(mesh) and smallest_angle(mesh) > angle
    return mesh


@pytest.mark.parametrize("n", [0, 1, 2, 3])
@pytest.mark.parametrize("edge", [3.2, 2.0, 1.1])
def test_hexagon_of_rings(n, edge):
    sound(rings(n, 10.0), edge, 43)


@pytest.mark.slow
@pytest.mark.parametrize("k", [5, 8, 12, 16])
@pytest.mark.parametrize("length", [3.0, 6.0, 9.0, 12.0])
def test_any_length_and_edge(k, length):
    sound(rings(1, length), D / k, 36)


@pytest.mark.slow
@pytest.mark.parametrize("border", [L_SHAPE, SLANTED, RECTANGLE, ROUND, 0.97 * hexagon(2)])
@pytest.mark.parametrize("length", [4.0, 13.0])
@pytest.mark.parametrize("edge", [1.8])
def test_any_border(border, length, edge):
    sound(stars_on(border, length, margin=0.5), edge, 20)


@pytest.mark.parametrize("directions", [[30.0], [30.0, 210.0], [30.0, 90.0, 210.0], [30.0, 150.0, 210.0, 270.0]])
def test_other_arms(directions):
    sound(rings(1, 8.0, directions), 2.0, MIN_ALIGNED_ANGLE_DEG)


@pytest.mark.parametrize("vectors", [D * np.eye(2), [[20.0, 0.0], [0.0, 15.0]], [[0.0, 16.0], [-16.0, 0.0]]])
def test_square_and_rectangular_lattices(vectors):
    sound(layout(BOX, lattice_points(1, np.asarray(vectors)), 6.0, FOUR, vectors=vectors), 1.8, 30)


@pytest.mark.parametrize(("length", "graded"), [(4.0, False), (10.0, False), (10.0, True), (13.0, False)])
def test_symmetric(length, graded):
    mesh = mesh_layout(rings(3, length), 2.0, graded=graded)
    turn = np.array([unit(120.0), unit(210.0)])
    assert same_after(mesh, mesh.points @ turn)
    assert same_after(mesh, mesh.points * [-1, 1])


def test_arms_that_reach_the_next_star():
    """Arms as long as the lattice distance end in the vertex of the next star."""
    sheet = layout(hexagon(3), lattice_points(1, D * unit([30.0, 90.0])), D)
    mesh = sound(sheet, 2.0, 49)
    assert len({int(rod[-1]) for rod in mesh.rods} & {*mesh.star_vertices.tolist()}) > 3


@pytest.mark.parametrize("length", [D / 2, 0.3 * D, 5.0, 6.0])
def test_six_arms(length):
    """Arms from both ends of every link; they meet at half the distance."""
    mesh = sound(rings(1, length, SIX), 1.6, 35)
    assert len({int(rod[-1]) for rod in mesh.rods}) == (42 - 12 if length == D / 2 else 42)


def test_unequal_arms_share_a_link():
    sheet = layout(hexagon(1), [[0, 0], D * unit(90.0)], np.array([12.0, D - 12.0]), [90.0, 270.0])
    mesh = sound(sheet, 2.0, MIN_ALIGNED_ANGLE_DEG)
    assert mesh.rods[0][-1] == mesh.rods[3][-1]


@pytest.mark.slow
@pytest.mark.parametrize(("length", "edge"), [(6.0, 2.0), (5.0, 1.6), (4.0, 1.3)])
@pytest.mark.parametrize("spacing", [16.0, D])  # grid points of the first one are exact, so that squares are too
def test_square_lattices_have_the_symmetry_of_the_square(length: float, edge: float, spacing: float) -> None:
    side = 2.5 * spacing
    border = side * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    vectors = spacing * np.eye(2)
    sheet = layout(border, lattice_points(1, vectors), length, FOUR, vectors=vectors)
    mesh = aligned_mesh(sheet, edge)
    obey(sheet, mesh)
    for turn in ([[-1, 0], [0, 1]], [[0, 1], [1, 0]], [[0, 1], [-1, 0]]):
        assert same_after(mesh, mesh.points @ np.array(turn))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["u-shape", "roof", "tunnel"])
def test_a_draft_will_do(name):
    sheet = build.layout(gallery.load(name))
    draft, whole = (aligned_mesh(sheet, 2.5, draft=draft) for draft in (True, False))
    obey(sheet, draft)
    assert MIN_ALIGNED_ANGLE_DEG <= smallest_angle(draft) <= smallest_angle(whole)
    assert len(draft.points) == len(whole.points)


def test_pins():
    corner = hexagon(2)[2]
    beside = 0.3 * hexagon(2)[0] + 0.7 * hexagon(2)[1]
    pins = (pin([[3.3, 6.1], corner, [-20.0, 15.2], beside, [0.0, 0.0]]), pin(edges=(0, 3)))
    sheet = rings(2, 8.0, pins=pins)
    mesh = aligned_mesh(sheet, 2.0)
    obey(sheet, mesh)
    assert smallest_angle(mesh) > 30
    assert len(mesh.pin_vertices[0]) == 5


def test_points_come_before_edges_in_a_pin_set():
    """Targets are given by point: those vertices come first, and twice if they are named twice."""
    corner = hexagon(1)[1]
    sheet = rings(1, pins=(pin([corner, [0, 0], corner], edges=(1,)),))
    mesh = aligned_mesh(sheet, 3.0)
    obey(sheet, mesh)
    first, second, third, *rest = mesh.pin_vertices[0].tolist()
    assert first == third and second == mesh.star_vertices[np.argmin(np.linalg.norm(sheet.centres, axis=1))]
    assert first not in rest and len(rest) == len(set(rest))


@pytest.mark.slow
@settings(max_examples=15)
@given(
    st.integers(0, 2),
    st.floats(0.5, D),
    st.floats(0.9, 6.0),
    st.sampled_from([THREE, SIX, (30.0, 150.0, 210.0, 330.0), (90.0,)]),
)
def test_sound_or_refused(n, length, edge, directions):
    sheet = rings(n, length, directions)
    try:
        mesh = aligned_mesh(sheet, edge)
    except MeshError:
        return
    obey(sheet, mesh)
    assert even_rods(mesh)
    assert smallest_angle(mesh) >= MIN_ALIGNED_ANGLE_DEG
