"""The preview's cost beside that of the exact model: in a new process, again, and after an edit.

python -m benchmarks.preview [DESIGN ...]    (with names of the gallery: these only, no report)

Times are medians in ms of the processor, as other programs disturb it less, where nothing else is said. *Again* is a
preview of a print that the process has previewed before, whose mesh and supports are kept. Edits change a size of all
stars by 1 or 2 %, and back.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.previews.session import Preview
from benchmarks.report import markdown, write_report

DESIGNS = ("tube", "dome", "u-shape")
# a size of all stars, and what it is multiplied by: the same size for all stars only
EDITS = [(size, share) for size in ("thickness_mm", "width_mm") for share in (0.98, 0.99, 1.01, 1.02)]
COLD = "import time, asterism; asterism.preview(asterism.new({name!r})); print(time.process_time())"
HEADER = [
    "design", "stars", "triangles", "new process, s by the clock", "again",
    "equilibrium", "after an edit", "slowest edit", "linear response", "its solve", "exact, s by the clock",
    "that over again", "that over an edit",
]  # fmt: skip


def timed(work: Callable[[], Any]) -> float:
    """Median of the processor's milliseconds, after one run that does not count."""
    work()
    times = []
    for _ in range(5):
        used = time.process_time()
        work()
        times.append(1e3 * (time.process_time() - used))
    return statistics.median(times)


def row(name: str) -> list[str]:
    """One line of the table."""
    design = gallery.load(name)
    cold = []
    for _ in range(3):
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-c", COLD.format(name=name)], check=True, stdout=subprocess.DEVNULL)
        cold.append(time.perf_counter() - begin)
    again = timed(lambda: Preview(design).shape())
    preview = Preview(design)
    linear, solve, whole, is_minimum = [], [], [], True
    for size, share in EDITS:
        data = design.to_dict()
        data["stars"][size] *= share
        for edited in (Design.from_dict(data), design) * 2:
            used = time.process_time()
            for stage in preview.edit(edited):
                if stage.name == "linear":
                    linear.append(1e3 * (time.process_time() - used))
                    solve.append(1e3 * preview.seconds["linear response"])
            whole.append(1e3 * (time.process_time() - used))
            is_minimum = is_minimum and preview.equilibrium.is_minimum
    summary, edit = preview.shape().summary, statistics.median(whole)
    exact = exact_shape(design).summary["wall_s"]
    numbers = [
        again, 1e3 * Preview(design).seconds["equilibrium"], edit, max(whole),
        statistics.median(linear), statistics.median(solve),
    ]  # fmt: skip
    return [
        name + ("" if is_minimum else " (no minimum)"), str(summary["stars"]), str(summary["shell_triangles"]),
        f"{statistics.median(cold):.2f}", *(f"{value:.3g}" for value in numbers), f"{exact:.1f}",
        *(f"{1e3 * exact / value:.0f}" for value in (again, edit)),
    ]  # fmt: skip


def main(names: list[str]) -> None:
    exact_shape(gallery.load("star"))  # compiles
    rows = []
    for name in names or DESIGNS:
        rows.append(row(name))
        print("  ".join(rows[-1]), flush=True)
    busy = f"Programs that wanted the cores, mean of the last 15 minutes: {os.getloadavg()[2]:.1f}."
    text = f"{busy}\n\n{markdown(HEADER, rows)}"
    print(text)
    if not names:
        write_report("preview", text)


if __name__ == "__main__":
    main(sys.argv[1:])
