"""Starts of the release, their shapes by formula; forms of one design, and when two are equal."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.equilibrium import roll_axis_deg
from asterism.discrete.release.forms import ExactForm, distinct_forms, find_minima
from asterism.discrete.release.levels import Ladder
from asterism.discrete.release.release_start import ReleaseStart, release_starts
from asterism.equilibrium.arrays import Array
from asterism.pattern.geometry.normals import vertex_normals
from asterism.pattern.layout.symmetries import Symmetry, symmetries
from tests.discrete.models import model_of, tube
from tests.distances import symmetric_distances

MIRROR = np.diag([-1.0, 1.0, 1.0])


def model(rings: int = 1, edge: float = 3.0, **changes: object) -> DiscreteModel:
    return tube(edge, rings, **{"stars": {"length_mm": 10.0, "thickness_mm": 0.3}} | changes)


def ladder(m: DiscreteModel, edge: float = 3.0) -> Ladder:
    """The mesh of a model alone."""
    return Ladder(m.design, m.layout, edge)


def image(m: DiscreteModel, state: State, symmetry: Symmetry) -> State:
    """The state `x'(p) = Q x(turn p + shift)`, vertex by vertex and director by director."""
    moved = m.mesh.points @ symmetry.turn.T + symmetry.shift
    distance, vertex = cKDTree(m.mesh.points).query(moved)
    assert distance.max() < 1e-9
    q = Rotation.from_rotvec([0.3, -0.5, 0.8]).as_matrix() @ (MIRROR if symmetry.mirrors else np.eye(3))
    edge = {(int(a), int(b)): i for i, (a, b) in enumerate(m.edges)}
    director = [edge[int(vertex[a]), int(vertex[b])] for a, b in m.edges]
    return State(state.positions[vertex] @ q.T, state.directors[director] @ q.T)


def test_images_of_a_shape_have_its_energy_and_zero_distance() -> None:
    m = model()
    start = ReleaseStart(bend="roll", axis_deg=20.0, sag_mm=12.0, noise_mm=0.5)
    state = start.initial_state(m)
    m.set_release(1.0)
    same = symmetries(m.design, m.layout)
    assert len(same) == 6
    centres = m.mesh.star_vertices
    for symmetry in same:
        other = image(m, state, symmetry)
        assert m.energy(other) == pytest.approx(m.energy(state), rel=1e-10)
        apart = symmetric_distances(m.layout.centres, state.positions[centres], other.positions[centres], same)
        assert apart.min() < 1e-9
        assert np.sort(apart)[1] > 0.05
    # reflected in space only, it is another shape: its stars have other places on the sheet
    kept = State(state.positions @ MIRROR, state.directors @ MIRROR)
    assert symmetric_distances(m.layout.centres, state.positions[centres], kept.positions[centres], same[:1])[0] > 0.05


@pytest.mark.parametrize("bend", ["roll", "dome", "saddle"])
def test_a_bend_does_not_depend_on_the_place_of_the_outline(bend: str) -> None:
    def start(x: float) -> Array:
        border = {"polygon_mm": [[x, 0.0], [x + 60.0, 0.0], [x + 60.0, 60.0], [x, 60.0]]}
        data = {"stars": {"length_mm": 6.0}, "lattice": {"origin_mm": [x, 0.0]}, "border": border}
        flat_start = ReleaseStart(bumps=False, bend=bend, sag_mm=20.0, noise_mm=0.0)  # type: ignore[arg-type]
        return flat_start.initial_state(model_of(data, 6.0)).positions

    here, there = start(-30.0), start(300.0)
    np.testing.assert_allclose(there - [330.0, 0.0, 0.0], here, atol=1e-9)
    assert np.ptp(here[:, 2]) > 9.0


@pytest.mark.parametrize(("bend", "axis"), [("roll", 20.0), ("roll", 90.0), ("dome", 0.0), ("saddle", 0.0)])
def test_roll_axis(bend: str, axis: float) -> None:
    m = model(rings=2, edge=4.0)
    state = ReleaseStart(bumps=False, bend=bend, axis_deg=axis, sag_mm=25.0, noise_mm=0.0).initial_state(m)  # type: ignore[arg-type]
    turned = Rotation.from_rotvec([1.0, 2.0, -0.5]).as_matrix()
    normals = vertex_normals(state.positions, m.mesh.triangles)[m.edges].mean(axis=1)
    found = roll_axis_deg(m, State(state.positions @ turned.T, normals @ turned.T))
    if bend == "roll":
        assert found == pytest.approx(axis, abs=3.0)
    else:
        assert found is None


def test_flat_sheets_and_single_stars_have_no_roll_axis() -> None:
    m = model()
    assert roll_axis_deg(m, m.flat_state()) is None
    assert roll_axis_deg(model(rings=0), model(rings=0).flat_state()) is None


@pytest.mark.slow
def test_a_star_prescribed_down_stays_down() -> None:
    override = [{"star": 0, "branch": "down"}, {"star": 3, "branch": "free"}]
    m = model(stars={"length_mm": 10.0, "thickness_mm": 0.3, "override": override})
    assert m.layout.star_branch.tolist() == [-1, 1, 1, 0, 1, 1, 1]
    down, up = solve_on_mesh(m), solve_on_mesh(model())
    assert down.is_minimum and np.flatnonzero(down.bumps < 0.0).tolist() == [0]
    assert up.is_minimum and up.stars_up == 7
    assert down.energy > up.energy


@pytest.mark.slow
def test_all_stars_down() -> None:
    m = model(rings=0, stars={"length_mm": 10.0, "thickness_mm": 0.3, "branch": "down"})
    assert solve_on_mesh(m).stars_up == 0
    assert solve_on_mesh(m, ReleaseStart(bumps=False)).stars_up == 1  # a flat start ignores prescribed sides


def test_the_first_start_is_the_default_and_the_sequence_is_fixed() -> None:
    once, again = (release_starts(7, count, ReleaseStart(seed=3)) for count in (30, 12))
    assert once[:12] == again
    assert once[0] == ReleaseStart(seed=3)
    assert len({(b.bend, b.axis_deg, b.sag_mm, b.releases, b.seed, b.branch) for b in once}) == 30
    with pytest.raises(ValueError, match="at least 1"):
        find_minima(ladder(model(rings=0)), 0)


@pytest.mark.slow
def test_many_starts_find_the_default_minimum_and_others() -> None:
    m = model(rings=0, fabric={"bending": "paper"})
    minima = find_minima(ladder(m), 9)
    assert minima.fine == sorted(minima.fine, key=lambda b: b.equilibrium.energy)
    assert all(b.equilibrium.is_minimum for b in minima.fine)
    assert sum(len(b.starts) for b in minima.fine) + minima.lost_starts == 9
    default = next(b for b in minima.fine if b.default)
    assert default.equilibrium.energy == pytest.approx(solve_on_mesh(m).energy, rel=1e-9)
    assert minima.distance_percent(default, default) < 1e-6


@pytest.mark.slow
def test_mirrored_minima_are_one_form() -> None:
    m = model()
    found = solve_on_mesh(m, ReleaseStart(bend="roll", axis_deg=20.0, sag_mm=12.0, releases=(1.0,)))
    same = symmetries(m.design, m.layout)
    images = [replace(found, state=image(m, found.state, one), bumps=found.bumps[one.star]) for one in same]
    forms = [ExactForm(one, m, (str(k),), k == 0) for k, one in enumerate(images)]
    assert len(distinct_forms(forms, same)) == 1
    assert distinct_forms(forms, same)[0].starts == tuple("012345")


@pytest.mark.slow
def test_prescribed_stars_decide_which_minimum_is_reported() -> None:
    """Up has less energy, but a minimum with the prescribed star down is the result if there is one."""
    m = model(rings=0, stars={"length_mm": 10.0, "thickness_mm": 0.3, "branch": "down"})
    minima = find_minima(ladder(m), 8)
    assert minima.fine[0].equilibrium.stars_up == 0
    assert minima.fine[0].equilibrium.energy > min(b.equilibrium.energy for b in minima.fine[1:])


@pytest.mark.slow
def test_the_image_with_the_prescribed_star_down_is_kept() -> None:
    """Images of a design with one inverted star invert another star. The form with the prescribed star down is kept."""
    override = [{"star": 1, "branch": "down"}]
    m = model(stars={"length_mm": 10.0, "thickness_mm": 0.25, "override": override})
    same = symmetries(m.design, m.layout)
    mine, other = solve_on_mesh(m), solve_on_mesh(m, ReleaseStart("other", branch=(1, 1, 1, -1, 1, 1, 1)))
    lower = replace(other, energies={"all": mine.energy - 1e-6})
    assert mine.sides.tolist() == [1, -1, 1, 1, 1, 1, 1] and other.sides.tolist() == [1, 1, 1, -1, 1, 1, 1]
    kept = distinct_forms([ExactForm(mine, m, ("mine",), True), ExactForm(lower, m, ("other",), False)], same)
    assert len(kept) == 1 and kept[0].equilibrium is mine and kept[0].starts == ("mine", "other")


@pytest.mark.slow
def test_flat_stars_are_on_no_side() -> None:
    """Bumps within rounding do not split a flat state into several forms."""
    m = model()
    flat = replace(solve_on_mesh(m), bumps=np.array([1e-15, -1e-15, 0.0, 2e-16, -3e-16, 1e-15, 1e-15]))
    other = replace(flat, bumps=-flat.bumps)
    assert (flat.sides == 0).all() and flat.stars_up == 0
    forms = [ExactForm(one, m, (name,), False) for name, one in (("a", flat), ("b", other))]
    assert len(distinct_forms(forms, symmetries(m.design, m.layout))) == 1


def test_noise_does_not_move_held_components() -> None:
    sheet = tube(border={"rectangle_mm": [70.0, 60.0]}, pins=[{"where": "border", "scale": 0.9}])
    quiet, noisy = (ReleaseStart(noise_mm=noise).initial_state(sheet).positions for noise in (0.0, 0.5))
    held = sheet.constraints.held
    assert held.any()
    np.testing.assert_array_equal(noisy[held], quiet[held])
    assert np.abs(noisy - quiet)[~held].std() > 0.2
