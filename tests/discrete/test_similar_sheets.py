"""Similar sheets take similar shapes: without weight, the units of length and stiffness do not matter."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.equilibrium import Equilibrium
from asterism.discrete.release.release_start import ReleaseStart
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from tests.discrete.models import model_of

BENT = ReleaseStart(bend="roll", axis_deg=20.0, sag_mm=12.0, noise_mm=0.3, releases=(0.3, 1.0))


def model(size: float, stiff: float = 1.0, branch: str = "up", thickness: float = 0.3, rings: int = 0) -> DiscreteModel:
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
    one, other = (solve_on_mesh(model(*each, branch, thickness=0.2)) for each in ((1.0, 1.0), (size, stiff)))
    assert one.stars_up == other.stars_up == (branch == "up")
    assert_similar(one, other, size, stiff)


@pytest.mark.slow
def test_other_starts_of_similar_sheets_end_in_similar_shapes() -> None:
    small, large = (solve_on_mesh(model(size, thickness=0.4, rings=1), BENT) for size in (0.5, 4.0))
    assert_similar(small, large, 8.0)


@pytest.mark.parametrize("start", [ReleaseStart(), BENT, ReleaseStart(bumps=False, bend="saddle", sag_mm=20.0)])
def test_similar_sheets_start_similar(start: ReleaseStart) -> None:
    one, other = model(1.0), model(7.0)
    assert start.initial_state(other).positions == pytest.approx(7.0 * start.initial_state(one).positions, abs=1e-9)
