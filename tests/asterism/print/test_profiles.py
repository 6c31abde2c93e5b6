"""Profiles of printers and plastics: files of the package and of the user, and their list."""

from __future__ import annotations

from pathlib import Path

import pytest
import typer

from asterism.pattern.design import files as user_files
from asterism.pattern.design.errors import DesignError
from asterism.print import printer as profiles
from asterism.print.printer import NOT_COMPLETE
from asterism.studio import page_data
from tests.asterism.print.jobs import Run

OWN = """
name = "My machine"
bed_mm = [120, 100.0]
origin = "centre"
first_layers_mm = [0.25]
layer_mm = 0.15
homes = "away"
start_code = "G92 Z{above_fabric_mm} ; {z_offset_mm}"
[speed]
first_layer_mm_s = 10.0
print_mm_s = 20.0
travel_mm_s = 100.0
island_s = 1.0
heating_min = 2.0
"""


@pytest.mark.parametrize("name", ["ultimaker2", "prusa-mk4", "ender-3"])
def test_every_printer_starts_on_the_fabric(name: str) -> None:
    printer = profiles.load_printer(name)
    code = printer.start_snippet(4.8)
    assert "{" not in code and code.endswith("\n")
    # whatever z the machine has, it is 10 mm above the fabric when z is set to 10
    remark, *rest = code.splitlines()
    assert remark == NOT_COMPLETE and remark.startswith(";")
    lines = [line.split(";")[0].split() for line in rest]
    assert ["G90"] in lines
    move, setting = [line for line in lines if line != ["G90"]]
    assert move[:2] == ["G1", "Z14.80"] and setting == ["G92", "Z10.00"]


@pytest.mark.parametrize("variable", ["HOME", "XDG_CONFIG_HOME"])
def test_the_folder_of_the_user_is_that_of_command_line_programs(
    variable: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.undo()
    monkeypatch.setenv(variable, str(tmp_path))
    assert user_files.user_folder() == Path(typer.get_app_dir("asterism"))


def test_own_files_by_path_by_folder_and_by_home(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(OWN)
    assert profiles.load_printer(str(tmp_path / "mine.toml")).bed_centre_mm == (0.0, 0.0)
    home = tmp_path / "home" / "printers"
    home.mkdir(parents=True)
    (home / "mine.toml").write_text(OWN)
    assert profiles.load_printer("mine").name == "My machine"
    other = tmp_path / "lab" / "printers"
    other.mkdir(parents=True)
    (other / "mine.toml").write_text(OWN.replace("My machine", "The lab's"))
    (other / "ultimaker2.toml").write_text(OWN.replace("My machine", "Our Ultimaker"))
    monkeypatch.setenv(user_files.PROFILES_VARIABLE, str(tmp_path / "lab"))
    # the folder of the variable comes first, also before what comes along
    assert profiles.load_printer("mine").name == "The lab's"
    assert profiles.load_printer("ultimaker2").name == "Our Ultimaker"
    assert "mine" in profiles.profile_names("printers")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("bed_mm = [120, 100.0]", "bed_mm = [120, -1]"), r"bed_mm = \(120.0, -1.0\): must be two sides"),
        (("layer_mm = 0.15", "layer = 0.15"), "layer = 0.15: unknown key, did you mean layer_mm"),
        (("{z_offset_mm}", "{offset}"), r"start_code = '\{offset\}': may have z_offset_mm, above_bed_mm"),
        (("{z_offset_mm}", "{z_offset_mm} {}"), "in braces"),
        (("{z_offset_mm}", ""), r"start_code: must use \{z_offset_mm\} or \{above_bed_mm\}"),
        (('homes = "away"', ""), "homes: is missing"),
        (('name = "My machine"', 'name = "My\\u0001machine"'), "name = .*: must be one line of printable characters"),
        (("island_s = 1.0", "island_s = true"), "speed.island_s = True: must be a number"),
        (("[speed]", "[speed"), "is not TOML"),
        (("[speed]", "[frame]\nbar_mm = 128\n[speed]"), r"bar_mm = 128.0: must be at most 127.5 in a frame of 260"),
    ],
)
def test_a_mistake_is_one_line_with_file_and_field(change: tuple[str, str], message: str, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(OWN.replace(*change))
    with pytest.raises(DesignError, match=message) as caught:
        profiles.load_printer(str(tmp_path / "mine.toml"))
    assert str(caught.value).startswith(str(tmp_path / "mine.toml")) and "\n" not in str(caught.value)


def test_a_density_in_other_units_is_refused(tmp_path: Path) -> None:
    (tmp_path / "p.toml").write_text('name = "x"\ndensity_kg_m3 = 1.22\n')
    with pytest.raises(DesignError, match=r"p.toml: density_kg_m3 = 1.22: must be 0, or from 25 to .* in g/cm3"):
        profiles.load_plastic(str(tmp_path / "p.toml"))


def test_an_unknown_name_lists_what_there_is() -> None:
    with pytest.raises(DesignError, match=r"--printer = 'ulti': must be a file.*ender-3, prusa-mk4, ultimaker2"):
        profiles.load_printer("ulti")
    with pytest.raises(DesignError, match=r"--plastic = 'wood': must be a file.*pla, tpu95a"):
        profiles.load_plastic("wood")


def test_a_broken_file_of_ones_own_does_not_hide_the_others(
    tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    assert run("printers").status == 0
    monkeypatch.setenv("ASTERISM_PROFILES", str(tmp_path))
    for kind in ("printers", "plastics"):
        (tmp_path / kind).mkdir()
        (tmp_path / kind / "broken.toml").write_text('name = "x"\nwrong = 1\n')
    result = run("printers")
    assert result.status == 2
    assert all(name in result.out for name in ("ender-3", "ultimaker2", "tpu95a", "ASTERISM_PROFILES"))
    assert "  broken" not in result.out
    lines = result.err.splitlines()
    assert len(lines) == 2
    for kind, line in zip(("printers", "plastics"), lines, strict=True):
        assert line.startswith(f"asterism: {tmp_path / kind / 'broken.toml'}: wrong = 1: unknown key")
    for entries in (page_data.printer_entries, page_data.plastic_entries):
        assert len(entries.__wrapped__()) >= 2
    assert all(str(tmp_path / kind / "broken.toml") in caplog.text for kind in ("printers", "plastics"))
