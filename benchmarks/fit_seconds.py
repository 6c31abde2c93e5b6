"""Processor and clock seconds of fits by the preview: first guess, fit, and rounding.

python -m benchmarks.fit_seconds [NAME ...]

The first guess ends with its preview, the fit with the sizes that a fresh preview confirms, and rounding with the
design as written. A fit of the first target before warms up the compiled loops.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

from asterism.fitting.fit import fit
from asterism.fitting.target import TargetSurface
from asterism.print.profiles import load_printer
from benchmarks.chosen_names import chosen_names
from benchmarks.fit_targets import TARGETS, ellipsoid
from benchmarks.report import markdown, write_report

LARGE = "ellipsoid dome, 198 mm"
ROWS: dict[str, Callable[[], TargetSurface]] = {
    **{name: TARGETS[name][0] for name in ("saddle", "ellipsoid dome", "hypar")},
    LARGE: lambda: ellipsoid(1.6, LARGE),
}
# a stage ends with the first line that begins so
ENDS = {"first guess": "step 0", "fit": "rounding to", "rounding": "done"}
HEADER = ["target", "stars", *(f"{stage} CPU s, clock s" for stage in ENDS), "preview %"]


def row(name: str) -> dict[str, object]:
    """Fit one target by the preview, and take the time of each stage."""
    target, printer = ROWS[name](), load_printer("ultimaker2")
    marks = {"begin": (time.process_time(), time.perf_counter())}

    def say(line: str) -> None:
        for stage, begin in ENDS.items():
            if line.startswith(begin) and stage not in marks:
                marks[stage] = (time.process_time(), time.perf_counter())

    fitted = fit(target, printer=printer, exact=False, say=say)
    say("done")
    ends = list(marks.values())
    seconds = {
        stage: [after - before for before, after in zip(ends[number], ends[number + 1], strict=True)]
        for number, stage in enumerate(ENDS)
    }
    return {
        "row": name,
        "stars": fitted.summary.stars,
        "seconds": seconds,
        "preview": fitted.summary.preview.mean_percent,
    }


def main() -> None:
    """Take the times, and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME")
    names = chosen_names(parser, parser.parse_args().names, ROWS)
    row(names[0])
    rows, lines = [], []
    for name in names:
        data = row(name)
        times = [f"{cpu:.1f}, {clock:.1f}" for cpu, clock in data["seconds"].values()]  # type: ignore[attr-defined]
        lines.append([name, str(data["stars"]), *times, f"{data['preview']:.2f}"])
        rows.append(data)
        print(*lines[-1], sep=" | ", flush=True)
    write_report("fit_seconds", rows, markdown(HEADER, lines))


if __name__ == "__main__":
    main()
