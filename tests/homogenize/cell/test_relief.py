"""The waves of a relief: means of cosines and sines over a star's turns, however they are computed."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.pattern.design.lattice import Lattice

LATTICES = {
    "triangular": Lattice(),
    "six arms": Lattice(arms=6),
    "square": Lattice(kind="square", arms=4),
    "arms off the lattice": Lattice(kind="square", arms=3),
    "five arms": Lattice(arms=5),
    "five turned arms": Lattice(kind="square", arms=5, orientation_deg=10.0),
    "four arms on a triangular lattice": Lattice(arms=4, orientation_deg=30.0),
}


@pytest.mark.parametrize("name", LATTICES)
def test_waves_are_means_over_the_turns(name: str) -> None:
    waves = CorrugationWaves.of(LATTICES[name])
    offsets = np.random.default_rng(0).uniform(-80.0, 80.0, (50, 2))
    phase = np.einsum("wgk,nk->nwg", waves.reciprocal, offsets)
    expected = np.where(waves.odd, np.sin(phase).mean(axis=2), np.cos(phase).mean(axis=2))
    assert np.allclose(waves(offsets), expected, atol=1e-12)


@pytest.mark.parametrize("name", LATTICES)
def test_waves_repeat_from_star_to_star(name: str) -> None:
    lattice = LATTICES[name]
    waves, offsets = CorrugationWaves.of(lattice), np.random.default_rng(1).uniform(-5.0, 5.0, (20, 2))
    assert np.allclose(waves(offsets + np.array([2, -3]) @ lattice.vectors), waves(offsets), atol=1e-12)


@pytest.mark.parametrize("name", LATTICES)
def test_no_wave_vanishes_everywhere(name: str) -> None:
    waves = CorrugationWaves.of(LATTICES[name])
    assert (np.abs(waves(np.random.default_rng(2).uniform(-20.0, 20.0, (200, 2)))).max(axis=0) > 0.1).all()


def test_amplitudes_are_of_heights_over_their_mean_and_weights_count_as_often_as_they_say() -> None:
    waves, rng = CorrugationWaves.of(LATTICES["triangular"]), np.random.default_rng(3)
    offsets, heights, times = rng.uniform(-9.0, 9.0, (90, 2)), rng.normal(size=90), rng.integers(1, 5, 90)
    found = waves.amplitudes(offsets, heights, times.astype(float))
    assert np.allclose(waves.amplitudes(offsets, heights + 7.0, times.astype(float)), found)
    several = waves.amplitudes(np.repeat(offsets, times, axis=0), np.repeat(heights, times), np.ones(times.sum()))
    assert np.allclose(several, found)
