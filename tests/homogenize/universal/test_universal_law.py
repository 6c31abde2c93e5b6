"""The universal law of the package: its values, its range, its errors and its file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law_table import QUANTITY_NAMES
from asterism.homogenize.universal.groups import GROUP_KEYS, GROUPS
from asterism.homogenize.universal.universal_law import (
    PACKAGED_UNIVERSAL_LAW,
    STATED_QUANTITIES,
    Kriging,
    UniversalLaw,
    bare_quantities,
    errors_of_cells,
    load_universal_law,
)

_Q = len(QUANTITY_NAMES)


@pytest.fixture(scope="module")
def law() -> UniversalLaw:
    return load_universal_law()


def test_the_file_has_the_groups_and_quantities_of_the_code() -> None:
    with np.load(PACKAGED_UNIVERSAL_LAW) as archive:
        assert tuple(archive["groups"]) == GROUP_KEYS and tuple(archive["names"][:_Q]) == QUANTITY_NAMES
        assert np.array_equal(archive["limits"], [group.limits for group in GROUPS])


def test_the_law_goes_through_its_cells_apart_from_their_scatter(law: UniversalLaw) -> None:
    with np.load(PACKAGED_UNIVERSAL_LAW) as archive:
        cells = archive["cell_rows"][law.usable][::9]
    groups = law.solved_groups[law.usable][::9]
    off = np.abs(law(groups) - cells[:, : _Q + 24])
    size = np.abs(cells[:, : _Q + 24])
    lam, kappa, bending, a11 = (QUANTITY_NAMES.index(name) for name in ("lam_n", "kappa", "bending", "a11"))
    for column, most in ((lam, 3e-4), (kappa, 0.02), (bending, 0.02), (a11, 0.01)):
        assert np.median(off[:, column] / size[:, column]) < most
    assert np.median(off[:, _Q:].max(axis=1) / size[:, _Q:].max(axis=1)) < 0.02
    assert law.covers(groups).all()


def test_cells_without_an_answer_are_outside(law: UniversalLaw) -> None:
    assert not law.covers(law.solved_groups[~law.usable]).any()
    few = law.solved_groups[law.usable][:8].copy()
    for key in GROUP_KEYS:
        beyond = few.copy()
        beyond[:, GROUP_KEYS.index(key)] = 1.01 * GROUPS[GROUP_KEYS.index(key)].limits[1]
        assert not law.covers(beyond).any(), key


def test_values_stay() -> None:
    stars = [0.5, 1.5, 0.004, 0.002, 0.05, 3.0, 0.025, 0.07], [0.3, 1.3, 0.002, 0.001, 0.06, 2.0, 0.02, 0.1]
    expected = [
        [
            0.7706888629615,
            0.7581070131454,
            1.139924250483,
            0.001315312456432,
            1.899987785896,
            0.01249638014122,
            0.0001240049375709,
            0.04991390644982,
        ],
        [
            0.8023168078927,
            0.8020406642787,
            0.1342123980486,
            0.0008027471017653,
            1.920894160267,
            0.5249457366791,
            7.760786082912e-06,
            0.008614732092,
        ],
    ]
    np.testing.assert_allclose(load_universal_law()(np.array(stars))[:, :_Q], expected, rtol=1e-9)


def test_errors_are_those_of_the_left_out_cells(law: UniversalLaw) -> None:
    assert law.percent.shape == (law.usable.sum(), len(STATED_QUANTITIES))
    contraction, curvature, stiffness = np.median(law.percent[law.separated], axis=0)
    assert 0.0 < contraction < 0.1 and 0.5 < curvature < 5.0 and 0.5 < stiffness < 5.0


def test_blocks_of_places_have_the_values_of_the_plain_sum_of_kernels() -> None:
    rng = np.random.default_rng(1)
    places, arms = rng.random((25, 3)), 0.2 + rng.random(25)
    lengths, weights = np.array([0.7, 1.2, 2.0]), rng.normal(size=(25, 2))
    law = Kriging(places, arms, lengths, weights)
    asked, own = np.vstack([rng.random((36, 3)), places[:1]]), 0.3 + rng.random(37)
    r = np.sqrt(5.0 * (((asked[:, None] - places) / lengths) ** 2).sum(axis=-1))
    plain = own[:, None] * (((1.0 + r + r**2 / 3.0) * np.exp(-r)) @ (arms[:, None] * weights))
    np.testing.assert_allclose(law.values(asked, own), plain, rtol=0.0, atol=1e-12 * np.abs(weights).sum())
    assert np.array_equal(law.values(asked[:0], own[:0]), np.empty((0, 2)))


def test_stars_without_arms_are_bare_fabric(law: UniversalLaw) -> None:
    groups = law.solved_groups[:5].copy()
    groups[:, GROUP_KEYS.index("arm")] = 0.0
    np.testing.assert_array_equal(law(groups)[:, :_Q], bare_quantities(groups))


def test_a_damaged_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "universal.npz"
    for content in (PACKAGED_UNIVERSAL_LAW.read_bytes()[:-3000], b"", None):
        path.unlink(missing_ok=True)
        if content is not None:
            path.write_bytes(content)
        with pytest.raises(LawError, match=r"universal\.npz: the universal law is missing or damaged"):
            load_universal_law(path)


def test_errors_are_unknown_among_cells_that_curl_tightly() -> None:
    percent = np.tile(np.arange(1.0, 5.0)[:, None], len(STATED_QUANTITIES))
    separated = np.array([True, False, True, False])
    known, unknown = errors_of_cells(percent, separated, np.array([[0, 1, 2, 3], [0, 1, 3, 3]]))
    assert known == pytest.approx(np.sqrt(5.0)) and (unknown == np.inf).all()
