"""Profiles of printers and plastics: files of the package and of the user."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from asterism.pattern.design.errors import DesignError, from_validation
from asterism.pattern.design.files import read_table
from asterism.pattern.design.section import Section
from asterism.pattern.design.user_files import own_folders
from asterism.print.plastic_profile import PlasticProfile
from asterism.print.printer import Printer

_PACKAGE_FOLDER = Path(__file__).parent / "data"
_Kind = TypeVar("_Kind", bound=Section)


def profile_folders() -> list[Path]:
    """Folders of profiles in the order of the search: of `ASTERISM_PROFILES`, of the user, of the package."""
    return [*own_folders(), _PACKAGE_FOLDER]


def profile_names(kind: str) -> list[str]:
    """Names of all profiles of a kind: `printers` or `plastics`."""
    return sorted({path.stem for path in _files(kind)})


def load_printer(name_or_file: str) -> Printer:
    """The profile of a printer.

    Parameters
    ----------
    name_or_file : name of a profile, or path of a `.toml` or `.json` file.

    Raises
    ------
    DesignError
        No profile has the name, or the file is wrong; the message names the field, its value and the range.
    """
    return _load("printers", name_or_file, Printer)


def load_plastic(name_or_file: str) -> PlasticProfile:
    """The profile of a plastic; parameter and errors as of `load_printer`."""
    return _load("plastics", name_or_file, PlasticProfile)


def _load(kind: str, name_or_file: str, section: type[_Kind]) -> _Kind:
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
