"""V20: one star on its cell keeps the symmetry of its mesh and rises to the plastic side. V22: the evidence."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.release.continuation import solve_on_mesh
from tests.asterism.previews.designs import edited
from tests.discrete.models import model_of


def model(**sections: dict) -> DiscreteModel:
    return model_of(edited("star", mesh={"edge_mm": 2.0}, fabric={"bending": "paper"}, **sections))


def test_symmetry_direction_and_bump_height() -> None:
    m = model()
    found = solve_on_mesh(m)
    x, p = found.state.positions, m.mesh.points
    angle = 2 * np.pi / 3
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    distances = np.linalg.norm(x[:, None] - x[None], axis=2)
    for image in (p @ turn.T, p * [-1.0, 1.0]):
        apart, other = cKDTree(p).query(image)
        assert apart.max() < 1e-9
        np.testing.assert_allclose(distances[np.ix_(other, other)], distances, atol=1e-5)
    assert found.is_minimum and found.stars_up == 1
    # about 3.4 mm for l=10, h=.4, w=1.2 and the rod stiffness of an elastic beam
    assert found.bumps[0] == pytest.approx(3.4, abs=0.1)


def test_bump_height_with_half_the_stiffness() -> None:
    """About 4.5 mm with the reference data's rod energy, half of the beam's at the same rest curvature."""
    m = model()
    m.parts["rod_bending"].params[:, :2] *= 0.5
    m.parts["rod_twist"].params[:, 0] *= 0.5
    assert solve_on_mesh(m).bumps[0] == pytest.approx(4.5, abs=0.2)


def test_a_star_pushed_down_is_counted_as_down() -> None:
    """Every star is bistable: from a deep bump the other way it stays inside out, at a higher energy."""
    m = model(stars={"thickness_mm": 0.3})
    up = solve_on_mesh(m)
    start = State(up.state.positions * [1.0, 1.0, -1.0], up.state.directors * [-1.0, -1.0, 1.0])
    down = solve_on_mesh(m, start)
    assert down.is_minimum and down.stars_up == 0 and up.stars_up == 1
    assert down.energy > up.energy + 0.1


def test_a_saddle_is_left_not_reported() -> None:
    """Without noise and bump a flat symmetric print without rest curvature is stationary, and a saddle."""
    m = model(plastic={"rest_curvature": "none"})
    flat = m.flat_state()
    m.set_release(1.0)
    found = solve_on_mesh(m, flat)
    assert found.saddles_left >= 1
    assert found.is_minimum and found.smallest_eigenvalue > 0.0
    assert np.ptp(found.state.positions[:, 2]) > 1.0
