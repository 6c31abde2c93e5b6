"""`asterism printers`: the available printers and plastics."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from asterism.cli.common.run import DONE, WRONG_INPUT, Run, command


@command
def printers(run: Run) -> int:
    """List printers and plastics, and the folders of your own profiles.

    The exit status is 2 if one of your files is wrong; the list contains the others.
    """
    from asterism.pattern.design.errors import DesignError
    from asterism.pattern.design.files import PROFILES_VARIABLE, own_folders
    from asterism.print.profiles import load_plastic, load_printer, profile_names

    kinds: dict[str, Callable[[str], str]] = {
        "printers": lambda name: _of_printer(load_printer(name)),
        "plastics": lambda name: load_plastic(name).name,
    }
    wrong = []
    for kind, describe in kinds.items():
        for name in profile_names(kind):
            try:
                run.table({name: describe(name)}, width=14)
            except DesignError as error:
                wrong.append(" ".join(str(error).split()))
    own = " or ".join(map(str, own_folders()))
    run.lines([f"yours: printers/NAME.toml and plastics/NAME.toml in {own} ({PROFILES_VARIABLE})"])
    run.lines(
        [
            "their start codes are not complete: they set the height of the fabric, and leave temperatures, homing, "
            "purging and the end to your slicer"
        ]
    )
    run.warn(*wrong)
    return WRONG_INPUT if wrong else DONE


def _of_printer(machine: Any) -> str:
    width, depth = machine.bed_mm
    layers = " or ".join(f"{height:g}" for height in machine.first_layers_mm)
    return f"{machine.name}: {width:g} x {depth:g} mm, layers {layers} + n {machine.layer_mm:g} mm"
