"""Rods off the axes of an unequally stretched fabric: their rest curvature is one tensor, twist included."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
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


def test_equal_stretch_and_rods_along_the_axes_have_no_rest_twist() -> None:
    along = np.array([[np.cos(a), np.sin(a)] for a in np.linspace(0.0, 3.0, 7)])
    assert np.abs(rest_twist(0.3, Fabric(stretch=1.35), Plastic(), along)).max() == 0.0
    assert np.abs(rest_twist(0.3, Fabric(stretch=STRETCH), Plastic(), np.eye(2))).max() < 1e-18
    assert np.abs(rest_twist(0.3, Fabric(stretch=STRETCH), Plastic(rest_curvature="none"), along)).max() == 0.0


def test_the_twist_is_the_off_diagonal_part_of_the_tensor() -> None:
    """With equal Poisson's ratios, curvatures in two directions at right angles and the twist turn as a tensor does."""
    fabric, plastic, a = Fabric(stretch=STRETCH), Plastic(), 0.4
    t, n = np.array([np.cos(a), np.sin(a)]), np.array([-np.sin(a), np.cos(a)])
    kx, ky = rest_curvature(0.3, fabric, plastic, np.eye(2))
    np.testing.assert_allclose(rest_curvature(0.3, fabric, plastic, t), t @ np.diag([kx, ky]) @ t)
    np.testing.assert_allclose(rest_twist(0.3, fabric, plastic, t), t @ np.diag([kx, ky]) @ n)
    np.testing.assert_allclose(rest_twist(0.3, fabric, plastic, n), -rest_twist(0.3, fabric, plastic, t))


def test_a_single_rod_off_the_axes_becomes_a_helix_of_its_twist() -> None:
    """Released partly, the rest twist follows the release; mirror images twist to the other side."""
    up, down = (model([{"line_mm": [(-9, -sign * 5), (9, sign * 5)]}]) for sign in (1.0, -1.0))
    first, second = (of.parts["rod_twist"].params[:, 3] for of in (up, down))
    assert first.mean() == pytest.approx(-second.mean(), rel=1e-6) and abs(first.mean()) > 0.0
    up.set_release(0.0)
    assert np.abs(first).max() < 1e-12
