"""The exact model of drawn rods: sections and rest curvature along them, closed rods, and stars drawn as a motif."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import moved_state
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
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


def test_stars_drawn_as_a_motif_are_stars_up_to_the_junction() -> None:
    """The same fabric and rods; joints of the motif and pairs of the stars store the same energy in the flat print."""
    angle = np.radians([-90.0, 30.0, 150.0])
    motif = [{"line_mm": [[0.0, 0.0], [9.0 * np.cos(a), 9.0 * np.sin(a)]]} for a in angle]
    models, energies = [], []
    for pattern in ({"rods": {"motif": motif}}, {"stars": {"length_mm": 9.0}}):
        border = {"rectangle_mm": [24.0, 24.0], "star_margin_mm": 5.0}
        design = Design.from_dict({"border": border, **pattern, "lattice": {"spacing_mm": 40.0}})
        plan = layout(design)
        models.append(DiscreteModel(design, plan, mesh_layout(plan, 4.0, "delaunay")))
        energies.append(models[-1].energies(models[-1].printed_state()))
    drawn, stars = models
    of_drawn, of_stars = energies
    assert len(drawn.joints.vertices) == 1 and not len(stars.joints.vertices)
    assert of_drawn["membrane"] == pytest.approx(of_stars["membrane"], rel=1e-9)
    assert len(drawn.edges) == len(stars.edges)
    assert of_drawn["rod_bending"] + of_drawn["rod_joints"] == pytest.approx(of_stars["rod_bending"], rel=1e-9)


DESIGN = Design.from_dict(
    {
        "lattice": {"orientation_deg": 30},
        "stars": {"length_mm": 10.0, "thickness_mm": 0.4},
        "border": {"rings": 1},
        "mesh": {"edge_mm": 4.0},
    }
)
LAYOUT = layout(DESIGN)
MESH = mesh_layout(LAYOUT, 4.0)
BONDED = DiscreteModel(DESIGN, LAYOUT, MESH)


def test_print_holds_no_energy_in_its_joints() -> None:
    assert len(BONDED.joints.vertices) == 6
    assert BONDED.n_dofs == 3 * BONDED.n_vertices + len(BONDED.edges) + 18
    BONDED.set_release(0.0)
    try:
        assert BONDED.energies(BONDED.printed_state())["rod_joints"] == pytest.approx(0.0, abs=1e-12)
    finally:
        BONDED.set_release(1.0)


@pytest.mark.slow
def test_bonded_stars_have_another_shape_than_hinged_ones() -> None:
    """Bonds only add energy: at the same state, and at the minimum."""
    hinged = DiscreteModel(DESIGN, replace(LAYOUT, meeting_mm=0.0), MESH)
    assert not len(hinged.joints.vertices)
    bonded, loose = solve_on_mesh(BONDED), solve_on_mesh(hinged)
    assert bonded.is_minimum and loose.is_minimum
    assert bonded.energies["rod_joints"] > 0.0
    assert bonded.energy > 1.1 * loose.energy
    spread = [float(np.linalg.norm(np.ptp(each.state.positions, axis=0))) for each in (bonded, loose)]
    assert spread[0] != pytest.approx(spread[1], rel=0.01)
