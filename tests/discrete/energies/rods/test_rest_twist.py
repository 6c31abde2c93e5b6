"""Rods off the axes of an unequally stretched fabric: their rest curvature is one tensor, twist included.

Drawn rods: sections and rest curvature along them, closed rods, and stars that meet. V11: Saint-Venant torsion.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asterism.discrete.energies.rods.network import torsion_constant
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State, moved_state
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.pattern.design.materials import Fabric, Plastic, rest_curvature, rest_twist
from tests.discrete.models import model_of

RODS = ("rod_bending", "rod_twist", "rod_joints")
STRETCH = (1.5, 1.1)
# a stiff plastic curves slightly, so that the surface of the test is nearly flat
STIFF = {"modulus_ratio": 2e6}
LINES: list[dict[str, Any]] = [
    {"line_mm": [(-9, -9), (9, 9)]},
    {"line_mm": [(9, -4), (-9, 4)]},
    {"line_mm": [(-9, 6), (-2, -9), (8, -6)]},
    {"arc_mm": {"radius": 6.0, "centre": (3.0, 3.0), "from_deg": -50, "to_deg": 160}},
]


def model(lines: list[dict[str, Any]] = LINES, edge_mm: float = 0.5, **plastic: Any) -> DiscreteModel:
    return model_of(
        {
            "rods": {"draw": lines},
            "border": {"rectangle_mm": (20.0, 20.0)},
            "fabric": {"stretch": STRETCH},
            "plastic": STIFF | plastic,
            "mesh": {"edge_mm": edge_mm},
        },
        edge_mm,
    )


def on_surface(of: DiscreteModel, curvature: np.ndarray) -> State:
    """The rods on the surface `z = -p . K p/2`, with its normals as directors."""
    p = of.mesh.points
    places = np.column_stack([p, -0.5 * np.einsum("ni,ij,nj->n", p, curvature, p)])
    middle = p[of.network.edges].mean(axis=1)
    normals = np.column_stack([middle @ curvature, np.ones(len(middle))])
    along = places[of.network.edges[:, 1]] - places[of.network.edges[:, 0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    normals -= (normals * along).sum(axis=1)[:, None] * along
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return of.with_fitted_frames(State(places, normals, of.printed_state().frames))


def energy(of: DiscreteModel, state: State) -> float:
    parts = of.energies(state)
    return sum(parts[name] for name in RODS)


@pytest.mark.parametrize("formula", ["paper", "timoshenko"])
def test_rods_in_all_directions_and_their_joints_rest_on_one_surface(formula: str) -> None:
    """Its curvature is the tensor of the mismatch: no rod, corner or crossing on it stores any energy."""
    of = model(rest_curvature=formula)
    axes = rest_curvature(0.3, of.design.fabric, of.design.plastic, np.eye(2))
    resting = energy(of, on_surface(of, np.diag(axes)))
    flat = energy(of, of.printed_state())
    assert flat > 0.0 and resting < 2e-3 * flat
    twists = of.parts["rod_twist"].params
    before = twists[:, 3].copy()
    for sign in (0.0, -1.0):  # without the twist, or with the wrong sign, the surface is not at rest
        twists[:, 3] = sign * before
        assert energy(of, on_surface(of, np.diag(axes))) > 0.02 * flat


def test_the_twist_is_the_off_diagonal_part_of_the_tensor() -> None:
    """With equal Poisson's ratios, curvatures in two directions at right angles and the twist turn as a tensor does."""
    fabric, plastic, a = Fabric(stretch=STRETCH), Plastic(), 0.4
    t, n = np.array([np.cos(a), np.sin(a)]), np.array([-np.sin(a), np.cos(a)])
    kx, ky = rest_curvature(0.3, fabric, plastic, np.eye(2))
    np.testing.assert_allclose(rest_curvature(0.3, fabric, plastic, t), t @ np.diag([kx, ky]) @ t)
    np.testing.assert_allclose(rest_twist(0.3, fabric, plastic, t), t @ np.diag([kx, ky]) @ n)
    np.testing.assert_allclose(rest_twist(0.3, fabric, plastic, n), -rest_twist(0.3, fabric, plastic, t))
    # none along the axes, for equal stretch, and without rest curvature
    assert np.abs(rest_twist(0.3, fabric, plastic, np.eye(2))).max() < 1e-18
    assert rest_twist(0.3, Fabric(stretch=1.35), plastic, t) == 0.0
    assert rest_twist(0.3, fabric, Plastic(rest_curvature="none"), t) == 0.0


