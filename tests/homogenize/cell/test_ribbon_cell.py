"""Ribbons: their mesh, the derivatives of a free screw, its rigid motions, and a long ribbon of the exact model."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.discrete.model.state import State
from asterism.exact.simulation import exact_shape
from asterism.homogenize.cell.ribbon_cell import RibbonCell, cylinder_coordinates, relax_ribbon
from asterism.homogenize.cell.ribbon_mesh import RibbonShape, ribbon_mesh
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from asterism.pattern.geometry.planar import triangle_areas

STEPS, FINE = 6, 10
SHAPES = [RibbonShape(False, 1, 5, STEPS, 3), RibbonShape(True, 2, 8, STEPS, 3)]


def design(steps: int = STEPS, **border: object) -> Design:
    """Arms of half a spacing."""
    stars = {"length_mm": 0.5 * DEFAULT_SPACING_MM, "thickness_mm": 0.35}
    mesh = {"edge_mm": DEFAULT_SPACING_MM / steps}
    return Design.from_dict({"stars": stars, "border": border or {"rings": 1}, "mesh": mesh})


def bent(cell: RibbonCell) -> State:
    """A state far from equilibrium with a turned screw."""
    start = cell.printed_state()
    rng = np.random.default_rng(1)
    return cell.path(start, 0.05 * rng.standard_normal(len(cell.free)))[0](1.0)


@pytest.mark.parametrize("shape", SHAPES)
def test_a_period_covers_the_strip_once(shape: RibbonShape) -> None:
    mesh = ribbon_mesh(design().lattice, shape)
    assert triangle_areas(mesh.points, mesh.triangles).min() > 0.0
    assert triangle_areas(mesh.points, mesh.triangles).sum() == pytest.approx(mesh.area)
    assert set(np.unique(mesh.image[:, 0])) <= {-1, 0, 1} and not mesh.image[:, 1].any()
    # each triangle has three sides; those on the two free sides belong to one triangle only
    on_sides = 2 * (1 if shape.across else STEPS) * (STEPS if shape.across else 1)
    assert 2 * len(mesh.hinges) == 3 * len(mesh.triangles) - on_sides
    assert len(mesh.star_vertices) == shape.lines


@pytest.mark.parametrize("shape", SHAPES)
def test_gradient_and_hessian_follow_the_energy(shape: RibbonShape) -> None:
    cell = RibbonCell(design(), shape)
    state = bent(cell)
    along = np.random.default_rng(2).standard_normal(len(cell.free))
    at, _ = cell.path(state, along)
    step = 1e-5
    before, after = at(-step), at(step)
    slope = (cell.energy(after) - cell.energy(before)) / (2.0 * step)
    assert cell.gradient(state) @ along == pytest.approx(slope, rel=1e-6)
    # the gradients are those by the spins and shifts at each state: along the path they change by the Hessian
    second = (cell.energy(after) - 2.0 * cell.energy(state) + cell.energy(before)) / step**2
    found = along @ (cell.pattern.full(cell.hessian(state, 0.0)) @ along)
    assert found == pytest.approx(second, rel=1e-3)


@pytest.mark.parametrize("shape", SHAPES)
def test_rigid_motions_cost_no_energy(shape: RibbonShape) -> None:
    cell = RibbonCell(design(), shape)
    state = bent(cell)
    force = cell.gradient(state)
    motions = cell.rigid_motions(state)
    assert np.abs(force @ motions).max() < 1e-9 * np.abs(force).max()
    assert np.linalg.matrix_rank(motions) == 6
    assert len(cell.support(state)) == 6


@pytest.mark.slow
def test_a_ribbon_is_the_middle_of_a_long_one() -> None:
    """The angle between adjacent stars in the middle of a long sheet of the exact model is that of the screw."""
    cell = RibbonCell(design(FINE), RibbonShape(False, 1, 8, FINE, 5))
    ribbon = relax_ribbon(cell)
    assert ribbon.definite and ribbon.curvature > 0.01 and abs(ribbon.pitch) < 1e-6
    exact = exact_shape(design(FINE, polygon_mm=long_outline(cell, 7).tolist()))
    middle = cell.mesh.points[cell.mesh.star_vertices[0]] + np.arange(-1, 3)[:, None] * cell.mesh.cell_vectors[0]
    chords = np.diff(exact.at(middle), axis=0)
    unit = chords / np.linalg.norm(chords, axis=1)[:, None]
    turns = np.arccos((unit[:-1] * unit[1:]).sum(axis=1))
    assert turns.mean() / cell.length == pytest.approx(ribbon.curvature, rel=2e-3)
    radius, _, angle, _ = cylinder_coordinates(cell, ribbon.state)
    chord = 2.0 * radius[cell.mesh.star_vertices[0]] * np.sin(0.5 * angle)
    assert np.linalg.norm(chords, axis=1).mean() == pytest.approx(chord, rel=1e-3)


def long_outline(cell: RibbonCell, periods: int) -> np.ndarray:
    """(4, 2) corners of a rectangle of so many periods, the cell's in the middle."""
    along = cell.mesh.cell_vectors[0]
    unit = along / cell.length
    normal = np.array([-unit[1], unit[0]])
    points = cell.mesh.points[: cell.mesh.n_base]
    low, high = (points @ normal).min(), (points @ normal).max()
    middle = points[cell.mesh.star_vertices] @ unit
    start = 0.5 * (middle.min() + middle.max()) - 0.5 * periods * cell.length
    end = start + periods * cell.length
    return np.array([s * unit + t * normal for s, t in ((start, low), (end, low), (end, high), (start, high))])
