"""The registry of export formats. A format is one module of this folder with a decorated function."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, Literal, TypeVar

from asterism.equilibrium.registries import load_all
from asterism.pattern.design.errors import DesignError

FormatKind = Literal["solid", "print", "drawing", "pages", "table", "script", "shape", "model"]
Writer = TypeVar("Writer", bound=Callable[..., None])


@dataclass(frozen=True)
class ExportFormat:
    """A file format."""

    name: str  # name in messages
    suffix: str  # end of its file names, with the point
    # content of a file: one `solid`, all solids of a `print`, one `drawing`, drawings as `pages`, the needles as a
    # `table`, stars and rods as a `script`, the sheet in space as a `shape`, or both as a `model`, which is written on
    # demand
    kind: FormatKind
    write: Callable[..., None]  # function that writes one file
    package: str = ""  # optional package that writes it; empty if it needs none
    hint: str = ""  # how to install that package

    @property
    def problem(self) -> str:
        """Why the format cannot be written here; empty if it can."""
        try:
            import_module(self.package or "asterism")
        except ImportError:
            return self.hint
        return ""


_FORMATS: list[ExportFormat] = []


def export_format(
    name: str, suffix: str, kind: FormatKind, package: str = "", hint: str = ""
) -> Callable[[Writer], Writer]:
    """Register the decorated function as the writer of a format.

    The function takes the path, and by its kind: a `Solid`; solids, a title and a `Rounding` (print); a `Drawing`;
    drawings (pages); needles (table); a `Job` (script, model); or a `Shape` and the design's name.
    """

    def register(write: Writer) -> Writer:
        _FORMATS.append(ExportFormat(name, suffix, kind, write, package, hint))
        return write

    return register


def export_formats(kind: FormatKind, with_missing: bool = False) -> list[ExportFormat]:
    """The registered formats of a kind, by their suffixes, and those `with_missing` packages too if they are wanted.

    >>> [each.suffix for each in export_formats("shape")]
    ['.glb', '.obj', '.stl']
    """
    known = sorted((each for each in _all_formats() if each.kind == kind), key=lambda each: each.suffix)
    return [each for each in known if with_missing or not each.problem]


def formats_left_out() -> list[str]:
    """What is missing for a format that every export writes, one line for each."""
    missing = (each for each in _all_formats() if each.kind != "model" and each.problem)
    return [f"no {each.name} is written: {each.problem}" for each in missing]


def _all_formats() -> list[ExportFormat]:
    load_all(__package__)
    return _FORMATS


def write_all(kind: FormatKind, folder: Path, stem: str, *content: Any) -> None:
    """Write one file in each format of a kind."""
    for each in export_formats(kind):
        each.write(folder / f"{stem}{each.suffix}", *content)


def demanded_formats(names: Sequence[str]) -> list[ExportFormat]:
    """The formats of the kind `model` with these names, such as `3dm`, in any case; DesignError for another name."""
    known = {each.name.lower(): each for each in export_formats("model", with_missing=True)}
    for name in names:
        if name.lower() not in known:
            raise DesignError("--format", f"must be {' or '.join(known)}; all other formats are always written", name)
        if problem := known[name.lower()].problem:
            raise DesignError("--format", problem, name.lower())
    return [known[name] for name in dict.fromkeys(map(str.lower, names))]
