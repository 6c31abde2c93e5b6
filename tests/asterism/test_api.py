"""`import asterism`: its names, and what it says of arguments that are no designs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import asterism
from asterism.pattern import gallery


def test_the_public_names_are_listed() -> None:
    assert set(asterism.__all__) <= set(dir(asterism))
    for name in asterism.__all__:
        assert getattr(asterism, name) is not None
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


def test_what_is_no_law_no_side_and_no_number_of_starts_is_refused() -> None:
    design = gallery.load("dome")
    with pytest.raises(TypeError, match=r"Law is needed, not str.*load_law"):
        asterism.preview(design, law="law.npz")  # type: ignore[arg-type]
    assert asterism.preview(design, law=asterism.load_law()).summary["is_minimum"]
    with pytest.raises(ValueError, match=r"side = 'sideways': must be auto, up, down"):
        asterism.preview(design, side="sideways")  # type: ignore[arg-type]
    for wrong in (0, 1.5):
        with pytest.raises(ValueError, match=rf"triangles = {wrong}: must be a whole number, at least 1"):
            asterism.Preview(design, triangles=wrong)  # type: ignore[arg-type]
        with pytest.raises(ValueError, match=rf"starts = {wrong}: must be a whole number, at least 1"):
            asterism.simulate(design, starts=wrong)  # type: ignore[arg-type]
