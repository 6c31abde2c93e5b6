"""The exact model of drawn rods: sections and rest curvature along them, closed rods, and stars that meet."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import moved_state
from asterism.discrete.release.continuation import solve_on_mesh
from tests.discrete.models import model_of


def model(edge_mm: float = 4.0, **data: Any) -> DiscreteModel:
    return model_of({"border": {"rectangle_mm": [60.0, 40.0]}, "mesh": {"edge_mm": edge_mm}, **data}, edge_mm)


def test_a_line_has_its_own_residual_curvature_and_sections() -> None:
    lines: list[dict[str, Any]] = [{"line_mm": [[-20, y], [20, y]]} for y in (-10.0, 10.0)]
    lines[1] |= {"kappa_bar_per_mm": 0.02, "width_mm": 2.0}
    both = model(rods={"draw": lines}, plastic={"kappa_bar_per_mm": 0.005})
    rod = both.network.rod[both.network.stencil_edges[:, 0]]
    span = np.linalg.norm(np.diff(both.mesh.points[both.network.stencil_vertices], axis=1), axis=2).sum(axis=1)
    curvature = 2.0 * both.parts["rod_bending"].params[:, 2] / span
    assert curvature[rod == 1].mean() - curvature[rod == 0].mean() == pytest.approx(0.015)
    assert set(both.edge_width[both.network.rod == 1]) == {2.0}


def test_a_ring_has_a_stencil_at_every_vertex_and_no_joint() -> None:
    ring = model(rods={"draw": [{"circle_mm": {"radius": 15.0}}]})
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
