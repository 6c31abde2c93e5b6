"""One design of the study: the preview against the exact model, and what may cause the difference."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.run import preview
from asterism.shape.comparison import compare_shapes
from asterism.shape.shape import Shape
from asterism.verification.numbers import numbers, same_branch
from asterism.verification.run import verify
from benchmarks.accuracy.exact import exact, known


def whole_row(design: Design, folder: Path, law: Law) -> dict[str, Any]:
    """`asterism verify`, with the exact shapes of the folder; without the designs and the parts of the summaries."""
    near = exact(design, folder, near=lambda: preview(design, law))
    found = verify(design, law, released=exact(design, folder), near=near)
    return _short(found.summary) | {"name": design.name, "warnings": found.summary["warnings"]}


def quick_row(design: Design, folder: Path, law: Law) -> dict[str, Any]:
    """The comparison with the lower of the exact shapes, kept in a folder, from the released sheet and the preview."""
    shown, plan = preview(design, law), layout(design)
    exact(design, folder, near=lambda: shown)
    shapes = known(design, folder)
    same, pull = symmetries(design, plan), design.gravity.pull
    right, *other = shapes.values()
    comparison, *with_other = [compare_shapes(shape, shown, plan, same, pull) for shape in shapes.values()]
    form = same_branch(comparison, None)
    if other and other[0].summary["is_minimum"]:
        form = same_branch(comparison, with_other[0], compare_shapes(right, other[0], plan, same, pull).rms_percent)
    return dict(numbers(comparison)) | {
        "name": design.name,
        "stars_down": len(right.summary["stars_down"]),
        "same_branch": form,
        "result_from": next(iter(shapes)),
        "mesh_change_percent": right.summary.get("mesh_change_percent"),
        "expected_rms_percent": shown.summary.get("expected_rms_percent"),
        "expected_height_percent": shown.summary.get("expected_height_percent"),
        "warnings": list(shown.summary.get("warnings", [])),
        "preview": _kept(shown),
    }


def _short(summary: Mapping[str, Any]) -> dict[str, Any]:
    exact_kept = ("stars_total", "stars_up", "stars_down", "vertices", "edge_mm", "is_minimum", "energy_n_mm")
    return {key: value for key, value in summary.items() if key not in ("design", "exact", "preview")} | {
        "exact": {key: summary["exact"][key] for key in exact_kept},
        "preview": {key: value for key, value in summary["preview"].items() if key != "design"},
    }


def _kept(shape: Shape) -> dict[str, Any]:
    return {key: value for key, value in shape.summary.items() if key != "design"}
