"""Which mesh a layout gets, and whose its vertices are."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.design.errors import MeshError
from asterism.pattern.mesh.meshing import mesh_layout
from tests.pattern.layouts import RECTANGLE, SIX, D, hexagon, layout, pin, rings
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


BOTH = ("aligned", "delaunay")


@pytest.mark.parametrize(
    ("sheet", "edge", "kinds"),
    [
        (rings(1, 0.0), 2.0, BOTH),
        (rings(1, 17.0), 2.0, BOTH),  # over the border
        (rings(1, 12.0, SIX), 2.0, BOTH),  # overlapping arms
        (rings(1), 0.0, BOTH),
        (rings(1), -1.0, BOTH),
        (rings(1), np.nan, BOTH),
        (rings(1), np.inf, BOTH),
        (rings(1), 1e-4, BOTH),
        (rings(1, pins=(pin([[100.0, 0.0]]),)), 2.0, BOTH),
        (rings(1, 10.0, [0.0, 120.0, 240.0]), 2.0, BOTH[:1]),  # arms between the lattice's directions
        (layout(hexagon(1), [[1.0, 0.0]]), 2.0, BOTH[:1]),  # a star beside the lattice
        (rings(1, 0.1), 2.0, BOTH[:1]),  # far shorter than an edge
        (rings(1, 8.5, SIX), D / 2, BOTH[:1]),  # no edge left for the gap
        (layout(RECTANGLE, [[0.0, 0.0]], pins=(pin([[1.0, 40.0]]),)), 2.0, BOTH[:1]),
        (rings(1, 10.0, pins=(pin([[0.0, -5.1]]),)), 2.0, BOTH[:1]),  # on an arm, between its vertices
        (layout(hexagon(1), [[0, 0], [5, 0]], 10.0, [0.0, 120.0, 240.0]), 2.0, BOTH[1:]),  # through another star
        (layout(hexagon(1), [[0, 0], [5, 5]], 10.0, [0.0, -90.0]), 2.0, BOTH[1:]),  # crossing arms
        (layout(hexagon(1), [[300, 0]]), 2.0, BOTH[1:]),
        (layout([[0, 0], [10, 10], [10, 0], [0, 10]], [[5, 8]], 1.0), 2.0, BOTH[1:]),  # a border that crosses itself
        (layout([[0, 0], [10, 0], [20, 0]], [[5, 0]], 1.0), 2.0, BOTH[1:]),  # and one without an inside
    ],
)
def test_refused(sheet, edge, kinds):
    for kind in kinds:
        with pytest.raises(MeshError) as caught:
            mesh_layout(sheet, edge, kind)
        assert "\n" not in str(caught.value)
