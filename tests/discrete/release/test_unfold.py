"""Folds of a start are laid flat before Newton's method meets them."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.release.release_start import GRADUAL_RELEASE, start_of_design
from asterism.discrete.release.unfold import unfolded
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout


def held(stretch: float = 1.35, **fabric: float) -> DiscreteModel:
    """Seven stars whose border is held where the fabric contracts to."""
    table = {"stars": {"length_mm": 6.0}, "border": {"rings": 1}, "fabric": {"stretch": stretch} | fabric}
    design = Design.from_dict(table | {"pins": [{"where": "border", "scale": 1 / stretch}]})
    plan = layout(design)
    return DiscreteModel(design, plan, mesh_layout(plan, 3.0))


def upright(model: DiscreteModel, state: State) -> Array:
    """(T,) heights of the unit normals of the triangles."""
    gradients, _ = model.reconstruction.gradients(state.positions)
    normal = np.cross(gradients[:, :, 0], gradients[:, :, 1])
    return normal[:, 2] / np.linalg.norm(normal, axis=1)


@pytest.fixture(scope="module")
def sheet() -> tuple[DiscreteModel, State]:
    """A model, and its flat sheet, contracted as a whole."""
    model = held()
    return model, model.apply_supports(model.printed_state())


def test_a_vertex_beyond_its_neighbours_goes_back(sheet: tuple[DiscreteModel, State]) -> None:
    model, flat = sheet
    on_rods = set(np.concatenate(model.mesh.rods).tolist())
    inner = [v for v in range(model.n_vertices) if v not in on_rods and not model.held.reshape(-1, 3)[v].any()]
    vertex = min(inner, key=lambda v: np.linalg.norm(model.mesh.points[v] - [4.0, 3.0]))
    moved = flat.positions.copy()
    moved[vertex] += [4.0, 0.0, 0.3]
    folded = model.moved_to(flat, moved)
    assert (upright(model, folded) < 0.0).sum() == 2
    again = unfolded(model, folded)
    assert upright(model, again).min() > 0.3
    assert model.energy(again) < 0.02 * model.energy(folded)
    assert np.array_equal(again.positions[model.constraints.held], flat.positions[model.constraints.held])
    # rods keep their length
    assert model.energies(again)["rod_stretch"] < 0.01 * model.energy(again)
    # a model whose reconstruction was made at another release does the same
    later = held()
    later.set_release(0.3)
    assert later.reconstruction is not None
    later.set_release(1.0)
    np.testing.assert_allclose(unfolded(later, folded).positions, again.positions, atol=1e-6)


@pytest.mark.parametrize("grain_deg", [0.0, 30.0, 90.0])
def test_folds_of_a_fabric_with_a_grain_are_those_of_the_sheet(grain_deg: float) -> None:
    alike, grain = held(1.75), held(1.75, modulus_mpa=[9.0, 4.0], grain_deg=grain_deg)
    places = [unfolded(model, model.apply_supports(model.printed_state())).positions for model in (alike, grain)]
    np.testing.assert_allclose(places[1], places[0], atol=1.0)
    assert upright(grain, State(places[1], grain.printed_state().directors)).min() > 0.3


def test_exact_folds_have_no_finite_energy() -> None:
    model = held(1.75)
    contracted = model.apply_supports(model.printed_state())  # arms that keep their length pass each other in the plane
    assert upright(model, contracted).min() == -1.0 and not np.isfinite(model.energy(contracted))
    assert upright(model, unfolded(model, contracted)).min() > 0.3


def test_a_sheet_without_folds_stays_as_it_is() -> None:
    model = held()
    model.set_release(0.0)
    printed = model.printed_state()
    assert unfolded(model, printed) is printed
    half_turn = printed.rotated(np.diag([-1.0, 1.0, -1.0]), np.zeros(3))
    assert unfolded(model, half_turn) is half_turn


def test_more_stretch_is_released_in_as_long_steps() -> None:
    assert start_of_design(held(1.35).design).releases == GRADUAL_RELEASE
    longer = start_of_design(held(1.75).design).releases
    assert (longer[0], longer[-1]) == (GRADUAL_RELEASE[0], 1.0)
    assert 0.75 * np.diff(longer).max() <= 0.35 * np.diff(GRADUAL_RELEASE).max() * 1.001
