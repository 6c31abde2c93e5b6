"""Width of creases in states of known tension and stiffness."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.discrete.evidence.creases import measure_creases
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout


def model(edge: float, **fabric: object) -> DiscreteModel:
    data = gallery.load("star").to_dict() | {"mesh": {"edge_mm": edge}}
    data["fabric"] = data["fabric"] | fabric
    design = Design.from_dict(data)
    plan = layout(design)
    return DiscreteModel(design, plan, mesh_layout(plan, edge))


@pytest.mark.parametrize("law", ["neo-hookean", "incompressible"])
def test_width_of_the_stretched_print(law):
    """Flat and stretched by s: the tension is the derivative of the energy by the deformed area."""
    m = model(2.0, model=law, bending="consistent")
    fabric = m.design.fabric
    rest, flat = m.mesh.points / fabric.stretch, m.flat_state()

    def energy(stretch: float) -> float:
        return float(m.parts["membrane"].energies(np.pad(stretch * rest, ((0, 0), (0, 1))).ravel()).sum())

    s, d = fabric.stretch, 1e-5
    corner = rest[m.mesh.triangles]
    e1, e2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = 0.5 * (e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0]).sum()
    tension = (energy(s + d) - energy(s - d)) / (2.0 * d) / (2.0 * s * area)
    bending = fabric.modulus_mpa * fabric.thickness_mm**3 / 12.0 / (1.0 - fabric.poisson**2)
    found = measure_creases(m, flat)
    assert found.width == pytest.approx(np.sqrt(bending / tension), rel=1e-7)
    assert found.edge == pytest.approx(2.0 * np.sqrt(3.0) / 2.0, rel=0.15)
    assert not found.resolved


def test_hinges_are_wider_and_no_bending_has_no_width():
    flat = {
        bending: measure_creases(model(2.0, bending=bending), model(2.0).flat_state()) for bending in ("paper", "none")
    }
    plate = measure_creases(model(2.0, bending="consistent"), model(2.0).flat_state())
    assert flat["paper"].width == pytest.approx(np.sqrt(3.0) * plate.width)
    assert flat["none"].width == 0.0 and not flat["none"].resolved


def test_fine_meshes_resolve_creases():
    fine = model(0.25, bending="consistent")
    assert measure_creases(fine, fine.flat_state()).edge < 0.3


def test_edge_is_the_height_over_the_arms():
    """In a sheet stretched along one direction, where triangles have sides of different lengths."""
    m = model(2.0)
    flat = m.flat_state()
    long = State(flat.positions * [1.6, 1.0, 1.0], flat.directors)
    heights, arms = [], {tuple(sorted(edge)) for edge in m.edges.tolist()}
    for triangle in m.mesh.triangles.tolist():
        for k in range(3):
            a, b, top = (triangle[(k + i) % 3] for i in range(3))
            if tuple(sorted((a, b))) in arms:
                along = long.positions[b] - long.positions[a]
                over = np.cross(along, long.positions[top] - long.positions[a])
                heights.append(np.linalg.norm(over) / np.linalg.norm(along))
    assert measure_creases(m, long).edge == pytest.approx(np.median(heights))


def test_creases_of_slack_fabric_have_infinite_width():
    m = model(2.0)
    flat = m.flat_state()
    slack = measure_creases(m, State(0.4 * flat.positions, flat.directors))
    assert slack.width == np.inf and slack.resolved
