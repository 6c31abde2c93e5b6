"""`asterism preview`: the command that checks it."""

from __future__ import annotations

from pathlib import Path

from asterism.cli.preview import _check_command


def test_the_check_has_the_law_and_the_material_of_the_preview() -> None:
    made = _check_command(Path("my dome.toml"), Path("own.npz"), Path("knit.toml"))
    assert made == "asterism verify 'my dome.toml' --law own.npz --material knit.toml"
