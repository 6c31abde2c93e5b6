"""Where the time of `asterism verify` as typed goes, from its first import to the written report.

python -m benchmarks.profile_verify [DESIGN]

Each command runs in a process of its own, the first time so that later runs find its compiled loops. A row has the
seconds by the clock, those of the processor in all threads, and those of the processor in the thread that the user
waits for. On a busy machine the last ones change least.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path

from benchmarks.report import markdown

# lines that the command says at the start of its parts
PARTS = {
    "preview": "preview, twice",
    "exact model, released from the flat print": "exact model, from the flat print",
    "exact model, started from the preview": "exact model, from the preview",
    "comparing": "comparison",
    "writing the report": "report",
}
HEADER = ["part", "s by the clock", "processor, s", "waited for, s"]
RUNS = 3


def clocks() -> list[float]:
    """Seconds by the clock, of the processor in all threads, and of the processor in this one."""
    return [time.perf_counter(), time.process_time(), time.thread_time()]


def one_run(design: str, folder: str) -> None:
    """Run the command here, and print its marks as JSON on the last line."""
    from asterism.cli.common.run import Run
    from asterism.cli.main import main

    marks = [("libraries and law", [clocks()[0], 0.0, 0.0])]
    said = Run.say

    def marked(run: Run, text: str) -> None:
        if text in PARTS:
            marks.append((PARTS[text], clocks()))
        said(run, text)

    Run.say = marked  # type: ignore[method-assign]
    sys.argv = ["asterism", "verify", design, "-o", folder]
    try:
        main()
    except SystemExit as end:
        if end.code:
            raise
    print(json.dumps([*marks, ("", clocks())]))


def profile(design: str) -> list[list[str]]:
    """Rows of the table: of all runs, the one whose thread took the least time of the processor."""
    runs = []
    with tempfile.TemporaryDirectory() as scratch:
        program = [sys.executable, "-m", "benchmarks.profile_verify", "--one", design, str(Path(scratch) / "verified")]
        for _ in range(RUNS + 1):
            text = subprocess.run(program, check=True, stdout=subprocess.PIPE, text=True).stdout
            runs.append(json.loads(text.splitlines()[-1]))
    marks = min(runs[1:], key=lambda run: run[-1][1][2])
    rows = [
        [part, *(f"{b - a:.2f}" for a, b in zip(before, after, strict=True))]
        for (part, before), (_, after) in pairwise(marks)
    ]
    return [*rows, ["all", *(f"{b - a:.2f}" for a, b in zip(marks[0][1], marks[-1][1], strict=True))]]


def main(design: str | None = None) -> None:
    if design is not None:
        print(markdown(HEADER, profile(design)))
        return
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "dome.toml"
        subprocess.run([sys.executable, "-m", "asterism", "new", "dome", "-o", str(file)], check=True)
        print(markdown(HEADER, profile(str(file))))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        one_run(*sys.argv[2:4])
    else:
        main(*sys.argv[1:2])
