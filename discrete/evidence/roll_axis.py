"""The axis about which an exact shape is rolled."""

from __future__ import annotations

from scipy.spatial import cKDTree

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.star_bumps import star_normals
from asterism.discrete.model.state import State
from asterism.pattern.geometry.normals import vertex_normals
from asterism.pattern.layout.roll_axis import roll_axis_from_normals


def roll_axis_deg(model: DiscreteModel, state: State) -> float | None:
    """Axis of a rolled sheet in printed coordinates, 0 to 180 deg from the x axis; None for other shapes."""
    if model.layout.has_stars:
        return roll_axis_from_normals(model.layout, star_normals(model, state))
    _, vertex = cKDTree(model.mesh.points).query(model.layout.sample_points)
    return roll_axis_from_normals(model.layout, vertex_normals(state.positions, model.mesh.triangles)[vertex])
