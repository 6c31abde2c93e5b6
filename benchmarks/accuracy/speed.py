"""How many times longer the exact model takes than a preview, over the designs of the study.

python -m benchmarks.accuracy.speed [NAME ...]

Both on the mesh of the law: the exact model by the clock, once, from the release; previews the median of five, in a
process that has made one. Edits change the width of all stars by 1 or 2 %, and back. Nothing else should run.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from asterism.exact.simulation import exact_shape
from asterism.homogenize.errors import LawError
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.previews.session import Preview
from benchmarks.accuracy.designs import designs
from benchmarks.preview import changed, load, preview_of_a_new_print, timed
from benchmarks.report import markdown, write_report

WANTED = 100.0  # times
SHARES = [0.98, 0.99, 1.01, 1.02]  # of the width
NAMES = [
    "design",
    "stars",
    "triangles",
    "forms tried",
    "exact s",
    "preview ms",
    "edit ms",
    "exact / preview",
    "exact / edit",
]


def speed(design: Design) -> dict[str, Any]:
    """Seconds and milliseconds of a design; LawError if it has no preview."""
    again = timed(lambda: preview_of_a_new_print(design))[0]
    exact = exact_shape(design).summary
    preview, edits = Preview(design), []
    summary = preview.shape().summary
    for share in SHARES:
        for edited in (changed(design, "width_mm", share), design):
            begin = time.perf_counter()
            for _ in preview.edit(edited):
                pass
            edits.append(1e3 * (time.perf_counter() - begin))
    return {
        "design": design.name,
        "stars": summary["stars"],
        "triangles": summary["shell_triangles"],
        "trials": len(summary["starts"]),
        "exact_s": exact["wall_s"],
        "is_minimum": exact["is_minimum"],
        "again_ms": again,
        "edit_ms": statistics.median(edits),
    }


def ratios(rows: Sequence[dict[str, Any]], key: str) -> np.ndarray:
    """Times that the exact model takes over those of previews, `again_ms` or `edit_ms`."""
    return np.array([1e3 * r["exact_s"] / r[key] for r in rows])


def told(rows: Sequence[dict[str, Any]], key: str) -> str:
    """How many are as fast as they should be, and the middle and the ends of the list."""
    found = ratios(rows, key)
    low, middle, high = np.quantile(found, [0.0, 0.5, 1.0])
    return f"{(found >= WANTED).sum()} of {len(found)}, median {middle:.0f}, {low:.0f} to {high:.0f}"


def line(r: dict[str, Any]) -> list[str]:
    times = [f"{ratios([r], key)[0]:.0f}" for key in ("again_ms", "edit_ms")]
    exact = f"{r['exact_s']:.1f}" + ("" if r["is_minimum"] else " (no minimum)")
    counts = [str(r[key]) for key in ("stars", "triangles", "trials")]
    return [r["design"], *counts, exact, f"{r['again_ms']:.0f}", f"{r['edit_ms']:.0f}", *times]


def main(names: list[str]) -> None:
    exact_shape(gallery.load("star"))  # compiles
    rows = []
    for design in designs():
        if names and design.name not in names:
            continue
        try:
            rows.append(speed(design))
        except LawError:  # of another material
            continue
        print("  ".join(line(rows[-1])), flush=True)
    both = "\n".join(
        f"At least {WANTED:.0f} times {what}: {told(rows, key)}."
        for key, what in (("again_ms", "as long as from nothing"), ("edit_ms", "as long as an edit"))
    )
    text = "\n\n".join([load(), both, markdown(NAMES, [line(r) for r in rows])])
    print(text)
    if not names:
        write_report("accuracy.speed", rows, text)


if __name__ == "__main__":
    main(sys.argv[1:])
