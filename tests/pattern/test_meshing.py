"""Which mesh a layout gets, and whose its vertices are."""

from __future__ import annotations

import numpy as np
import pytest

from pattern.errors import MeshError
from pattern.meshing import can_align, mesh_layout, star_of_vertex
from tests.pattern.layouts import D, layout, rings
from tests.pattern.mesh_rules import obey


def test_aligned_wherever_possible():
    assert mesh_layout(rings(1), 2.0).kind == "aligned"
    assert mesh_layout(rings(1), 2.0, kind="delaunay").kind == "delaunay"
    assert mesh_layout(rings(1, 10.0, [0.0, 120.0, 240.0]), 2.0).kind == "delaunay"
    # a tip so close to the border that only small triangles fit
    sheet = rings(1, 14.98)
    mesh = mesh_layout(sheet, 2.0)
    obey(sheet, mesh)
    assert mesh.kind == "delaunay"


def test_kind_is_obeyed():
    line = r"^mesh.kind = 'aligned': an arm of star 0 does not lie on a line .*; delaunay and auto"
    with pytest.raises(MeshError, match=line):
        mesh_layout(rings(1, 10.0, [0.0, 120.0, 240.0]), 2.0, kind="aligned")
    with pytest.raises(MeshError, match="must be auto, aligned or delaunay"):
        mesh_layout(rings(1), 2.0, kind="square")


def test_can_align():
    assert can_align(rings(2))
    assert not can_align(rings(1, 10.0, [0.0, 120.0, 240.0]))
    border = [[-40, -40], [40, -40], [40, 40], [-40, 40]]
    assert can_align(layout(border, [[0, 0]], 5.0, [0, 90, 180, 270], vectors=D * np.eye(2)))
    assert not can_align(layout(border, [[0, 0]], 5.0, (45 * np.arange(8)).tolist(), vectors=D * np.eye(2)))


def test_stars_own_what_is_nearest():
    sheet = rings(1)
    mesh = mesh_layout(sheet, 2.0)
    star = star_of_vertex(sheet, mesh)
    assert star.shape == (len(mesh.points),)
    assert np.array_equal(star[mesh.star_vertices], np.arange(7))
    away = np.linalg.norm(mesh.points[:, None] - sheet.centres, axis=2)
    assert np.allclose(away[np.arange(len(star)), star], away.min(axis=1))
