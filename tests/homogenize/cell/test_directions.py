"""Which directions a law needs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.homogenize.campaign.fit_law import sample_quantities
from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.homogenize.cell.point_group import ALL_ANGLES_RAD, THREEFOLD_ANGLES_RAD, averaged_directions, tube_angles
from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.law.anisotropy import predicted_curvatures
from asterism.homogenize.law.star_law import QUANTITY_NAMES
from asterism.pattern.design.lattice import Lattice
from tests.homogenize.cells import EDGE, design

TURNED = [[17.0 * np.cos(a), 17.0 * np.sin(a)] for a in np.radians((10.0, 70.0))]


@pytest.mark.parametrize(
    ("lattice", "fabric", "alike"),
    [
        ({}, {}, True),
        ({"arms": 6}, {}, True),
        ({"orientation_deg": 20}, {}, True),
        ({"kind": "custom", "vectors_mm": TURNED}, {"modulus_mpa": [2.0, 2.0]}, True),
        ({"arms": 5}, {}, False),
        ({"arms": 4, "kind": "square"}, {}, False),
        ({"arms": 3, "kind": "square"}, {}, False),
        ({}, {"modulus_mpa": [2.0, 1.0]}, False),
        ({}, {"stretch": [1.2, 1.3]}, False),
    ],
)
def test_what_a_sheet_needs(lattice: dict[str, Any], fabric: dict[str, Any], alike: bool) -> None:
    found = tube_angles(design(5.0, lattice=lattice, fabric=fabric))
    assert found == (THREEFOLD_ANGLES_RAD if alike else ALL_ANGLES_RAD)


def test_six_directions_have_the_mean_of_all() -> None:
    def curl(angle: np.ndarray) -> np.ndarray:
        return 0.05 + 0.01 * np.cos(2 * angle - 1.0) + 0.004 * np.sin(4 * angle) + 0.003 * np.cos(6 * angle)

    values = curl(np.array(ALL_ANGLES_RAD))
    assert values[averaged_directions(values)].mean() == pytest.approx(0.05, rel=1e-12)
    three = 0.05 + 0.003 * np.cos(6 * np.array(THREEFOLD_ANGLES_RAD))
    assert averaged_directions(three) == [0, -1]


@pytest.mark.slow
def test_a_law_of_five_arms_follows_its_directions() -> None:
    """The same star seen from the next direction, turned with its lattice, has the same row, the mean over directions.

    Star and lattice are their own mirror images, the state of the cell is not: which of the two it comes to is a matter
    of rounding.
    """
    lattice = np.asarray(Lattice(kind="square").vectors)
    cos, sin = np.cos(np.pi / 6), np.sin(np.pi / 6)
    turned = lattice @ np.array([[cos, sin], [-sin, cos]])
    custom = {"kind": "custom", "arms": 5}
    stars = [{"vectors_mm": lattice.tolist()}, {"vectors_mm": turned.tolist(), "orientation_deg": 30.0}]
    rows = [solve_cell(design(6.0, 0.5, lattice={**custom, **star}), EDGE).to_dict() for star in stars]
    assert [len(one["angles_rad"]) for one in rows] == [6, 6]
    curvature = [np.array(one["natural_curvature"]) for one in rows]
    same = np.roll(curvature[0], 1)
    images = [same, same[(2 - np.arange(6)) % 6]]
    assert any(np.allclose(image, curvature[1], rtol=1e-4) for image in images)
    assert np.ptp(curvature[0]) > 1e-3 * abs(curvature[0].mean())
    for found in rows:
        kappa = np.array(found["natural_curvature"])
        assert np.abs(predicted_curvatures(found) - kappa).max() < 0.5 * np.ptp(kappa)
    one, other = (sample_quantities(found, 1.35) for found in rows)
    assert one[QUANTITY_NAMES.index("c3")] == other[QUANTITY_NAMES.index("c3")] == 0.0
    np.testing.assert_allclose(other, one, rtol=1e-3)


def test_amplitudes_are_of_heights_over_their_mean_and_weights_count_as_often_as_they_say() -> None:
    waves, rng = CorrugationWaves.of(Lattice()), np.random.default_rng(3)
    offsets, heights, times = rng.uniform(-9.0, 9.0, (90, 2)), rng.normal(size=90), rng.integers(1, 5, 90)
    found = waves.amplitudes(offsets, heights, times.astype(float))
    assert np.allclose(waves.amplitudes(offsets, heights + 7.0, times.astype(float)), found)
    several = waves.amplitudes(np.repeat(offsets, times, axis=0), np.repeat(heights, times), np.ones(times.sum()))
    assert np.allclose(several, found)
