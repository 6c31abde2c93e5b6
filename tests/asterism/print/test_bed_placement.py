"""Prints that no printer with a profile holds, and frames that are larger than the bed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import Design, save_design
from asterism.print import printer as profiles
from asterism.print.bed_placement import frame_warning, size_warning
from asterism.print.printer import adjusted_printer
from asterism.print.settings import ExportSettings
from tests.asterism.commands import Cli


def sheet(sides: tuple[float, float], **more: Any) -> Design:
    return Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rectangle_mm": list(sides)}} | more)


@pytest.mark.parametrize("name", gallery.names())
def test_every_design_of_the_gallery_fits_a_known_printer(name: str) -> None:
    assert not list(size_warning(gallery.load(name)))


def test_a_large_print_is_named_with_the_printers_and_fits_a_printer_of_the_user(tmp_path: Path) -> None:
    wide = sheet((300.0, 120.0))
    (line,) = size_warning(wide)
    assert "300 x 120 mm" in line and "Ultimaker 2+ 223 x 223 mm" in line and "Prusa MK4 250 x 210 mm" in line
    text = (Path(profiles.__file__).parent / "data/printers/ultimaker2.toml").read_text()
    folder = tmp_path / "home" / "printers"
    folder.mkdir(parents=True)
    (folder / "long.toml").write_text(
        text.replace("[223.0, 223.0]", "[130.0, 330.0]").replace("[260.0, 260.0]", "[160.0, 370.0]")
    )
    # it fits after a quarter of a turn, which a fabric of two stretches does not allow
    assert not list(size_warning(wide))
    assert list(size_warning(sheet((300.0, 120.0), fabric={"stretch": [1.35, 1.3]})))
    # a file with a mistake does not hide the other printers
    (folder / "wrong.toml").write_text("name = 3\n")
    assert not list(size_warning(wide))


@pytest.mark.slow
def test_previews_warn_of_large_prints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, blank_pictures: None, cli: Cli
) -> None:
    monkeypatch.chdir(tmp_path)
    save_design(sheet((330.0, 60.0)), tmp_path / "long.toml")
    assert "no known printer holds the print of 330 x 60 mm" in cli(["preview", "long.toml"]).err


@pytest.mark.slow
def test_the_frame_is_an_option(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, blank_pictures: None, cli: Cli
) -> None:
    monkeypatch.chdir(tmp_path)
    save_design(
        Design.from_dict({"stars": {"length_mm": 8.0, "thickness_mm": 0.4}, "border": {"rings": 1}}),
        tmp_path / "d.toml",
    )
    words = ["export", "d.toml", "--printer", "ender-3"]
    default = cli(words)
    assert default.status == 0 and "the frame of 260 x 260 mm is larger than the bed of 220 x 220 mm" in default.err
    given = cli([*words, "--frame", "200x180"])
    assert given.status == 0 and "larger than the bed" not in given.err
    assert "frame of 200 x 180 mm" in " ".join((tmp_path / "d-print" / "instructions.txt").read_text().split())
    assert "larger than the bed" in cli([*words, "--frame", "240"]).err
    # the profile of this printer states its frame
    assert "larger than the bed" not in cli(["export", "d.toml", "--printer", "ultimaker2"]).err
    for wrong in ("wide", "1x2x3", "5x5", ""):
        refused = cli([*words, f"--frame={wrong}"])
        assert refused.status == 2 and "--frame" in refused.line, wrong


def test_a_frame_that_stands_out_over_the_bed_is_named() -> None:
    assert not list(frame_warning(adjusted_printer(ExportSettings(frame_mm=(220.0, 220.0)))))
    assert list(frame_warning(adjusted_printer(ExportSettings(frame_mm=(260.0, 260.0)))))
