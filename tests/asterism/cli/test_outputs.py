"""What stands in the way of a result is named before anything is computed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from asterism.results.files import SUMMARY_FILE
from tests.asterism.commands import command

SMALL = "[stars]\nlength_mm = 10.0\nthickness_mm = 0.4\n[border]\nrings = 0\n[mesh]\nedge_mm = 4.0\n"
VARY = ["--vary", "stars.thickness_mm=0.3,0.4"]
FIT = ["fit", "t.npy", "--extent-mm", "120", "-o"]
# a command, a folder or a file in the way of its results, and the function that computes them
CASES = [
    (["preview", "d.toml"], f"d/{SUMMARY_FILE}/", "previews.session.preview"),
    (["simulate", "d.toml"], "d/minimum-2.png/", "verification.both_starts.simulate"),
    (["verify", "d.toml"], "d-verified/exact.obj/", "verification.run.verify"),
    (["export", "d.toml"], "d-print/layout.pdf/", "print.export.export"),
    (["export", "d.toml", "--simulate"], "d-print/rods.vtu/", "print.export.export"),
    (["report", "d.toml"], "d-report.pdf/", "reports.design_report.prepare"),
    (["sweep", "d.toml", *VARY], "d-sweep/sweep.html/", "sweeps.sweep.sweep_design"),
    (["sweep", "d.toml", *VARY], "d-sweep/designs", "sweeps.sweep.sweep_design"),
    (["compare", "d", "scan.obj"], "scan-compared/compare.png/", "measure.compare.compare.compare"),
    (["compare-designs", "d.toml", "d.toml", "-o", "p.html"], "p.html/", "reports.compare_designs.prepare"),
    ([*FIT, "f.toml"], "f.toml/", "fitting.load_target.load_target"),
    ([*FIT, "f.toml"], "f-fit/target.obj/", "fitting.load_target.load_target"),
    (["law", "show"], "paper-law/law.png/", "laws.law_picture.draw_law"),
    (["calibrate", "d.toml"], "d-law.npz/", "laws.calibrate.run_campaign"),
    (["picture", "d", "-o", "p"], "p/d-oblique.png/", "shape.vtu.read_shape"),
]


@pytest.mark.parametrize(("words", "obstacle", "computation"), CASES, ids=lambda value: str(value))
def test_an_obstacle_is_named_before_anything_is_computed(
    words: list[str],
    obstacle: str,
    computation: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(SMALL)
    (tmp_path / "scan.obj").write_text("v 0 0 0\n")
    np.save(tmp_path / "t.npy", np.zeros((4, 4)))
    path = tmp_path / obstacle
    path.parent.mkdir(parents=True, exist_ok=True)
    path.mkdir() if obstacle.endswith("/") else path.write_text("mine")
    before = sorted(tmp_path.rglob("*"))

    def compute(*arguments: object, **options: object) -> None:
        raise AssertionError("it computes")

    monkeypatch.setattr(f"asterism.{computation}", compute)
    refused = command(words, capsys, monkeypatch)
    kind = "folder" if obstacle.endswith("/") else "file"
    assert refused.status == 2
    assert refused.line == f"asterism: cannot write {obstacle.rstrip('/')}: a {kind} is in the way"
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.slow
def test_a_folder_with_the_name_of_a_shape_does_not_matter_to_an_export_without_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(SMALL)
    (tmp_path / "d-print" / "shape.vtu").mkdir(parents=True)
    assert command(["export", "d.toml"], capsys, monkeypatch).status == 0
    assert (tmp_path / "d-print" / "export.json").is_file()
