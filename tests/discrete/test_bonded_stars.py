"""Stars whose tips meet: they are bonded as printed, and not hinged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout

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
