"""The exact shapes of the frozen designs, from the released sheet and from the preview.

python -m benchmarks.frozen.solve FOLDER [--half sealed | second | third] [NAME ...]

FOLDER keeps shapes, as in the study, and laws of stars with four to six arms; finished ones are not computed again. The
preview is a start of the exact model and is compared with nothing: that would open the sealed designs.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from asterism.previews.run import preview
from benchmarks.accuracy.comparisons import exact, known, law_for
from benchmarks.frozen.draw import GROUPS, WORKING, frozen
from benchmarks.report import chosen


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.frozen.solve")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--half", choices=GROUPS, default=WORKING)
    parser.add_argument("names", nargs="*")
    options = parser.parse_intermixed_args()
    for design in chosen(parser, options.names, {design.name: design for _, design in frozen(options.half)}):
        exact(design, options.folder)
        exact(design, options.folder, near=lambda design=design: preview(design, law_for(design, options.folder)))
        shapes = known(design, options.folder)
        energies = ", ".join(
            f"from the {start} {shape.summary['energy_n_mm']:.3f} N mm"
            + ("" if shape.summary["is_minimum"] else " (no minimum)")
            for start, shape in shapes.items()
        )
        print(f"{design.name}: {energies}", flush=True)


if __name__ == "__main__":
    main()
