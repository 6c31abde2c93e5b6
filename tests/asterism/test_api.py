"""`import asterism`: its names, and what it says of arguments that are no designs."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import asterism
from asterism import FitSettings, solve_for_point
from asterism.pattern import gallery
from asterism.process.settings import SettingError


def test_the_public_names_are_listed() -> None:
    assert set(asterism.__all__) <= set(dir(asterism))
    for name in asterism.__all__:
        assert getattr(asterism, name) is not None
    # type checkers read the imports, programs the table: they name the same things
    blocks = [part for part in ast.parse(Path(asterism.__file__).read_text()).body if isinstance(part, ast.If)]
    imports = [line for line in ast.walk(blocks[-1]) if isinstance(line, ast.ImportFrom)]
    read = {each.asname or each.name: f"{line.module}:{each.name}" for line in imports for each in line.names}
    assert read == asterism._HOMES  # type: ignore[attr-defined]
    # and looking at the list loads none of the solver
    program = "import asterism, sys; dir(asterism); assert 'asterism.exact.simulation' not in sys.modules"
    assert subprocess.run([sys.executable, "-c", program], cwd=Path(__file__).parents[2]).returncode == 0


@pytest.mark.parametrize("name", ["preview", "simulate", "verify", "Preview"])
def test_what_is_no_design_is_refused_in_one_line(name: str) -> None:
    for given in ("dome.toml", {"stars": {}}, None):
        with pytest.raises(TypeError, match=rf"Design is needed, not {type(given).__name__}.*load_design") as caught:
            getattr(asterism, name)(given)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "needed"), [("save_design", "Design"), ("write_results", "Shape"), ("write_verification", "Verification")]
)
def test_writers_refuse_what_is_something_else(name: str, needed: str, tmp_path: Path) -> None:
    with pytest.raises(TypeError, match=f"a {needed} is needed, not str: "):
        getattr(asterism, name)("dome", tmp_path / "out.toml")
    assert not list(tmp_path.iterdir())


def test_a_design_in_a_missing_folder_is_named_as_it_was_asked_for(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        asterism.save_design(gallery.load("dome"), tmp_path / "none" / "dome.toml")
    assert caught.value.filename == str(tmp_path / "none" / "dome.toml")


def test_an_edit_to_no_design_leaves_the_preview() -> None:
    design = gallery.load("dome")
    preview = asterism.Preview(design)
    with pytest.raises(TypeError, match="load_design"):
        list(preview.edit("dome.toml"))  # type: ignore[arg-type]
    assert preview.design == design and preview.equilibrium.is_minimum


DOME = asterism.new("dome")
CAP = asterism.TargetSurface.of_formula("9 - (r/20)**2", 100.0)
NEEDLES = {"points_mm": [[43.0, 24.8], [-43.0, -24.8]], "target_mm": [[31.0, 18.0, 0.0], [-31.0, -18.0, 0.0]]}
CANOPY = asterism.Design.from_dict({"stars": {"length_mm": 7.0}, "border": {"rings": 2}, "pins": [NEEDLES]})
MIDDLE, UP = (0.0, 0.0), (0.0, 0.0, 18.0)
WHOLE = r"must be a whole number, at least 1"


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: asterism.preview(DOME, law="law.npz"), TypeError, r"Law is needed, not str.*load_law"),
        (lambda: asterism.preview(DOME, side="sideways"), ValueError, r"side = 'sideways': must be auto, up, down"),
        (lambda: asterism.Preview(DOME, triangles=0), ValueError, f"triangles = 0: {WHOLE}"),
        (lambda: asterism.Preview(DOME, triangles=1.5), ValueError, f"triangles = 1.5: {WHOLE}"),
        (lambda: asterism.simulate(DOME, starts=0), ValueError, f"starts = 0: {WHOLE}"),
        (lambda: asterism.simulate(DOME, starts=1.5), ValueError, f"starts = 1.5: {WHOLE}"),
        (lambda: asterism.fit("cap.obj"), TypeError, "TargetSurface is needed, not str"),
        (lambda: asterism.fit(CAP, {"needles": 8}), TypeError, "a FitSettings is needed"),
        (lambda: FitSettings(needles=1), SettingError, "needles = 1"),
        (lambda: FitSettings(needles=2), SettingError, "needles = 2"),
        (lambda: FitSettings(needles=-1), SettingError, "needles = -1"),
        (lambda: FitSettings(needles=2.5), SettingError, r"needles = 2\.5"),
        (lambda: FitSettings(needles=1001), SettingError, "needles = 1001"),
        (
            lambda: FitSettings(needles=8, border=True),
            SettingError,
            "needles = 8: conflicts with border = True",
        ),
        (lambda: FitSettings(corrections=-1), SettingError, "corrections = -1: must be a whole number from 0 to 20"),
        (lambda: FitSettings(width_mm=-1.0), SettingError, r"width_mm = -1\.0: must be a positive number"),
        (lambda: asterism.solve_for("dome.toml", "height_mm", 3.0), TypeError, "Design is needed"),
        (lambda: asterism.solve_for(DOME, "depth", 3.0), ValueError, "wanted = 'depth'"),
        (lambda: asterism.solve_for(DOME, "height_mm", -1), ValueError, "value = -1"),
        (lambda: asterism.solve_for(DOME, "height_mm", 3.0, "stretch"), ValueError, "change = 'stretch'"),
        (lambda: solve_for_point({}, MIDDLE, UP), TypeError, "Design is needed"),
        (lambda: solve_for_point(CANOPY, MIDDLE, UP, 2), ValueError, "needle = 2: must be a whole number from 0 to 1"),
        (lambda: solve_for_point(CANOPY, (300.0, 0.0), UP), ValueError, "at_mm = .*: must be on the sheet"),
        (
            lambda: solve_for_point(CANOPY, MIDDLE, (0.0, 18.0)),
            ValueError,
            "point_mm = .*: must be 3 numbers of mm",
        ),
        (
            lambda: solve_for_point(CANOPY, "centre", UP),
            ValueError,
            "at_mm = 'centre': must be 2 numbers of mm",
        ),
        (lambda: solve_for_point(DOME, MIDDLE, UP), ValueError, "needles with target_mm are needed"),
        (lambda: asterism.sensitivity(DOME, of="weight"), ValueError, "must be .*height_mm"),
        (lambda: asterism.sensitivity(DOME, by="depth_mm"), ValueError, "must be .*length_mm"),
    ],
)
def test_wrong_arguments_are_refused_in_one_line(
    call: Callable[[], object], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)
