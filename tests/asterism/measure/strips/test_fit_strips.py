"""`asterism strips fit` as its user meets it, and the material it leaves."""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from asterism import Design, StripFitSettings, fit_strips, load_material, write_material
from asterism.laws.from_files import with_material
from asterism.measure.strip_table import Reading, arc_box
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.spread import Spread
from tests.asterism.commands import Cli
from tests.asterism.measure.strips.synthetic import synthetic_readings


def table(strips: list[Reading], path: Path) -> Path:
    """Boxes of strips to a tenth of a millimetre, as someone writes them down."""
    head = "strip,thickness_mm,length_mm,stretch,fabric_thickness_mm,direction,box_width_mm,box_height_mm"
    rows: dict[str, list[str]] = {}
    for r in strips:
        first = [r.strip, f"{r.thickness_mm:g}", f"{r.length_mm:g}", f"{r.stretch:g}", f"{r.fabric_thickness_mm:g}"]
        first.append(r.direction or "")
        width, height = arc_box(r.curvature_per_mm or 0.0, r.length_mm)
        rows.setdefault(r.strip, first).extend([f"{width:.1f}", f"{height:.1f}"])
    lines = [head + ",peeled_box_width_mm,peeled_box_height_mm", *map(",".join, rows.values())]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture
def strips(tmp_path: Path) -> Path:
    return table(synthetic_readings(0), tmp_path / "strips.csv")


def test_material_picture_and_numbers(strips: Path, cli: Cli) -> None:
    printed = cli(["strips", "fit", str(strips)]).done.out
    assert all(word in printed for word in ("E1/E2, paper", "E1/E2, timoshenko", "kappa_bar", "times as stiff"))
    material = load_material(strips.with_name("material.toml"))
    assert material.plastic.modulus_ratio == pytest.approx(3200, rel=0.04)
    assert material.plastic.kappa_bar_per_mm == pytest.approx(0.003, rel=0.1)
    assert (material.fabric.stretch, material.fabric.thickness_mm) == (1.35, 0.8)
    numbers = json.loads(strips.with_name("material.json").read_text())
    found = numbers["modulus_ratio"]["paper"]
    assert found["low"] <= 3200 <= found["high"]
    assert material.plastic.modulus_ratio == pytest.approx(found["value"], rel=1e-4)
    spread, bar = material.spread, numbers["kappa_bar"][0]
    assert spread is not None and spread.model_fields_set == {"modulus_ratio_factor", "kappa_bar_error_per_mm"}
    assert found["value"] * spread.modulus_ratio_factor == pytest.approx(found["high"], rel=1e-3)
    assert spread.kappa_bar_error_per_mm == pytest.approx(bar["high_per_mm"] - bar["value_per_mm"], rel=1e-3)
    with Image.open(strips.with_name("material.png")) as picture:
        assert picture.size == (1350, 810)


def test_strips_in_two_directions_give_a_fabric_with_a_grain(tmp_path: Path, cli: Cli) -> None:
    strips = table(synthetic_readings(0, moduli=(10.0, 5.0)), tmp_path / "strips.csv")
    done = cli(["strips", "fit", str(strips)]).done
    assert "E1/E2 along, paper" in done.out and "E1/E2 across, timoshenko" in done.out
    material = load_material(strips.with_name("material.toml"))
    along, across = material.fabric.moduli
    assert along / across == pytest.approx(2.0, rel=0.05) and material.fabric.modulus == pytest.approx(7.1875, rel=1e-3)
    assert material.plastic.modulus_ratio == pytest.approx(3200, rel=0.04)
    numbers = json.loads(strips.with_name("material.json").read_text())
    assert numbers["modulus_ratio"]["paper"]["value"] < 2600 < numbers["modulus_ratio_across"]["paper"]["value"]
    assert numbers["readings_used"] == 80


def test_the_other_convention_and_a_table(strips: Path, cli: Cli) -> None:
    words = ["strips", "fit", str(strips), "--rest-curvature", "timoshenko", "--kappa-bar", "per-thickness"]
    assert cli(words).done
    plastic = load_material(strips.with_name("material.toml")).plastic
    assert plastic.rest_curvature == "timoshenko" and 1400 < plastic.modulus_ratio < 1650
    assert plastic.kappa_bar_per_mm.thickness_mm == (0.3, 0.35, 0.4, 0.45)  # type: ignore[union-attr]


def test_outliers_are_named(strips: Path, cli: Cli) -> None:
    rows = strips.read_text().splitlines()
    rows[7] = "7,0.3,60,1.35,0.8,,44.0,18.0,59.6,1.6"
    rows[9] = "9,0.3,60,1.35,0.8,,44.0,5.0,59.6,1.6"
    strips.write_text("\n".join(rows))
    done = cli(["strips", "fit", str(strips)]).done
    assert "80, 79 used" in done.out
    assert "strip 7 with fabric (row 8): 0.04" in done.err and "it is used" in done.err
    # a box that is not that of the strip
    assert "left out: strip 9 with fabric (row 10): its box holds an arc of 45.5 mm" in done.out


