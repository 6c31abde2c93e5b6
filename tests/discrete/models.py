"""Models of designs on meshes of one edge length."""

from __future__ import annotations

from typing import Any

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout


def model_of(sheet: Design | dict[str, Any], edge_mm: float | None = None, kind: str | None = None) -> DiscreteModel:
    """On the mesh of the design where nothing else is asked for."""
    design = sheet if isinstance(sheet, Design) else Design.from_dict(sheet)
    plan, mesh = layout(design), design.mesh
    edge = mesh.edge_mm if edge_mm is None else edge_mm
    return DiscreteModel(design, plan, mesh_layout(plan, edge, kind or mesh.kind, graded=bool(mesh.graded)))