def test_a_single_rod_off_the_axes_becomes_a_helix_of_its_twist() -> None:
    """Released partly, the rest twist follows the release; mirror images twist to the other side."""
    up, down = (model([{"line_mm": [(-9, -sign * 5), (9, sign * 5)]}]) for sign in (1.0, -1.0))
    first, second = (of.parts["rod_twist"].params[:, 3] for of in (up, down))
    assert first.mean() == pytest.approx(-second.mean(), rel=1e-6) and abs(first.mean()) > 0.0
    up.set_release(0.0)
    assert np.abs(first).max() < 1e-12


@pytest.mark.parametrize(("ratio", "beta"), [(1.0, 0.140577), (2.0, 0.228682), (4.0, 0.280813), (10.0, 0.312325)])
def test_textbook_table(ratio, beta):
    """J = beta a b^3 (Timoshenko and Goodier, section 109)."""
    b = 0.37
    assert torsion_constant(np.array(ratio * b), np.array(b)) / (ratio * b**4) == pytest.approx(beta, abs=1e-6)


def test_thin_strip():
    """a b^3/3 (1 - 0.630249 b/a), the limit of the series."""
    a, b = np.array(1000.0), np.array(1.0)
    assert torsion_constant(a, b) == pytest.approx(a / 3.0 * (1.0 - 0.6302498 / a), rel=1e-9)


@given(st.floats(0.05, 20.0), st.floats(0.05, 20.0), st.floats(0.1, 10.0))
def test_symmetric_homogeneous_and_below_the_polar_moment(a, b, scale):
    j = torsion_constant(np.array(a), np.array(b))
    assert torsion_constant(np.array(b), np.array(a)) == pytest.approx(j, rel=1e-14)
    assert torsion_constant(np.array(scale * a), np.array(scale * b)) == pytest.approx(scale**4 * j, rel=1e-12)
    assert 0.0 < j < a * b * (a * a + b * b) / 12.0


def drawn(edge_mm: float = 4.0, **data: Any) -> DiscreteModel:
    return model_of({"border": {"rectangle_mm": [60.0, 40.0]}, "mesh": {"edge_mm": edge_mm}, **data}, edge_mm)


def test_a_line_has_its_own_residual_curvature_and_sections() -> None:
    lines: list[dict[str, Any]] = [{"line_mm": [[-20, y], [20, y]]} for y in (-10.0, 10.0)]
    lines[1] |= {"kappa_bar_per_mm": 0.02, "width_mm": 2.0}
    both = drawn(rods={"draw": lines}, plastic={"kappa_bar_per_mm": 0.005})
    rod = both.network.rod[both.network.stencil_edges[:, 0]]
    span = np.linalg.norm(np.diff(both.mesh.points[both.network.stencil_vertices], axis=1), axis=2).sum(axis=1)
    curvature = 2.0 * both.parts["rod_bending"].params[:, 2] / span
    assert curvature[rod == 1].mean() - curvature[rod == 0].mean() == pytest.approx(0.015)
    assert set(both.edge_width[both.network.rod == 1]) == {2.0}


def test_a_ring_has_a_stencil_at_every_vertex_and_no_joint() -> None:
    ring = drawn(rods={"draw": [{"circle_mm": {"radius": 15.0}}]})
    assert not len(ring.joints.vertices)
    assert len(ring.network.stencil_vertices) == len(ring.network.edges) == len(ring.mesh.rods[0]) - 1
    ring.set_release(0.0)
    state = ring.printed_state()
    assert ring.energies(state)["rod_bending"] == pytest.approx(0.0, abs=1e-12)
    # with all sections turned alike the ring twists hardly at all: its seam is a stencil like any other
    turned = moved_state(state, ring.edges, state.positions, np.full(len(ring.edges), 0.1))
    assert ring.energies(turned)["rod_twist"] < 0.05 * ring.energies(turned)["rod_bending"]


@pytest.mark.slow
def test_bonded_stars_have_another_shape_than_hinged_ones() -> None:
    """Bonds only add energy: at the same state, and at the minimum."""
    stars = {"stars": {"length_mm": 10.0, "thickness_mm": 0.4}, "lattice": {"orientation_deg": 30}}
    meeting = model_of(stars | {"border": {"rings": 1}, "mesh": {"edge_mm": 4.0}})
    hinged = DiscreteModel(meeting.design, replace(meeting.layout, meeting_mm=0.0), meeting.mesh)
    assert len(meeting.joints.vertices) == 6 and not len(hinged.joints.vertices)
    bonded, loose = solve_on_mesh(meeting), solve_on_mesh(hinged)
    assert bonded.is_minimum and loose.is_minimum
    assert bonded.energies["rod_joints"] > 0.0
    assert bonded.energy > 1.1 * loose.energy
    spread = [float(np.linalg.norm(np.ptp(each.state.positions, axis=0))) for each in (bonded, loose)]
    assert spread[0] != pytest.approx(spread[1], rel=0.01)
