"""The exact model's cost at the default tolerance: the paper's four timed designs, and more and more stars.

python -m benchmarks.exact [table1|stars ...]

Every case runs in a process of its own, so that its memory is its own; the compiled loops are warm. Seconds are those
of the processor: from the flat print, and from the preview.
"""

from __future__ import annotations

import resource
import sys
import time
from typing import Any

from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.previews.session import preview
from benchmarks.report import in_new_process, markdown, number, write_report

# table 1 of the paper: seconds on one thread of a Xeon Gold 5118
TABLE1 = {"roof": 1047.7, "u-shape": 1702.7, "tunnel": 1437.8, "doubly-curved": 2400.4}
RINGS = [3, 5, 7, 9, 12]
HEADER = [
    "case", "stars", "vertices", "mesh error stated, %", "from the print, s", "iterations", "from the preview, s",
    "iterations", "preview, s", "peak MB", "paper, s",
]  # fmt: skip
GROUPS: dict[str, list[dict[str, Any]]] = {
    "table1": [{"name": name, "design": name, "paper_s": seconds} for name, seconds in TABLE1.items()],
    "stars": [{"name": f"{name}, {n} rings", "design": name, "rings": n} for name in ("dome", "tube") for n in RINGS],
}


def run(case: dict[str, Any]) -> dict[str, Any]:
    """One case, here and now."""
    data = gallery.load(case["design"]).to_dict()
    if "rings" in case:
        data["border"] |= {"rings": case["rings"]}
    design = Design.from_dict(data)
    preview(design)  # its mesh and its law are kept

    def timed(work: Any) -> tuple[Any, float]:
        begin = time.process_time()
        return work(), time.process_time() - begin

    shown, preview_s = timed(lambda: preview(design))
    near, near_s = timed(lambda: exact_shape(design, near=shown))
    released, released_s = timed(lambda: exact_shape(design))
    return case | {
        "stars": near.summary["stars_total"],
        "vertices": near.summary["vertices"],
        "mesh": near.summary["mesh_error_percent"],
        "is_minimum": near.summary["is_minimum"] and released.summary["is_minimum"],
        "iterations": [sum(level["iterations"] for level in shape.summary["levels"]) for shape in (released, near)],
        "seconds": [released_s, near_s, preview_s],
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
    }


def row(r: dict[str, Any]) -> list[str]:
    """One line of the table."""
    released, near, shown = r["seconds"]
    return [
        r["name"] + ("" if r["is_minimum"] else " (no minimum)"),
        str(r["stars"]), str(r["vertices"]), number(r["mesh"]),
        f"{released:.1f}", str(r["iterations"][0]), f"{near:.1f}", str(r["iterations"][1]), f"{shown:.2f}",
        f"{r['peak_mb']:.0f}", number(r.get("paper_s"), ".0f"),
    ]  # fmt: skip


def main(words: list[str]) -> None:
    if unknown := [word for word in words if word not in GROUPS]:
        print(f"{unknown[0]!r} is none of {', '.join(GROUPS)}", file=sys.stderr)
        raise SystemExit(2)
    tables: list[str] = []
    for group in words or GROUPS:
        found: list[list[str]] = []
        for case in GROUPS[group]:
            found.append(row(in_new_process(run, case)))
            print("  ".join(found[-1]), flush=True)
        tables.append(f"### {group}\n\n{markdown(HEADER, found)}")
    if not words:
        write_report("exact", "\n\n".join(tables))


if __name__ == "__main__":
    main(sys.argv[1:])
