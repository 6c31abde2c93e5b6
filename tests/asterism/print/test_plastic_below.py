"""Prints with plastic on both sides of the fabric: two files, the one below mirrored."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from asterism.pattern.design.design import Design
from asterism.print.export import export
from asterism.print.job import Job
from tests.asterism.print.jobs import job

STARS: dict[str, Any] = {"length_mm": 8.0, "thickness_mm": 0.4}


def sheet(**stars: Any) -> Design:
    return Design.from_dict({"stars": STARS | stars, "border": {"rings": 1}})


def volumes(one: Job) -> dict[str, dict[str, float]]:
    return {name: {solid.name: solid.volume_mm3 for solid in solids} for name, solids in one.prints.items()}


def test_plastic_below_is_a_print_of_its_own_and_mirrored() -> None:
    whole, both = volumes(job(sheet())), job(sheet(override=[{"star": 1, "side": "below"}]))
    parts = volumes(both)
    assert list(parts) == ["print", "print-below"] and list(parts["print"]) == ["stars", "border"]
    assert list(parts["print-below"]) == ["stars-below"]
    below = parts["print-below"]["stars-below"]
    assert below == pytest.approx(whole["print"]["stars"] / 7.0, rel=1e-3)
    assert parts["print"]["stars"] + below == pytest.approx(whole["print"]["stars"], rel=1e-6)
    # the star is right of the middle of the bed, and left of it with the frame turned over
    (low, high), (star,) = both.prints["print-below"][0].box, both.plan.centres[both.plan.star_side < 0]
    across = both.placement.points(star)[0]
    assert across > 5.0 and 0.5 * (low + high)[0] == pytest.approx(both.printer.bed_centre_mm[0] - across, abs=0.01)


def test_a_sheet_with_all_plastic_below_is_one_mirrored_print() -> None:
    above, below = volumes(job(sheet())), volumes(job(sheet(side="below")))
    assert list(below) == ["print"] and list(below["print"]) == ["stars-below", "border"]
    assert list(below["print"].values()) == pytest.approx(list(above["print"].values()), rel=1e-6)


@pytest.mark.slow
def test_the_export_has_both_prints_and_says_how_to_make_them(tmp_path: Path) -> None:
    done = export(sheet(override=[{"star": 1, "side": "below"}]), tmp_path)
    assert {"print.3mf", "print-below.3mf", "stars.stl", "stars-below.stl"} <= set(done.files)
    assert not {"stars.scad", "stars.lua"} & set(done.files)
    assert any("OpenSCAD and IceSL are left out" in line for line in done.warnings)
    text = " ".join((tmp_path / "instructions.txt").read_text(encoding="utf-8").split())
    assert "First print print-below.3mf" in text and "0.4 mm higher than start.gcode" in text
    one_side = export(sheet(), tmp_path)
    assert "stars.scad" in one_side.files and not (tmp_path / "print-below.3mf").exists()
