"""The waves of a relief: means of cosines and sines over a star's turns, however they are computed."""

from __future__ import annotations

import numpy as np
import pytest

from homogenize.relief import Waves
from pattern.lattice import Lattice

LATTICES = {
    "triangular": Lattice(),
    "six arms": Lattice(arms=6),
    "square": Lattice(kind="square", arms=4),
    "arms off the lattice": Lattice(kind="square", arms=3),
}


@pytest.mark.parametrize("name", LATTICES)
def test_waves_are_means_over_the_turns(name: str) -> None:
    waves = Waves.of(LATTICES[name])
    offsets = np.random.default_rng(0).uniform(-80.0, 80.0, (50, 2))
    phase = np.einsum("wgk,nk->nwg", waves.reciprocal, offsets)
    expected = np.where(waves.odd, np.sin(phase).mean(axis=2), np.cos(phase).mean(axis=2))
    assert np.allclose(waves(offsets), expected, atol=1e-12)


def test_waves_repeat_from_star_to_star() -> None:
    lattice = LATTICES["triangular"]
    waves, offsets = Waves.of(lattice), np.random.default_rng(1).uniform(-5.0, 5.0, (20, 2))
    assert np.allclose(waves(offsets + np.array([2, -3]) @ lattice.vectors), waves(offsets), atol=1e-12)
