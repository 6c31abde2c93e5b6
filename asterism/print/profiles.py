"""Profiles of printers and plastics: files of the package and of the user, with the values of options."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from asterism.pattern.design.errors import DesignError, from_validation
from asterism.pattern.design.files import own_folders, read_table
from asterism.pattern.design.section import Section
from asterism.print.printer import PlasticProfile, Printer

_PACKAGE_FOLDER = Path(__file__).parent / "data"
_Kind = TypeVar("_Kind", bound=Section)


def profile_folders() -> list[Path]:
    """Folders of profiles in the order of the search: of `ASTERISM_PROFILES`, of the user, of the package."""
    return [*own_folders(), _PACKAGE_FOLDER]


def profile_names(kind: str) -> list[str]:
    """Names of all profiles of a kind: `printers` or `plastics`."""
    return sorted({path.stem for path in _files(kind)})


def load_printer(printer: str | Printer) -> Printer:
    """The profile of a printer.

    Parameters
    ----------
    printer : name of a profile, path of a `.toml` or `.json` file, or the profile itself.

    Raises
    ------
    DesignError
        No profile has the name, or the file is wrong; the message names the field, its value and the range.
    """
    return _load("printers", printer, Printer)


def load_plastic(plastic: str | PlasticProfile) -> PlasticProfile:
    """The profile of a plastic; parameter and errors as of `load_printer`."""
    return _load("plastics", plastic, PlasticProfile)


def _load(kind: str, name_or_file: str | _Kind, section: type[_Kind]) -> _Kind:
    if not isinstance(name_or_file, str):
        return name_or_file
    path = Path(name_or_file)
    if path.suffix.lower() not in (".toml", ".json"):
        files = [file for file in _files(kind) if file.stem == name_or_file]
        if not files:
            option = f"--{kind[:-1]}"
            raise DesignError(
                option, f"must be a file (.toml) or a name: {', '.join(profile_names(kind))}", name_or_file
            )
        path = files[0]
    try:
        return section.model_validate(read_table(path))
    except ValidationError as error:
        raise from_validation(error, path) from None


def _files(kind: str) -> Iterator[Path]:
    for folder in profile_folders():
        yield from sorted((folder / kind).glob("*.toml"))


def adjusted_printer(
    machine: Printer,
    first_layer: float | None = None,
    layer: float | None = None,
    plate: float | None = None,
    frame: Sequence[float] | None = None,
) -> Printer:
    """The printer with other layer heights (mm), another thickness of the plate (mm) and another frame (2,) mm.

    Values that are not given stay.

    Raises
    ------
    DesignError
        An option is out of range.
    """
    data = machine.model_dump(mode="json")
    data["first_layers_mm"] = data["first_layers_mm"] if first_layer is None else [first_layer]
    data["layer_mm"] = data["layer_mm"] if layer is None else layer
    data["frame"]["plate_mm"] = data["frame"]["plate_mm"] if plate is None else plate
    data["frame"]["size_mm"] = data["frame"]["size_mm"] if frame is None else list(frame)
    options = {"first_layers_mm[0]": "--first-layer", "layer_mm": "--layer", "frame.plate_mm": "--plate"}
    options |= {f"frame.{name}": "--frame" for name in ("size_mm", "bar_mm")}
    try:
        return Printer.model_validate(data)
    except ValidationError as error:
        wrong = from_validation(error)
        raise DesignError(options.get(wrong.field, wrong.field), wrong.allowed, wrong.value) from None
