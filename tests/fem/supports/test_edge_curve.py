"""The curve that mesh edges approximate: circles, straight lines, corners."""

import numpy as np
import pytest
from skfem import MeshTri

from asterism.fem.supports.edge_curve import edge_curve
from tests.fem.meshes import annulus, rectangle, turned


def test_both_circles_of_an_annulus() -> None:
    """Tangents and curvatures are exact, on the hole's rim too."""
    mesh = annulus(16, [1.0, 1.5, 2.0])
    curve = edge_curve(mesh, mesh.boundary_facets(), 30.0)
    radius = np.linalg.norm(curve.ends, axis=2)
    assert np.allclose(np.abs(curve.curvatures), 1.0 / radius)
    assert np.allclose(np.sum(curve.tangents * curve.ends, axis=2), 0.0, atol=1e-12)
    left = np.stack([-curve.tangents[..., 1], curve.tangents[..., 0]], axis=-1)
    # gamma'' = k nu points to the centre
    assert np.all(curve.curvatures * np.sum(left * curve.ends, axis=2) < 0.0)


def test_part_of_a_rim_has_the_tangents_of_the_whole() -> None:
    mesh = annulus(16, [1.0, 1.5, 2.0])
    rim = mesh.boundary_facets()
    whole = edge_curve(mesh, rim, 30.0)
    part = edge_curve(mesh, rim[[3]], 30.0)
    assert np.allclose(part.tangents[0], whole.tangents[3])
    assert np.allclose(part.curvatures[0], whole.curvatures[3])


def test_straight_sides_and_corners() -> None:
    mesh = turned(rectangle(3, 2, 3.0, 2.0), 33.0, (5.0, 7.0))
    curve = edge_curve(mesh, mesh.boundary_facets(), 30.0)
    assert not curve.curvatures.any()
    chord = curve.ends[:, 1] - curve.ends[:, 0]
    assert np.allclose(curve.tangents, (chord / np.linalg.norm(chord, axis=1, keepdims=True))[:, None])


@pytest.mark.parametrize(("corner_deg", "bent"), [(50.0, False), (70.0, True)])
def test_the_corner_angle_decides(corner_deg: float, bent: bool) -> None:
    """The corners of a hexagon turn by 60 degrees."""
    corners = np.array([[np.cos(a), np.sin(a)] for a in np.arange(6) * np.pi / 3])
    mesh = MeshTri(np.vstack([[0.0, 0.0], corners]).T, np.array([(0, i, i % 6 + 1) for i in range(1, 7)]).T)
    curve = edge_curve(mesh, mesh.boundary_facets(), corner_deg)
    assert np.allclose(np.abs(curve.curvatures), 1.0 if bent else 0.0)


def test_an_inner_curve_ends_with_its_supported_edges() -> None:
    """An arc of inner edges: its ends have the circle through the nearest three vertices."""
    mesh = annulus(24, [1.0, 1.5, 2.0])
    radius = np.linalg.norm(mesh.p[:, mesh.facets], axis=0)
    ring = np.flatnonzero(np.ptp(radius, axis=0) < 1e-9)
    middle = mesh.p[:, mesh.facets[:, ring]].mean(axis=1)
    arc = ring[(np.abs(np.linalg.norm(middle, axis=0) - 1.5) < 0.05) & (middle[0] > 0.2)]
    curve = edge_curve(mesh, arc, 30.0)
    assert len(arc) > 5
    assert np.allclose(np.abs(curve.curvatures), 1.0 / np.linalg.norm(curve.ends, axis=2))
