"""The exact shapes of the study, which take most of its time and do not depend on the preview.

python -m benchmarks.accuracy.exact FOLDER [NAME ...]

FOLDER keeps a result for every design, as `asterism simulate` writes it; those that are there are not computed again.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.reports.write_results import write_results
from asterism.shape.read_shape import read_shape
from asterism.shape.shape import Shape
from asterism.verification.right_shape import right_shape
from benchmarks.accuracy.designs import designs


def exact(design: Design, folder: Path, near: Callable[[], Shape] | None = None) -> Shape:
    """The exact shape of a design, kept in a folder of its name; with `near` the one that is found from that shape."""
    here = folder / design.name / ("near" if near else "released")
    if (here / "summary.json").exists():
        shape = read_shape(here)
        if shape.summary.get("design") == design.to_dict():
            return shape
    shape = exact_shape(design, near=near() if near else None)
    write_results(shape, here)
    return shape


def known(design: Design, folder: Path) -> dict[str, Shape]:
    """The exact shapes of a design by what they were found from, that which counts first.

    One that was found from a preview is there only if the folder has it.
    """
    released = exact(design, folder)
    if not (folder / design.name / "near" / "summary.json").exists():
        return {"release": released}
    both = {"release": released, "preview": exact(design, folder, near=lambda: released)}
    return both if right_shape(both) == "release" else dict(reversed(both.items()))


def lowest(design: Design, folder: Path) -> Shape:
    """The exact shape that counts."""
    return next(iter(known(design, folder).values()))


def main(words: list[str]) -> None:
    folder, names = Path(words[0]), words[1:]
    for design in designs():
        if not names or design.name in names:
            s = exact(design, folder).summary
            work = f"{s['wall_s']:.1f} s, {s['vertices']} vertices"
            print(design.name, work, "minimum" if s["is_minimum"] else "NO MINIMUM", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
