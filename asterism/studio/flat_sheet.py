"""Sheets without a preview as messages: they are shown flat."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.shape.blank_sheet import blank_sheet
from asterism.studio.messages import Frame, ShownMesh
from asterism.studio.ribbon_stations import STATIONS, ribbon_stations
from asterism.studio.sheet_marks import SheetMarks
from asterism.studio.shown_mesh import mesh_message

# edges of the triangles of a printed sheet over its diameter
FLAT_EDGE_SHARE = 0.05


def blank_messages(design: Design, number: int, seq: int) -> tuple[ShownMesh, Frame]:
    """The flat, released sheet of a design without stars: its mesh under a number, and its frame."""
    shape = blank_sheet(design)
    mesh = mesh_message(number, shape.printed, shape.triangles, np.empty(0, dtype=np.int64), is_fine=True)
    return mesh, _flat_frame(number, seq, shape.positions, None)


def printed_messages(design: Design, layout: Layout, number: int, seq: int) -> tuple[ShownMesh, Frame]:
    """The flat sheet as it is printed, with its rods."""
    edge = FLAT_EDGE_SHARE * layout.diameter_mm
    mesh = mesh_layout(layout, edge, design.mesh.kind, design.mesh.seed, draft=True)
    positions = np.pad(mesh.points, ((0, 0), (0, 1)))
    marks = SheetMarks(mesh.points, mesh.triangles)
    shown = mesh_message(number, mesh.points, mesh.triangles, ribbon_stations(layout).site, is_fine=True)
    normals = np.tile(np.array([0.0, 0.0, 1.0]), (len(positions), 1))
    return shown, _flat_frame(number, seq, positions, marks.ribbons(layout, positions, normals))


def _flat_frame(number: int, seq: int, positions: Floats, ribbons: tuple[Floats, Floats] | None) -> Frame:
    """A flat sheet at positions (V, 3), with the ribbons of its rods."""
    count, small = len(positions), np.float32
    arms, arm_normals = ribbons or (np.empty((0, STATIONS, 2, 3)), np.empty((0, STATIONS, 3)))
    return Frame(
        seq=seq,
        mesh=number,
        stage="equilibrium",
        positions=positions.astype(small),
        curvature=np.zeros(count, dtype=small),
        strain=np.zeros(count, dtype=small),
        arms=arms.astype(small),
        arm_normals=arm_normals.astype(small),
        needles=np.empty((0, 2, 3), dtype=small),
        is_minimum=True,
    )
