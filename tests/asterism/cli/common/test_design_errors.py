"""Errors about a design name its file, also those that a later step of a command raises."""

from __future__ import annotations

from pathlib import Path

import pytest

from asterism.cli.common.design_errors import with_design_file
from asterism.equilibrium.errors import Error
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.pattern.design.errors import DesignError
from tests.asterism.commands import command

FILE = Path("leaf.toml")
DRAWN = "[rods]\n[[rods.draw]]\nline_mm = [[-20, 0], [20, 0]]\n[border]\nrectangle_mm = [60, 60]\n"


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (DesignError("border.holes", "must be empty"), "leaf.toml: border.holes: must be empty"),
        (
            DesignError("pins[2].points_mm", "must be on the sheet"),
            "leaf.toml: pins[2].points_mm: must be on the sheet",
        ),
        (DesignError("--output", "holds other results"), "--output: holds other results"),
        (LawError("fabric.bending: has no law", field="fabric.bending"), "leaf.toml: fabric.bending: has no law"),
        (ForeignLaw("net.npz: is of stars", field="rods.motif"), "net.npz: is of stars"),
        (Error("no cluster answers"), "no cluster answers"),
    ],
)
def test_the_file_stands_before_fields_of_the_design(error: Error, message: str) -> None:
    named = with_design_file(error, FILE)
    assert str(named) == message and type(named) is type(error)


@pytest.mark.parametrize("words", [["preview"], ["verify"], ["export", "--preview"]])
def test_drawings_without_a_preview_are_refused_with_their_file(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    FILE.write_text(DRAWN)
    refused = command([*words, str(FILE), "-q"], capsys, monkeypatch)
    assert refused.status == 2 and list(tmp_path.iterdir()) == [tmp_path / FILE]
    assert refused.err.splitlines()[-1] == (
        "asterism: leaf.toml: rods.motif: is missing: lines that do not repeat have no law; use the exact model: "
        "asterism simulate"
    )
