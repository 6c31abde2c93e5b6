"""The preview against the exact model on the frozen designs, as their supports hold them.

python -m benchmarks.frozen.compare FOLDER [--half sealed] [--open-second-set | --open-third-set] [NAME ...]

FOLDER is that of `benchmarks.frozen.solve`; it keeps finished comparisons as long as the preview and its code stay the
same. The working half of the first set is compared, or the half or set that an option names: each option opens designs
that a model may not have been chosen on.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from benchmarks.accuracy.comparisons import Row, compared, is_solved
from benchmarks.accuracy.tables import by_support, line, section
from benchmarks.frozen.draw import HALVES, KINDS, LATER, SEALED, WORKING, frozen
from benchmarks.report import chosen, write_report


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.frozen.compare")
    parser.add_argument("folder", type=Path)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--half", choices=HALVES, default=WORKING)
    for each in LATER:
        which.add_argument(f"--open-{each}-set", dest="half", action="store_const", const=each)
    parser.add_argument("names", nargs="*")
    options = parser.parse_intermixed_args()
    rows: list[Row] = []
    without = []
    for kind, design in chosen(parser, options.names, {each[1].name: each for each in frozen(options.half)}):
        if not is_solved(design, options.folder):
            without.append(design.name)
            continue
        rows.append(compared(design, options.folder) | {"kind": kind})
        print("  ".join(line(rows[-1])), flush=True)
    if not rows:
        parser.error(f"FOLDER: {options.folder} has no exact shapes: run python -m benchmarks.frozen.solve first")
    text = table(rows, without)
    print(text)
    if not options.names:
        flag = {WORKING: "", SEALED: " --half sealed"}.get(options.half, f" --open-{options.half}-set")
        write_report(f"frozen.{options.half}", text, f"python -m benchmarks.frozen.compare FOLDER{flag}")


def table(rows: list[Row], without: list[str]) -> str:
    """Markdown: all, by support, and by kind."""
    groups = by_support(rows) | {f"kind: {kind}": [row for row in rows if row["kind"] == kind] for kind in KINDS}
    return section(groups, *([f"Without exact shapes: {', '.join(without)}."] if without else []))


if __name__ == "__main__":
    main()
