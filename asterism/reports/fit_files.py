"""The files of a fit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from asterism.fitting.fit import Fit
from asterism.fitting.target import TargetSurface
from asterism.pattern.design.arguments import check_type
from asterism.print.formats.obj import write_shape_obj
from asterism.reports.fit_page import fit_page
from asterism.results.files import SUMMARY_FILE, staged_result
from asterism.shape.vtu import write_rods_vtu, write_shape_vtu


def write_fit(fitted: Fit, directory: str | Path) -> list[str]:
    """Write report.html, summary.json, target.obj, and shape.vtu, shape.obj and rods.vtu laid on the target.

    The shape is the exact one, or the preview if the exact model was not asked for. Its field `target_distance_mm` is
    the signed distance to the target. The target is written in the pose of the fit.

    The files appear together, or none of them if writing fails.

    Returns
    -------
    Their names.

    Raises
    ------
    OutputError
        They cannot be written there.
    """
    check_type(fitted, Fit, "fit makes them")
    distance = fitted.distance
    fields = {
        **distance.shape.point_fields,
        "target_distance_mm": distance.surface_mm,
        "mean_target_distance_mm": distance.mean_mm,
    }
    shape = replace(distance.shape, point_fields=fields)
    with staged_result(directory) as folder:
        write_shape_vtu(shape, folder / "shape.vtu")
        write_rods_vtu(shape, folder / "rods.vtu")
        write_shape_obj(folder / "shape.obj", shape, fitted.summary["design"]["name"])
        (folder / "target.obj").write_text(_obj(fitted.target), encoding="ascii")
        # a name may hold characters that are not valid text
        (folder / "report.html").write_text(fit_page(fitted), encoding="utf-8", errors="backslashreplace")
        (folder / SUMMARY_FILE).write_text(fitted.summary.json_text())
        return sorted(file.name for file in folder.iterdir())


def _obj(target: TargetSurface) -> str:
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in target.disk.vertices]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in target.disk.triangles]
    return "\n".join(["# target in the pose of the fit, mm", *lines]) + "\n"
