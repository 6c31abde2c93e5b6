"""Every drawn pattern of the gallery by the exact model from three starts: numbers, minima, a picture each, the page.

python -m benchmarks.pattern_gallery [NAME ...]    (with names: these only, no page)
"""

from __future__ import annotations

import sys
import time
from typing import Any

from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.results.files import write_file
from benchmarks.gallery import PAGE, PATTERN_PICTURE, picture, whole_page
from benchmarks.report import markdown, write_report

STARTS = 3
HEADER = [
    "pattern", "rods", "joints", "vertices", "energy N mm", "height mm", "extent mm", "contraction",
    "smallest eigenvalue N/mm", "minima of 3 starts", "next minimum", "processor s",
]  # fmt: skip


def main(names: list[str]) -> None:
    rows: list[dict[str, Any]] = []
    for name in names or gallery.pattern_names():
        before = time.process_time()
        shape = exact_shape(gallery.load(name), starts=STARTS)
        spent = time.process_time() - before
        kept = {key: value for key, value in shape.summary.items() if key != "design"}
        rows.append(kept | {"name": name, "processor_s": spent})
        picture(shape, PATTERN_PICTURE.format(name), name)
        print("  ".join(row(rows[-1])), flush=True)
        if not shape.summary["is_minimum"]:
            print(f"{name}: NOT A MINIMUM", flush=True)
    if not names:
        table = markdown(HEADER, [row(r) for r in rows])
        write_report("pattern_gallery", rows, table)
        write_file(PAGE, whole_page())


def row(r: dict[str, Any]) -> list[str]:
    """One line of the table."""
    gap = r["next_minimum_percent"]
    return [
        r["name"],
        str(r["rods_total"]),
        str(r["joints_total"]),
        str(r["vertices"]),
        f"{r['energy_n_mm']:.2f}",
        f"{r['height_mm']:.1f}",
        " x ".join(f"{size:.0f}" for size in r["extent_mm"]),
        "-" if r["contraction"] is None else f"{r['contraction']:.3f}",
        f"{r['smallest_eigenvalue']:.1e}" if r["is_minimum"] else "no minimum",
        f"{r['minima_seen']}" + (f", {r['starts_lost']} lost" if r["starts_lost"] else ""),
        "-" if gap is None else f"{gap:+.2f} %",
        f"{r['processor_s']:.0f}",
    ]


if __name__ == "__main__":
    main(sys.argv[1:])