def test_own_files_are_left_alone(strips: Path, cli: Cli) -> None:
    material = strips.with_name("material.toml")
    words = ["strips", "fit", str(strips)]
    assert cli(words).status == cli(words).status == 0
    material.write_text("name = 'mine'\n")
    assert "another name" in cli(words).line
    assert material.read_text() == "name = 'mine'\n"
    assert ".toml" in cli([*words, "-o", "x.txt"]).line
    for mine in (strips.with_name("dome.json"), strips.with_name("photo.png")):
        mine.write_text("mine")
        refusal = cli([*words, "-o", str(mine.with_suffix(".toml"))]).refusal
        assert mine.name in refusal and "another name" in refusal
        assert mine.read_text() == "mine" and not mine.with_suffix(".toml").exists()


def test_mistakes_leave_nothing(strips: Path, cli: Cli) -> None:
    strips.write_text(strips.read_text().replace("60,", "60mm,", 1))
    assert "row 2, column length_mm" in cli(["strips", "fit", str(strips)]).refusal
    strips.write_text(
        "strip,thickness_mm,length_mm,stretch,fabric_thickness_mm,box_width_mm,box_height_mm\n1,.4,60,1.3,1,,flat"
    )
    done = cli(["strips", "fit", str(strips), "--kappa-bar", "zero"])
    assert done.status == 1 and "looks flat" in done.line
    assert [file.name for file in strips.parent.iterdir()] == ["strips.csv"]


def test_the_options_fill_a_table_without_these_columns(tmp_path: Path, cli: Cli) -> None:
    """Empty columns count as no columns."""
    rows = [(0.3, 0.031), (0.3, 0.030), (0.4, 0.018), (0.4, 0.017)]
    for empty_columns, cells in (("", ""), ("stretch,fabric_thickness_mm,", ",,")):
        lines = [f"strip,thickness_mm,length_mm,{empty_columns}curvature_per_mm,peeled_curvature_per_mm"]
        lines += [f"{number},{h},60,{cells}{k},{k / 100}" for number, (h, k) in enumerate(rows)]
        (tmp_path / "strips.csv").write_text("\n".join(lines))
        words = ["strips", "fit", str(tmp_path / "strips.csv"), "--stretch", "1.35", "--fabric-thickness", "0.8"]
        assert cli(words).done


def test_thicknesses_that_are_nearly_one_stay_apart(tmp_path: Path) -> None:
    near = [replace(r, thickness_mm=0.300001) if r.thickness_mm == 0.35 else r for r in synthetic_readings(0)]
    settings = StripFitSettings(kappa_bar="per-thickness")
    write_material(fit_strips(table(near, tmp_path / "near.csv"), settings), tmp_path / "near.toml")
    text = tomllib.loads((tmp_path / "near.toml").read_text())
    assert text["plastic"]["kappa_bar_per_mm"]["thickness_mm"][:2] == [0.3, 0.300001]


PLAIN = {"stars": {"length_mm": 8}, "border": {"rings": 1}}


def test_a_material_takes_the_place_of_the_designs_own(tmp_path: Path) -> None:
    design = Design.from_dict({"fabric": {"stretch": 1.5, "poisson": 0.2}} | PLAIN)
    file = tmp_path / "material.toml"
    file.write_text(
        "[fabric]\nstretch = 1.35\nthickness_mm = 0.7\n[plastic]\nmodulus_ratio = 1500.0\nkappa_bar_per_mm = 0.002\n"
    )
    found = with_material(design, file)
    assert (found.fabric.stretch, found.fabric.poisson, found.fabric.thickness_mm) == (1.5, 0.2, 0.7)
    assert (found.plastic.modulus_ratio, found.plastic.kappa_bar_per_mm) == (1500.0, 0.002)
    assert found.stars == design.stars and found.spread is None
    assert with_material(design, None) is design
    file.write_text("[plastic]\nmodulus_ratio = 0.5\n")
    with pytest.raises(DesignError, match=r"material\.toml: plastic\.modulus_ratio"):
        with_material(design, file)


def test_what_a_material_does_not_change_is_said(tmp_path: Path) -> None:
    file = tmp_path / "m.toml"

    def with_notes(text: str, **design: Any) -> tuple[Design, list[str]]:
        notes: list[str] = []
        file.write_text(text)
        found = with_material(Design.from_dict(PLAIN | design), file, notes.append)
        return found, [note.removeprefix(f"{file}: ") for note in notes]

    found, notes = with_notes("[spread]\nmodulus_ratio_factor = 1.05\n")
    assert found.spread == Spread(modulus_ratio_factor=1.05) and notes == []
    # the stretch of a material is taken where the design gives none
    found, notes = with_notes("[fabric]\nstretch = 1.5\n")
    assert found.fabric.stretch == 1.5 and notes == []
    found, notes = with_notes("[fabric]\nstretch = 1.5\n", fabric={"stretch": 1.35})
    assert found.fabric.stretch == 1.35 and notes == [
        "its fabric and plastic are those of the design: --material changes nothing",
        "it was measured at a stretch of 1.5; the stretch of the design is used, 1.35",
    ]
    # the plan of the paper's cells does not fit this lattice, but only calibrate needs a plan
    found, notes = with_notes("[plastic]\nmodulus_ratio = 3000.0\n[lattice]\nspacing_mm = 8.0\n")
    assert found.lattice == Design.from_dict(PLAIN).lattice
    assert notes == ["its lattice is not used, but that of the design (spacings 8 mm, 17.32 mm)"]
    with pytest.raises(DesignError, match=r"lattice\.spacing_mm = 8.0: needs a \[plan\] of its own"):
        load_material(file)
    with pytest.raises(DesignError, match=r"m\.toml: has no value in \[fabric\], \[plastic\] or \[spread\]"):
        with_notes('name = "empty"\n')
