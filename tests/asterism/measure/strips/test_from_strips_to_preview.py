"""A maker's path: measured strips of another fabric, then one command for the preview of a design."""

from __future__ import annotations

from pathlib import Path

import pytest

from asterism.pattern.design.materials import Plastic
from tests.asterism.commands import Cli
from tests.asterism.measure.strips.synthetic import synthetic_readings
from tests.asterism.measure.strips.test_fit_strips import table

# the preview of a whole gallery design
pytestmark = pytest.mark.slow


@pytest.mark.parametrize("fabric_mm", [0.8, 0.5])
def test_a_preview_of_a_measured_fabric(fabric_mm: float, tmp_path: Path, monkeypatch, cli: Cli) -> None:
    plastic = Plastic(modulus_ratio=4139.0, kappa_bar_per_mm=0.002)
    strips = table(synthetic_readings(0, plastic, stretch=1.5, fabric_mm=fabric_mm), tmp_path / "strips.csv")
    assert cli(["strips", "fit", str(strips)]).status == 0
    monkeypatch.chdir(tmp_path)
    assert cli(["new", "dome"]).status == 0
    done = cli(["preview", "dome.toml", "--material", "material.toml", "-o", "shape"])
    assert done.status == 0 and "0 outside the law" in done.out
    assert "stretch 1.5" in done.out and (tmp_path / "shape" / "shape.obj").exists()
