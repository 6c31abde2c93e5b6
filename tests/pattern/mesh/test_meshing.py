"""Which mesh a layout gets, and whose its vertices are."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.design.errors import MeshError
from asterism.pattern.mesh.meshing import mesh_layout
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


@pytest.mark.parametrize(("arms", "kind"), [(4, "aligned"), (8, "delaunay")])
def test_a_square_lattice_is_aligned_with_the_arms_along_its_lines(arms, kind):
    border = [[-40, -40], [40, -40], [40, 40], [-40, 40]]
    angles = (360 / arms * np.arange(arms)).tolist()
    assert mesh_layout(layout(border, [[0, 0]], 5.0, angles, vectors=D * np.eye(2)), 2.5).kind == kind
