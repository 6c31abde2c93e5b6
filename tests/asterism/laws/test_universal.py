"""`asterism law universal` makes the law of all fabrics, and `asterism law errors` prints its errors."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.asterism.commands import command
from tests.homogenize import same_process
from tests.homogenize.universal import answers


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("asterism.homogenize.campaign.workers.local_workers", same_process.workers)
    monkeypatch.setattr("asterism.homogenize.universal.universal_campaign.solve_groups", answers.solve)
    monkeypatch.setattr("asterism.laws.universal.solve_groups", answers.solve)
    monkeypatch.setattr("asterism.laws.universal.make_universal_law.__defaults__", (None, 1, None, None, answers.solve))
    return tmp_path


def test_from_the_cells_to_the_table(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ["law", "universal", "--afresh", "--cells", "64", "--rounds", "0", "--jobs", "1"]
    made = command(words, capsys, monkeypatch)
    assert made.status == 0 and "64 of 64 cells" in made.err
    assert len(list((folder / "universal.samples").iterdir())) == 64
    shown = command(["law", "errors", "universal.npz"], capsys, monkeypatch)
    assert shown.status == 0 and shown.out == made.out
    assert "left out one by one" in shown.out and "kappa" in shown.out
    more = command([*words[:2], "--cells", "70", "--rounds", "0", "--from", "universal.npz"], capsys, monkeypatch)
    assert more.status == 0 and "70 of 70 cells" in more.err


@pytest.mark.parametrize(
    "words, said",
    [
        (["universal", "-o", "law.txt"], "--output: 'law.txt' must end with .npz"),
        (["universal", "--afresh", "--from", "a.npz"], "--afresh: conflicts with --from"),
        (["universal", "--jobs", "2", "--dask", "tcp://x:1"], "--jobs: applies to processes of this machine"),
        (["universal", "--from", "none.npz", "--cells", "64"], "none.npz: cannot be read"),
        (["errors", "none.npz"], "none.npz: cannot be read"),
    ],
)
def test_mistakes(
    words: list[str], said: str, folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    refused = command(["law", *words], capsys, monkeypatch)
    assert refused.status == 2 and said in refused.line
    assert list(folder.iterdir()) == []


def test_a_law_of_one_material_is_no_universal_law(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from asterism.homogenize.law.law_file import PAPER_LAW

    refused = command(["law", "errors", str(PAPER_LAW)], capsys, monkeypatch)
    assert refused.status == 2 and refused.line.endswith("is not a universal law")
