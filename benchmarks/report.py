"""What benchmarks write: Markdown tables in benchmarks/results."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any, TypeVar

from asterism.process.version import __version__
from asterism.results.files import write_file

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "benchmarks" / "results"
PICTURES = ROOT / "docs" / "pictures"

T = TypeVar("T")


def write_report(name: str, text: str, command: str | None = None) -> None:
    """Write NAME.md with the command that made it: by default the module of that name."""
    command = command or f"python -m benchmarks.{name}"
    write_file(RESULTS / f"{name}.md", f"Made by `{command}`, asterism {__version__}.\n\n{text}\n")


def in_new_process(work: Callable[..., T], *arguments: Any) -> T:
    """The value of a function of a module, from a process whose memory is its own."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        return pool.submit(work, *arguments).result()


def markdown(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table; numbers are formatted by the caller."""
    lines = [header, ["---"] + ["---:"] * (len(header) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def number(value: float | None, form: str = ".2f") -> str:
    """A number, or a dash."""
    return "-" if value is None else format(value, form)


def chosen(parser: argparse.ArgumentParser, names: Sequence[str], known: Mapping[str, T]) -> list[T]:
    """Those of the given names, or all; exit status 2 with one line for a name that is not known."""
    for name in names:
        if name not in known:
            parser.error(f"NAME: {name!r} is none of {', '.join(known)}")
    return [known[name] for name in names or known]
