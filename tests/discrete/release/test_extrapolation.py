"""Extrapolation of the shape on a finer mesh from two coarser ones: rotations continue."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State, rotate_vectors
from asterism.discrete.release.levels import Ladder, SharedSearch, solve_on_meshes
from asterism.discrete.release.prolongation import extrapolate, interpolate_surface, plastic_normals
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.mesh import Mesh
from asterism.pattern.mesh.meshing import mesh_layout
from tests.discrete.models import paper_tube
from tests.distances import rms_distance


def rolled(m: DiscreteModel, radius: float) -> State:
    x, y = m.mesh.points.T
    positions = np.column_stack([x, radius * np.sin(y / radius), radius * np.cos(y / radius)])
    return State(positions, plastic_normals(m, positions))


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_a_tube_continues_to_close_at_the_same_rate(share: float) -> None:
    """From curvature 1/40 to 1/25, and on by a share of the difference, for any rigid motion of the sheet."""
    m = paper_tube(2.5)
    before, state = rolled(m, 40.0), rolled(m, 25.0)
    spin = np.array([[0.5, -1.2, 0.8]])
    lies = State(rotate_vectors(spin, before.positions[None])[0] + 7.0, rotate_vectors(spin, before.directors[None])[0])
    found = extrapolate(m, lies, state, share)
    expected = rolled(m, 1.0 / (1.0 / 25.0 + share * (1.0 / 25.0 - 1.0 / 40.0)))
    apart = found.positions - expected.positions
    apart -= apart.mean(axis=0)
    # flat triangles on a cylinder, each rotated as a whole
    assert np.sqrt((apart**2).sum(axis=1).mean()) < 0.05


def test_held_vertices_stay() -> None:
    m = paper_tube(2.5, pins=[{"where": "border", "scale": 0.8}])
    held = m.constraints.held
    found = extrapolate(m, rolled(m, 40.0), rolled(m, 25.0), 0.7)
    np.testing.assert_array_equal(found.positions[held], rolled(m, 25.0).positions[held])


@pytest.mark.slow
def test_a_fine_mesh_starts_closer_to_its_minimum(monkeypatch: pytest.MonkeyPatch) -> None:
    """A soft sheet, which changes from mesh to mesh while its creases are not resolved."""
    starts: list[tuple[DiscreteModel, State, State]] = []

    def noted(m: DiscreteModel, before: State, state: State, share: float) -> State:
        starts.append((m, state, extrapolate(m, before, state, share)))
        return starts[-1][2]

    monkeypatch.setattr("asterism.discrete.release.levels.extrapolate", noted)
    monkeypatch.setattr("asterism.discrete.release.levels.COARSE_VERTICES", 250)
    fine = paper_tube(17.3205 / 16)
    search = SharedSearch(Ladder(fine.design, fine.layout))
    found, levels = solve_on_meshes(search)
    assert found.is_minimum and len(levels) == 4 and len(starts) == 2
    for (_, without, start), end in zip(starts, search.ends[2:], strict=True):
        found_at = end.state.positions
        assert rms_distance(start.positions, found_at) < 0.8 * rms_distance(without.positions, found_at)


WHOLE = [[-30, -30], [30, -30], [30, 30], [-30, 30]]
# a cut whose lips are 0.2 mm apart at the rim, and meet in the middle
SLIT = [[-30, -30], [30, -30], [30, -0.1], [0, 0], [30, 0.1], [30, 30], [-30, 30]]


def mesh(border: list[list[float]], edge_mm: float) -> Mesh:
    data = {"stars": {"length_mm": 6.0}, "border": {"polygon_mm": border}}
    return mesh_layout(layout(Design.from_dict(data)), edge_mm)


def bowl(points: Array) -> Array:
    x, y = points.T
    return np.column_stack([0.8 * points, 0.01 * (x**2 + x * y)])


def opened(points: Array) -> Array:
    """One lip up, the other one down."""
    x, y = points.T
    return np.column_stack([points, np.where(x > 0.0, np.sign(y) * 0.01 * x**2, 0.0)])


@pytest.mark.parametrize("border", [WHOLE, SLIT])
@pytest.mark.parametrize(("smooth", "part"), [(True, 0.4), (False, 1.0)])
def test_a_bowl_is_interpolated(border: list[list[float]], smooth: bool, part: float) -> None:
    """Flat triangles deviate from a surface by 1/8 of its curvature times the square of their edge."""
    coarse, fine = mesh(border, 4.0), mesh(border, 1.5)
    found = interpolate_surface(coarse.points, coarse.triangles, bowl(coarse.points), fine.points, smooth)
    corners = coarse.points[coarse.triangles]
    edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
    curvature = np.linalg.eigvalsh([[0.02, 0.01], [0.01, 0.0]]).max()
    assert np.abs(found - bowl(fine.points)).max() < part * curvature * edge**2 / 8.0


@pytest.mark.parametrize("smooth", [True, False])
def test_lips_of_a_slit_stay_apart(smooth: bool) -> None:
    coarse, fine = mesh(SLIT, 4.0), mesh(SLIT, 1.5)
    found = interpolate_surface(coarse.points, coarse.triangles, opened(coarse.points), fine.points, smooth)
    lips = (np.abs(fine.points[:, 1]) < 0.2) & (fine.points[:, 0] > 5.0)
    assert lips.sum() > 20
    assert np.abs(found - opened(fine.points))[lips].max() < 0.1


def test_beyond_the_rim_the_nearest_triangle_continues() -> None:
    coarse = mesh(SLIT, 4.0)
    beyond = np.array([[-30.5, 11.0], [12.0, 30.0 + 1e-12], [30.4, -30.4]])
    tilted = np.column_stack([coarse.points, coarse.points @ [0.3, -0.2]])
    found = interpolate_surface(coarse.points, coarse.triangles, tilted, beyond, True)
    assert found == pytest.approx(np.column_stack([beyond, beyond @ [0.3, -0.2]]), abs=1e-9)
