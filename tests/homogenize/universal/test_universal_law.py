"""The campaign of the universal law, the law through its cells, its errors and its file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from asterism.homogenize.campaign.campaign import CampaignProgress
from asterism.homogenize.errors import CampaignError, LawError
from asterism.homogenize.law.law_table import QUANTITY_NAMES
from asterism.homogenize.universal.groups import GROUP_KEYS, arm_curl
from asterism.homogenize.universal.kriging import Covariance, Kriging
from asterism.homogenize.universal.law_errors import errors_of_cells, left_out_errors
from asterism.homogenize.universal.universal_campaign import UniversalPlan, run_universal_campaign, spread_groups
from asterism.homogenize.universal.universal_law import UniversalLaw, bare_quantities, from_smooth, to_smooth
from asterism.homogenize.universal.universal_law_file import load_universal_law, universal_law_bytes
from tests.homogenize import same_process
from tests.homogenize.universal import answers

PLAN = UniversalPlan(spread=70, rounds=1, refined=10)


@pytest.fixture(autouse=True)
def one_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("asterism.homogenize.campaign.workers.local_workers", same_process.workers)


@pytest.fixture(scope="module")
def law(tmp_path_factory: pytest.TempPathFactory) -> UniversalLaw:
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr("asterism.homogenize.campaign.workers.local_workers", same_process.workers)
        return run_universal_campaign(PLAN, tmp_path_factory.mktemp("campaign"), solve=answers.solve)


def test_an_interrupted_campaign_gives_the_same_law(law: UniversalLaw, tmp_path: Path) -> None:
    def stop(progress: CampaignProgress) -> None:
        if progress.done == 40:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_universal_campaign(PLAN, tmp_path, solve=answers.solve, report=stop)
    assert len(list(tmp_path.iterdir())) == 40
    done: list[int] = []
    resumed = run_universal_campaign(
        PLAN, tmp_path, solve=answers.solve, report=lambda progress: done.append(progress.done)
    )
    assert done[0] == 40
    assert [part.weights.tobytes() for part in resumed.parts.values()] == [
        part.weights.tobytes() for part in law.parts.values()
    ]


def test_a_longer_campaign_goes_on_from_a_law(law: UniversalLaw, tmp_path: Path) -> None:
    done: list[int] = []
    longer = run_universal_campaign(
        UniversalPlan(spread=90), tmp_path, law, solve=answers.solve, report=lambda progress: done.append(progress.done)
    )
    assert done[0] == 70 and len(longer.cells) == 90
    assert np.array_equal(longer.cells.groups[:70], law.cells.groups[:70])


@pytest.mark.slow
def test_rounds_of_a_law_are_kept(law: UniversalLaw, tmp_path: Path) -> None:
    same = run_universal_campaign(PLAN, tmp_path, law, solve=answers.fails)
    assert universal_law_bytes(same) == universal_law_bytes(law)
    more = run_universal_campaign(UniversalPlan(90, 2, 10), tmp_path, law, solve=answers.solve)
    assert len(more.cells) == 110 and np.array_equal(more.cells.groups[90:100], law.cells.groups[70:])
    assert more.spread.sum() == more.cells.usable[:90].sum()


def test_cells_of_other_code_are_refused(law: UniversalLaw, tmp_path: Path) -> None:
    old = UniversalLaw(law.cells, law.parts, law.left_out, law.spread_count, {**law.made, "code": "old"})
    run_universal_campaign(UniversalPlan(spread=70), tmp_path, old, solve=answers.solve)
    with pytest.raises(CampaignError, match="other answers"):
        run_universal_campaign(UniversalPlan(spread=70), tmp_path, old, solve=answers.other_code)


def test_too_few_answers_give_no_law(tmp_path: Path) -> None:
    with pytest.raises(CampaignError, match="needs 40 cells with an answer, and has 0"):
        run_universal_campaign(UniversalPlan(spread=50), tmp_path, solve=answers.fails)


def test_the_law_follows_cells_that_it_has_not_seen(law: UniversalLaw) -> None:
    groups = spread_groups(60, seed=7)
    groups = groups[law.covers(groups)]
    cells = np.array([(answers.solve(row)[0] or {})["row"] for row in groups.tolist()])[:, : len(QUANTITY_NAMES)]
    given = law(groups)[:, : len(QUANTITY_NAMES)]
    lam, bending = QUANTITY_NAMES.index("lam_n"), QUANTITY_NAMES.index("bending")
    assert np.median(np.abs(given / cells - 1.0)[:, [lam, bending]], axis=0).max() < 0.01
    table = left_out_errors(law).table()
    assert 0.0 < table["lam_n"][0] < 1.0 and table["kappa"][0] < 30.0


def test_left_out_values_are_those_of_a_law_without_the_cell() -> None:
    rng = np.random.default_rng(0)
    places, arms = rng.random((30, 3)), 0.2 + rng.random(30)
    values = arms * np.sin(3.0 * places[:, 0] + places[:, 1])
    covariance = Covariance(np.array([0.9, 1.1, 2.0]), 1e-3, np.array([2.0, -1.0, 0.0]))
    whole = Kriging.through(places, arms, values[:, None], covariance)
    without = Kriging.through(places[1:], arms[1:], values[1:, None], covariance)
    np.testing.assert_allclose(whole.left_out(values[:, None])[0], without.values(places[:1], arms[:1])[0], rtol=1e-6)


def test_blocks_of_places_have_the_values_of_the_plain_sum_of_kernels() -> None:
    rng = np.random.default_rng(1)
    places, arms = rng.random((25, 3)), 0.2 + rng.random(25)
    lengths = np.array([0.7, 1.2, 2.0])
    law = Kriging.through(places, arms, rng.normal(size=(25, 2)), Covariance.even(lengths, 1e-6))
    asked, own = np.vstack([rng.random((36, 3)), places[:1]]), 0.3 + rng.random(37)
    r = np.sqrt(5.0 * (((asked[:, None] - places) / lengths) ** 2).sum(axis=-1))
    plain = own[:, None] * (((1.0 + r + r**2 / 3.0) * np.exp(-r)) @ (arms[:, None] * law.weights))
    np.testing.assert_allclose(law.values(asked, own), plain, rtol=0.0, atol=1e-12 * np.abs(law.weights).sum())
    assert np.array_equal(law.values(asked[:0], own[:0]), np.empty((0, 2)))


def test_stars_without_arms_are_bare_fabric(law: UniversalLaw) -> None:
    groups = spread_groups(5, seed=3)
    groups[:, GROUP_KEYS.index("arm")] = 0.0
    np.testing.assert_array_equal(law(groups)[:, : len(QUANTITY_NAMES)], bare_quantities(groups))


def test_smooth_forms_go_back() -> None:
    groups = spread_groups(20, seed=4)
    rows = np.array([(answers.solve(row)[0] or {})["row"] for row in groups.tolist()])
    back = from_smooth(to_smooth(rows, groups), groups)
    np.testing.assert_allclose(back, rows[:, : back.shape[1]], rtol=1e-10, atol=1e-14)


def test_cells_are_spread_with_whole_arms() -> None:
    groups = spread_groups(300)
    arm, edge, fabric = (groups[:, GROUP_KEYS.index(key)] for key in ("arm", "edge", "fabric"))
    np.testing.assert_allclose(np.rint(arm / edge), arm / edge, atol=1e-6)
    assert (arm_curl(groups) <= 3.0).all() and (fabric / edge >= 0.45 - 1e-9).all()
    assert np.array_equal(spread_groups(20), groups[:20]) and not np.array_equal(spread_groups(20, 1), groups[:20])


def test_the_file_holds_the_law(law: UniversalLaw, tmp_path: Path) -> None:
    path = tmp_path / "universal.npz"
    path.write_bytes(universal_law_bytes(law))
    read = load_universal_law(path)
    groups = spread_groups(10, seed=5)
    np.testing.assert_array_equal(read(groups), law(groups))
    assert read.cells.problems == law.cells.problems and read.made == law.made
    path.write_bytes(path.read_bytes()[:-3000])
    with pytest.raises(LawError, match="damaged"):
        load_universal_law(path)


def test_errors_are_unknown_among_cells_that_curl_tightly() -> None:
    percent = np.tile(np.arange(1.0, 5.0)[:, None], len(QUANTITY_NAMES))
    separated = np.array([True, False, True, False])
    known, unknown = errors_of_cells(percent, separated, np.array([[0, 1, 2, 3], [0, 1, 3, 3]]))
    assert known == pytest.approx(np.sqrt(5.0)) and (unknown == np.inf).all()
