"""Models of designs on meshes of one edge length."""

from __future__ import annotations

from typing import Any

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout


def model_of(sheet: Design | dict[str, Any], edge_mm: float | None = None, kind: str | None = None) -> DiscreteModel:
    """On the mesh of the design where nothing else is asked for."""
    design = sheet if isinstance(sheet, Design) else Design.from_dict(sheet)
    plan, mesh = layout(design), design.mesh
    edge = mesh.edge_mm if edge_mm is None else edge_mm
    return DiscreteModel(design, plan, mesh_layout(plan, edge, kind or mesh.kind, graded=bool(mesh.graded)))


def tube(edge_mm: float = 4.0, rings: int = 1, **sections: Any) -> DiscreteModel:
    """The tube of the gallery with so many rings of stars."""
    data = gallery.load("tube").to_dict() | {"border": {"rings": rings}, "mesh": {"edge_mm": edge_mm}}
    return model_of(data | sections, edge_mm)


def paper_tube(edge_mm: float, **sections: Any) -> DiscreteModel:
    """Seven stars of the tube with the hinges of the paper."""
    paper = gallery.load("tube").to_dict()["fabric"] | {"bending": "paper"}
    return tube(edge_mm, **{"fabric": paper} | sections)


def seven_stars(**fabric: Any) -> DiscreteModel:
    """Short arms on this fabric."""
    star = {"stars": {"length_mm": 8.0}, "border": {"rings": 1}, "mesh": {"edge_mm": 4.0}}
    return model_of(star | {"fabric": fabric})
