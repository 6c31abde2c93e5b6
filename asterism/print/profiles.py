"""Printers and plastics as data files: those that come along, and the user's own."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import TypeVar

import typer
from pydantic import ValidationError

from asterism.print.plastic_profile import PlasticProfile
from asterism.print.printer import Printer
from pattern.design.errors import DesignError, from_validation
from pattern.design.files import read_table
from pattern.design.section import Section

# a folder of the user's with printers/ and plastics/ in it
PROFILES_VARIABLE = "ASTERISM_PROFILES"
_OURS = Path(__file__).parent / "data"
_Kind = TypeVar("_Kind", bound=Section)


def profile_folders() -> list[Path]:
    """Where profiles are looked for; the first that has a name wins."""
    own = [Path(os.environ[PROFILES_VARIABLE])] if os.environ.get(PROFILES_VARIABLE) else []
    return [*own, Path(typer.get_app_dir("asterism")), _OURS]


def profile_names(kind: str) -> list[str]:
    """Names of the `printers` or `plastics` that are found."""
    return sorted({path.stem for path in _files(kind)})


def load_printer(name_or_file: str) -> Printer:
    """A printer by its name, or from a `.toml` or `.json` file; `DesignError` names what is wrong."""
    return _load("printers", name_or_file, Printer)


def load_plastic(name_or_file: str) -> PlasticProfile:
    """A plastic by its name, or from a file, likewise."""
    return _load("plastics", name_or_file, PlasticProfile)


def _load(kind: str, name_or_file: str, section: type[_Kind]) -> _Kind:
    path = Path(name_or_file)
    if path.suffix.lower() not in (".toml", ".json"):
        found = [file for file in _files(kind) if file.stem == name_or_file]
        if not found:
            option = f"--{kind[:-1]}"
            raise DesignError(
                option, f"must be a file (.toml), or one of {', '.join(profile_names(kind))}", name_or_file
            )
        path = found[0]
    try:
        return section.model_validate(read_table(path))
    except ValidationError as error:
        raise from_validation(error, path) from None


def _files(kind: str) -> Iterator[Path]:
    for folder in profile_folders():
        yield from sorted((folder / kind).glob("*.toml"))
