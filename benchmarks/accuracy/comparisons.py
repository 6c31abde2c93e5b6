"""Exact shapes and comparisons with previews, kept in a folder: exact shapes take most of the time."""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from asterism.exact.simulation import exact_shape
from asterism.fem.shell.shell import Shell
from asterism.homogenize.campaign.design_plan import plan_for_design
from asterism.homogenize.campaign.workers import default_jobs
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import law_digest, load_law
from asterism.laws.calibrate import calibrate
from asterism.pattern.design.design import Design
from asterism.pattern.design.files import plain
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.print_layout import print_layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.run import preview
from asterism.reports.write_results import write_results
from asterism.results.files import write_file
from asterism.shape.cell_mean import CellMean
from asterism.shape.comparison import Comparison, compare_shapes
from asterism.shape.read_shape import read_shape
from asterism.shape.shape import Shape
from asterism.verification.minima import right_shape
from asterism.verification.numbers import numbers, same_branch

FAR = 2.5  # % of the diameter, and more is a miss
HEIGHT_FAR = 6.0  # % of the height, and more is a miss

Row = dict[str, Any]

paper_law = cache(load_law)


def law_for(design: Design, folder: Path) -> Law:
    """The paper's law, or one of the design's own stars, which the folder keeps; LawError if they have none."""
    try:
        paper_law().check(design)
    except ForeignLaw:
        file = folder / "laws" / f"{design.name}.npz"
        if file.exists():
            return load_law(file)
        file.parent.mkdir(parents=True, exist_ok=True)
        return calibrate(plan_for_design(design), file, default_jobs())
    return paper_law()


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


def is_solved(design: Design, folder: Path) -> bool:
    """Whether the folder has both exact shapes."""
    return all((folder / design.name / start / "summary.json").exists() for start in ("released", "near"))


def known(design: Design, folder: Path) -> dict[str, Shape]:
    """The exact shapes of a design that the folder has, by what they were found from; the first one counts."""
    released = exact(design, folder)
    if not is_solved(design, folder):
        return {"release": released}
    both = {"release": released, "preview": exact(design, folder, near=lambda: released)}
    return both if right_shape(both) == "release" else dict(reversed(both.items()))


def lowest(design: Design, folder: Path) -> Shape:
    """The exact shape that counts."""
    return next(iter(known(design, folder).values()))


class Reference:
    """The exact shape of a design that counts, and what previews with other models are compared with it by."""

    def __init__(self, design: Design, folder: Path) -> None:
        self.law, self.plan, self._pull = law_for(design, folder), print_layout(design), design.gravity.pull
        self.design, self._exact = design, lowest(design, folder)
        self._symmetries = symmetries(design, self.plan)
        self._mean = CellMean(self._exact.printed, self._exact.weights, self.plan.lattice_vectors)

    def compared(self, model: PreviewModel = PREVIEW_MODEL) -> Comparison | None:
        """With the preview of a model; None if law or search refuse the sheet."""
        try:
            shape = preview(self.design, self.law, model=model)
        except LawError:
            return None
        return compare_shapes(self._exact, shape, self.plan, self._symmetries, self._pull, mean=self._mean)


def compared(design: Design, folder: Path) -> Row:
    """The preview against the lower of the exact shapes from the released sheet and from the preview.

    The folder keeps the row as long as the law and the code of the preview stay the same. An exact shape that was found
    from a preview stays a candidate of its design when the preview changes. LawError if the design has no preview.
    """
    law = law_for(design, folder)
    made_by = hashlib.sha256(b"".join([law_digest(law).encode(), *preview_code()])).hexdigest()[:16]
    path = folder / design.name / "comparison.json"
    if path.exists():
        row: Row = json.loads(path.read_text(encoding="utf-8"))
        if row["design"] == design.to_dict() and row["made_by"] == made_by:
            return row
    row = _row(design, law, folder) | {"made_by": made_by, "design": design.to_dict()}
    write_file(path, json.dumps(plain(row), indent=1) + "\n")
    return row


def preview_code() -> list[bytes]:
    """What a preview is computed and compared by."""
    folders = [Path(inspect.getfile(each)).parents[up] for each, up in ((Shell, 1), (preview, 0), (compare_shapes, 0))]
    return [file.read_bytes() for folder in folders for file in sorted(folder.rglob("*.py"))]


def _row(design: Design, law: Law, folder: Path) -> Row:
    shown, plan = preview(design, law), layout(design)
    exact(design, folder, near=lambda: shown)
    shapes = known(design, folder)
    same, pull = symmetries(design, plan), design.gravity.pull
    right, *other = shapes.values()
    comparison, *with_other = [compare_shapes(shape, shown, plan, same, pull) for shape in shapes.values()]
    form = same_branch(comparison, None)
    if other and other[0].summary["is_minimum"]:
        form = same_branch(comparison, with_other[0], compare_shapes(right, other[0], plan, same, pull).rms_percent)
    summary = {key: value for key, value in shown.summary.items() if key != "design"}
    return dict(numbers(comparison)) | {
        "name": design.name,
        "stars": right.summary["stars_total"],
        "is_held": bool(plan.pins),
        "same_branch": form,
        "result_from": next(iter(shapes)),
        "mesh_change_percent": right.summary.get("mesh_change_percent"),
        "softness": right.summary["smallest_eigenvalue"],
        **{key: summary.get(key) for key in ("expected_rms_percent", "expected_height_percent")},
        "warnings": list(summary.get("warnings", [])),
        "preview": summary,
    }


def missed(row: Row) -> bool:
    """Further off than 2.5 %, or another form."""
    return bool(row["rms_percent"] > FAR or not row["same_branch"])


def announced(row: Row, key: str = "expected_rms_percent", far: float = FAR) -> bool:
    """Whether the preview expected to be as far off as counts as a miss, or warned of another form."""
    return (row[key] or 0.0) > far or any("another form" in line for line in row["warnings"])
