"""The weight of a sheet, and the supports that carry it; similar sheets without weight have similar shapes."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.equilibrium import Equilibrium
from asterism.discrete.release.release_start import ReleaseStart
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from tests.discrete.models import model_of

GRAVITY = 9.81


def model(**sections: object) -> DiscreteModel:
    """Seven stars on 60 x 60 mm, held at the corners."""
    data = {
        "fabric": {"modulus_mpa": 5.0, "stretch": [1.2, 1.5], "thickness_mm": 0.7, "density_kg_m3": 300.0},
        "plastic": {"density_kg_m3": 1200.0},
        "stars": {"length_mm": 6.0, "thickness_mm": 0.4, "width_mm": 1.1},
        "border": {"rectangle_mm": [60.0, 60.0]},
        "pins": [{"where": "corners", "scale": 0.8}],
        "gravity": {"on": True},
        "mesh": {"edge_mm": 5.0},
    }
    return model_of(data | sections)


def mass(stars: int) -> float:
    """kg: 300 kg/m^3 of 0.7 mm thick fabric, 60/1.2 by 60/1.5 mm large at rest, and arms of 1200 kg/m^3."""
    return 1e-9 * (300.0 * 0.7 * 50.0 * 40.0 + 1200.0 * stars * 3 * 6.0 * 0.4 * 1.1)


def test_the_weight_is_that_of_fabric_and_plastic_along_gravity() -> None:
    moon = {"on": True, "direction": [3.0, 0.0, -4.0], "acceleration_m_s2": 1.62}
    for m, pull in ((model(), [0.0, 0.0, -GRAVITY]), (model(gravity=moon), 1.62 * np.array([0.6, 0.0, -0.8]))):
        total = m.load.reshape(-1, 3).sum(axis=0)
        np.testing.assert_allclose(total, mass(len(m.layout.centres)) * np.array(pull), rtol=1e-9, atol=1e-15)


@pytest.mark.slow
def test_the_supports_carry_the_weight() -> None:
    """At equilibrium the reactions at the held vertices balance the weight."""
    m = model()
    found = solve_on_mesh(m)
    assert found.is_minimum
    forces = m.full_gradient(found.state)[: 3 * m.n_vertices].reshape(-1, 3)
    carried = forces[m.constraints.held.any(axis=1), 2].sum()
    assert carried == pytest.approx(GRAVITY * mass(len(m.layout.centres)), rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pins", "offset"),
    [
        ({"where": "corners", "scale": 0.8}, [700.0, -300.0, 1000.0]),
        ({"where": "corners", "slide": "plane"}, [0.0, 0.0, 1000.0]),
    ],
)
def test_the_energy_does_not_depend_on_the_place_of_the_pins(pins: dict[str, object], offset: list[float]) -> None:
    """The potential of the weight counts from the supports: a table that is higher by 1 m changes no energy."""
    here, there = (solve_on_mesh(model(pins=[each])) for each in (pins, pins | {"offset_mm": offset}))
    assert here.energies["gravity"] == pytest.approx(there.energies["gravity"], rel=1e-6)
    assert here.energy == pytest.approx(there.energy, rel=1e-9)


def hung(
    modulus: float, pins: dict[str, object], direction: tuple[float, float, float] = (0.0, 0.0, -1.0)
) -> tuple[Equilibrium, np.ndarray, np.ndarray]:
    """Seven stars on fabric of a given modulus, which gravity rotates about their supports.

    What was found, its centre of mass (3,), and the places that are held (n, 3), mm.
    """
    data = {
        "fabric": {"modulus_mpa": modulus},
        "stars": {"length_mm": 10.0, "thickness_mm": 0.3},
        "border": {"rings": 1},
        "mesh": {"edge_mm": 5.0},
        "gravity": {"on": True, "direction": direction},
    }
    m = model_of(data | {"pins": [pins]})
    found = solve_on_mesh(m)
    places, mass = found.state.positions, np.linalg.norm(m.load.reshape(-1, 3), axis=1)
    return found, mass @ places / mass.sum(), places[m.constraints.held.any(axis=1)]


@pytest.mark.parametrize("modulus", [7.1875, 1000.0])
@pytest.mark.slow
def test_a_sheet_on_one_needle_hangs_below_it_or_is_no_equilibrium(modulus: float) -> None:
    """Its weight is 1e-8 of its membrane stiffness. Upside down it stands on the needle, which is unstable."""
    needle = {"points_mm": [[0.0, 0.0]]}
    below, middle, _ = hung(modulus, needle)
    assert below.is_minimum
    assert middle[2] < -1.0 and np.linalg.norm(middle[:2]) < 0.02
    # the stiffness of a pendulum: all other motions are far stiffer
    assert 0.0 < below.smallest_eigenvalue < 1e-5
    above, middle, _ = hung(modulus, needle, (0.0, 0.0, 1.0))
    assert not above.is_minimum or middle[2] > 1.0


@pytest.mark.slow
@pytest.mark.parametrize("modulus", [7.1875, 1e4])
def test_a_sheet_on_two_needles_hangs_below_them_or_is_no_equilibrium(modulus: float) -> None:
    found, middle, (first, second) = hung(modulus, {"corners": [0, 1]})
    along = (second - first) / np.linalg.norm(second - first)
    across = np.eye(3) - np.outer(along, along)
    arm, down = across @ (middle - first), across @ np.array([0.0, 0.0, -1.0])
    hangs = arm @ down > 0.999 * np.linalg.norm(arm) * np.linalg.norm(down)
    assert hangs or not found.is_minimum
    assert hangs or modulus > 100.0


BENT = ReleaseStart(bend="roll", axis_deg=20.0, sag_mm=12.0, noise_mm=0.3, releases=(0.3, 1.0))


def similar(
    size: float, stiff: float = 1.0, branch: str = "up", thickness: float = 0.3, rings: int = 0
) -> DiscreteModel:
    """Stars and fabric whose lengths are `size` times those of the paper."""
    data = {
        "fabric": {"thickness_mm": 0.8 * size, "modulus_mpa": 7.1875 * stiff},
        "lattice": {"spacing_mm": size * float(DEFAULT_SPACING_MM)},
        "stars": {"length_mm": 9.0 * size, "thickness_mm": thickness * size, "width_mm": 1.2 * size, "branch": branch},
        "border": {"rings": rings, "tip_margin_mm": 0.5 * size},
        "mesh": {"edge_mm": 3.5 * size},
    }
    return model_of(data)


def assert_similar(one: Equilibrium, other: Equilibrium, size: float, stiff: float = 1.0) -> None:
    assert one.is_minimum and other.is_minimum
    assert other.energy == pytest.approx(stiff * size**3 * one.energy, rel=1e-7)
    assert other.bumps == pytest.approx(size * one.bumps, rel=1e-5)
    apart = np.linalg.norm(np.diff(other.state.positions, axis=0), axis=1)
    assert apart == pytest.approx(size * np.linalg.norm(np.diff(one.state.positions, axis=0), axis=1), rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("size, stiff", [(5.0, 1.0), (0.3, 1e3)])
@pytest.mark.parametrize("branch", ["up", "down"])
def test_stars_of_every_size_take_the_side_of_their_branch(branch: str, size: float, stiff: float) -> None:
    one, other = (solve_on_mesh(similar(*each, branch, thickness=0.2)) for each in ((1.0, 1.0), (size, stiff)))
    assert one.stars_up == other.stars_up == (branch == "up")
    assert_similar(one, other, size, stiff)


@pytest.mark.parametrize("start", [ReleaseStart(), BENT, ReleaseStart(bumps=False, bend="saddle", sag_mm=20.0)])
def test_similar_sheets_start_similar(start: ReleaseStart) -> None:
    one, other = similar(1.0), similar(7.0)
    assert start.initial_state(other).positions == pytest.approx(7.0 * start.initial_state(one).positions, abs=1e-9)
