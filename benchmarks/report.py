"""What all benchmarks write: numbers as JSON, and the same as a Markdown table."""

from __future__ import annotations

import json
import os
import platform
import resource
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from asterism.process.version import __version__
from asterism.results.files import staged

RESULTS = Path(__file__).parent / "results"


def machine() -> dict[str, Any]:
    """What the numbers were measured on, without its name."""
    return {"cores": os.cpu_count(), "machine": platform.machine(), "python": platform.python_version()}


def peak_memory_mb() -> float:
    """Largest memory of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def write_report(
    name: str, rows: Sequence[dict[str, Any]], table: str, folder: Path = RESULTS, command: str | None = None
) -> None:
    """Write NAME.json and NAME.md, both or none, each saying what made it: by default the module of that name."""
    command = command or f"python -m benchmarks.{name}"
    content = {"command": command, "version": __version__, "machine": machine(), "rows": rows}
    text = f"Made by `{command}`, asterism {__version__}.\n\n{table}\n"
    with staged(folder) as here:
        (here / f"{name}.json").write_bytes((json.dumps(content, indent=1) + "\n").encode())
        (here / f"{name}.md").write_bytes(text.encode())


def markdown(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table; numbers are formatted by the caller."""
    lines = [header, ["---"] + ["---:"] * (len(header) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
