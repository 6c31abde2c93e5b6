"""A maker's path: measured strips of another fabric, then one command for the preview of a design."""

from __future__ import annotations

from pathlib import Path

import pytest

from asterism.pattern.design.materials import Plastic
from tests.asterism.commands import command
from tests.asterism.measure.strips.synthetic import synthetic_readings
from tests.asterism.measure.strips.test_fit_strips import table

# the preview of a whole gallery design
pytestmark = pytest.mark.slow


@pytest.mark.parametrize("fabric_mm, is_served", [(0.8, True), (0.5, False)])
def test_a_preview_or_one_sentence(fabric_mm: float, is_served: bool, tmp_path: Path, capsys, monkeypatch) -> None:
    plastic = Plastic(modulus_ratio=4139.0, kappa_bar_per_mm=0.002)
    strips = table(synthetic_readings(0, plastic, stretch=1.5, fabric_mm=fabric_mm), tmp_path / "strips.csv")
    assert command(["strips", "fit", str(strips)], capsys, monkeypatch).status == 0
    monkeypatch.chdir(tmp_path)
    assert command(["new", "dome"], capsys, monkeypatch).status == 0
    done = command(["preview", "dome.toml", "--material", "material.toml", "-o", "shape"], capsys, monkeypatch)
    if is_served:
        assert done.status == 0 and "the universal law stands in" in done.err
        assert "stretch 1.5" in done.out and (tmp_path / "shape" / "shape.obj").exists()
    else:
        assert done.status == 2 and done.err.count("\n") == 1
        assert "the universal law does not serve for 37 of 37 stars: fabric thickness over spacing" in done.err
        assert "asterism simulate needs no law" in done.err
        assert not (tmp_path / "shape").exists()
