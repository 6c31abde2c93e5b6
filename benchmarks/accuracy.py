"""How far previews are from exact shapes, and these from their limit: the gallery, or a set of the frozen designs.

python -m benchmarks.accuracy FOLDER SET [NAME ...] [--released] [--fine]

SET is `gallery` or a set of `benchmarks.frozen.draw`. FOLDER keeps exact shapes. The exact model starts from the
preview; with --released from the flat print too, and the lower shape counts. --fine compares the exact shape with one
that has four times the vertices, and the error that it states. Distances are as the supports hold the sheets, in % of
the diameter. With names no report is written.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.law.plan import without_law
from asterism.pattern import gallery
from asterism.previews.session import preview
from asterism.verification.verify import alike
from benchmarks.frozen.draw import GROUPS, frozen
from benchmarks.report import chosen, markdown, number, write_report
from benchmarks.solved import Solved

GALLERY = "gallery"
HEADER = [
    "designs", "stars", "preview, %", "estimated, %", "height, % of diameter", "estimated, %", "same form",
    "exact vertices", "mesh error stated, %", "distance to four times the vertices, %",
]  # fmt: skip

Row = dict[str, Any]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy")
    parser.add_argument("folder", type=Path)
    parser.add_argument("set", choices=(GALLERY, *GROUPS))
    parser.add_argument("names", nargs="*")
    parser.add_argument("--released", action="store_true")
    parser.add_argument("--fine", action="store_true")
    options = parser.parse_intermixed_args()
    if options.set == GALLERY:
        designs = {name: ("", gallery.load(name)) for name in (*gallery.names(), *gallery.template_names())}
        designs = {name: each for name, each in designs.items() if without_law(each[1]) is None}
    else:
        designs = {design.name: (kind, design) for kind, design in frozen(options.set)}
    rows = []
    for kind, design in chosen(parser, options.names, designs):
        solved = Solved(design, options.folder)
        solved.near()
        if options.released:
            solved.released()
        rows.append({"name": design.name, "kind": kind} | measured(solved, options.fine))
        print("  ".join(line([rows[-1]], design.name)), flush=True)
    text = section(rows)
    print(text)
    if not options.names:
        flags = "".join(f" --{name}" for name in ("released", "fine") if getattr(options, name))
        write_report(f"accuracy.{options.set}", text, f"python -m benchmarks.accuracy FOLDER {options.set}{flags}")


def measured(solved: Solved, fine: bool) -> Row:
    """The numbers of one design."""
    shown, exact = preview(solved.design), solved.right
    found, error = solved.distance(shown), shown.summary["expected_rms_percent"]
    height, across = shown.height_mm, found.diameter_mm
    high = shown.summary["expected_height_percent"]
    row = {
        "stars": len(shown.plan.centres) if shown.plan is not None else 0,
        "held": shown.plan is not None and shown.plan.is_supported_in_plane,
        "distance": found.rms_percent,
        "expected": error,
        "height": 100.0 * abs(height - exact.height_mm) / across,
        "expected_height": None if high is None else high * height / across,
        "form": alike(found.record),
        "vertices": exact.summary["vertices"],
        "mesh": exact.summary["mesh_error_percent"],
        "fine": None,
    }
    if fine:
        row["fine"] = solved.distance(exact, solved.fine()).rms_percent
    return row


def section(rows: Sequence[Row]) -> str:
    """Markdown: median, nine in ten and largest by kind, then every design."""
    groups = {"all": list(rows), "held": [r for r in rows if r["held"]], "free": [r for r in rows if not r["held"]]}
    groups |= {kind: [r for r in rows if r["kind"] == kind] for kind in dict.fromkeys(r["kind"] for r in rows) if kind}
    kinds = [line(group, f"{name}, {len(group)}") for name, group in groups.items() if group]
    return f"{markdown(HEADER, kinds)}\n\n{markdown(HEADER, [line([row], row['name']) for row in rows])}"


def line(rows: Sequence[Row], name: str) -> list[str]:
    """One line: of a single design its numbers, of several median, nine in ten and largest."""
    if len(rows) == 1:
        (r,) = rows
        return [
            name, str(r["stars"]), *(number(r[key]) for key in ("distance", "expected", "height", "expected_height")),
            "yes" if r["form"] else "no", str(r["vertices"]), number(r["mesh"]), number(r["fine"]),
        ]  # fmt: skip
    return [
        name, spread(rows, "stars", ".0f"), spread(rows, "distance"), covered(rows, "distance", "expected"),
        spread(rows, "height"), covered(rows, "height", "expected_height"), f"{sum(r['form'] for r in rows)}",
        spread(rows, "vertices", ".0f"), covered(rows, "fine", "mesh"), spread(rows, "fine"),
    ]  # fmt: skip


def spread(rows: Sequence[Row], key: str, form: str = ".2f") -> str:
    """Median, nine in ten, largest."""
    known = [r[key] for r in rows if r[key] is not None]
    return ", ".join(format(float(np.quantile(known, share)), form) for share in (0.5, 0.9, 1.0)) if known else "-"


def covered(rows: Sequence[Row], error: str, expected: str) -> str:
    """How many errors are within what is stated of them."""
    known = [r for r in rows if r[error] is not None and r[expected] is not None]
    return f"{sum(r[error] <= r[expected] for r in known)} of {len(known)}"


if __name__ == "__main__":
    main()
