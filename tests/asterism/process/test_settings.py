"""A settings object: its fields are options of a command, and say in one line what they allow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

import pytest
import typer

from asterism.cli.command import Run, command
from asterism.pattern.design.errors import DesignError
from asterism.process.settings import check_settings


@dataclass(frozen=True, kw_only=True)
class CutSettings:
    """How something is cut.

    Attributes
    ----------
    sheet_mm : width and depth.
    depth_mm : depth of a cut.
    passes : depths of the cuts before it.
    blade : kind of
        blade.
    teeth : number of its teeth.
    is_wet : cool with water.
    """

    sheet_mm: Annotated[tuple[float, float] | None, "--sheet"] = None
    depth_mm: Annotated[float, "--depth", (0.5, 2.0)] = 1.0
    passes: Annotated[tuple[float, ...], "--pass"] = ()
    blade: Literal["saw", "knife"] = "saw"
    teeth: int | None = None
    is_wet: bool = False

    def __post_init__(self) -> None:
        check_settings(self)


def cut(*words: str) -> CutSettings:
    """The settings with which a command runs."""
    found = []

    @command
    def function(run: Run, *, settings: CutSettings) -> None:
        found.append(settings)

    app = typer.Typer()
    app.command()(function)
    app(args=list(words), standalone_mode=False)
    return found[0]


def test_fields_are_options_and_sizes_are_read() -> None:
    assert cut() == CutSettings()
    words = ["--sheet", "300x250", "--depth", "2", "--pass", "0.5", "--pass", "1", "--blade", "knife", "--is-wet"]
    assert cut(*words) == CutSettings(
        sheet_mm=(300.0, 250.0), depth_mm=2.0, passes=(0.5, 1.0), blade="knife", is_wet=True
    )
    assert cut("--sheet", "80").sheet_mm == (80.0, 80.0)
    with pytest.raises(typer.BadParameter, match="must be width x depth, such as 300x250, not '3x'"):
        cut("--sheet", "3x")


@pytest.mark.parametrize(
    ("wrong", "line"),
    [
        ({"depth_mm": 3.0}, "--depth = 3.0: must be from 0.5 to 2"),
        ({"depth_mm": float("nan")}, "--depth = nan: must be from 0.5 to 2"),
        ({"depth_mm": "1"}, "--depth = '1': must be from 0.5 to 2"),
        ({"blade": "laser"}, "--blade = 'laser': must be saw or knife"),
        ({"passes": 0.5}, "--pass = 0.5: must be a tuple"),
        ({"sheet_mm": 300.0}, "--sheet = 300.0: must be a tuple"),
        ({"teeth": 2.5}, "--teeth = 2.5: must be a whole number"),
    ],
)
def test_python_and_the_command_name_the_option(wrong: dict[str, Any], line: str) -> None:
    with pytest.raises(DesignError) as caught:
        CutSettings(**wrong)
    assert str(caught.value) == line
