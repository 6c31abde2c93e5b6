"""The facts on the page about a design, as lines under headings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from asterism.pattern.design.design import Design
from asterism.pattern.design.residual_curvature import ResidualCurvature
from asterism.pattern.layout.layout import Layout
from asterism.print.job import Job
from asterism.results.words import VISIBLE_SAG_MM, distance_error, height_error

Facts = dict[str, list[str]]


def design_facts(job: Job, summary: Mapping[str, Any], source: str) -> Facts:
    """Lines on parameters, shape, accuracy and material, as far as they are available.

    Parameters
    ----------
    job : the design on the printer's bed.
    summary : summary of the shape; empty if there is no shape.
    source : origin of the shape, or the reason for its absence.
    """
    facts = {
        "Fabric": _fabric(job.design),
        "Plastic": _plastic(job.design),
        "Stars": _stars(job.drawn_plan, job.design) if job.arms else [],
        "Rods": _rods(job.drawn_plan),
        "Shape": [source, *_as_drawn(job, summary), *_shape(summary), *_hanging(job)],
        "Computation": _accuracy(summary),
        "Print": _print(job),
    }
    return {head: lines for head, lines in facts.items() if lines}


def _fabric(design: Design) -> list[str]:
    x, y = design.fabric.stretch_xy
    stretch = f"{x:g}" if x == y else f"{x:g} along x, {y:g} along y"
    lines = [f"stretch {stretch}, {design.fabric.thickness_mm:g} mm thick", f"bending: {design.fabric.bending}"]
    if design.gravity.on:  # without gravity, the shape does not depend on the modulus
        x, y, z = design.gravity.direction
        lines.append(f"E {design.fabric.modulus_mpa:g} MPa, weight along ({x:g}, {y:g}, {z:g})")
    return lines


def _plastic(design: Design) -> list[str]:
    plastic = design.plastic
    kept = plastic.kappa_bar_per_mm
    bar = "by thickness" if isinstance(kept, ResidualCurvature) else f"{kept:g} /mm"
    return [f"E1/E2 {plastic.modulus_ratio:g}, {plastic.rest_curvature}", f"kappa_bar {bar}"]


def _stars(plan: Layout, design: Design) -> list[str]:
    width, height = np.ptp(plan.outline, axis=0)
    return [
        f"{len(plan.centres)}, {design.lattice.arms} arms, {design.lattice.spacing_mm:.4g} mm apart",
        f"length {_range(plan.arm_length)} mm",
        f"thickness {_range(plan.arm_thickness)}, width {_range(plan.arm_width)} mm",
        *_sides(plan),
        f"sheet {width:.1f} x {height:.1f} mm, stretched",
    ]


def _rods(plan: Layout) -> list[str]:
    """The drawn rods; empty without any."""
    rods = plan.drawn_rods
    if not rods:
        return []
    width, height = np.ptp(plan.outline, axis=0)
    thickness, widths = (np.concatenate([getattr(rod, name) for rod in rods]) for name in ("thickness", "width"))
    return [
        f"{len(rods)} between nodes, {sum(rod.length for rod in rods):.0f} mm in all",
        f"joints: {len(plan.graph.joints)}",
        f"thickness {_range(thickness)}, width {_range(widths)} mm",
        f"sheet {width:.1f} x {height:.1f} mm, stretched",
    ]


def _sides(plan: Layout) -> list[str]:
    """The number of stars that start down or flat."""
    down, free = (int((plan.star_branch == side).sum()) for side in (-1, 0))
    parts = [f"{count} {how}" for count, how in ((down, "down"), (free, "flat")) if count]
    return ["started " + ", ".join(parts)] if parts else []


def _as_drawn(job: Job, summary: Mapping[str, Any]) -> list[str]:
    """A line if the shape belongs to the design as drawn, and the printer rounds its sizes."""
    if not job.is_rounded or "design" not in summary:
        return []
    shown = Design.from_dict(summary["design"])
    if (shown.stars, shown.rods) == (job.design.stars, job.design.rods):
        return []
    return ["as drawn, before rounding (see Print)"]


def _shape(summary: Mapping[str, Any]) -> list[str]:
    lines = []
    if "height_mm" in summary:
        lines.append(f"height {summary['height_mm']:.1f} mm")
    if "extent_mm" in summary:
        lines.append("extent " + " x ".join(f"{size:.1f}" for size in summary["extent_mm"]) + " mm")
    if (above := summary.get("above_needles_mm")) is not None:
        lines.append(f"rises {above:.1f} mm over its needles")
    if "is_minimum" in summary:
        lines.append("a certified equilibrium" if summary["is_minimum"] else "NOT a certified equilibrium")
    return lines


def _hanging(job: Job) -> list[str]:
    if job.hangs_mm is None or job.hangs_mm <= VISIBLE_SAG_MM:
        return []
    doubt = job.hangs_doubt_mm
    below = f"hangs {job.hangs_mm:.1f} mm below its base"
    return [below] if doubt is None else [f"{below},", f"give or take {doubt:.1f} mm"]


def _accuracy(summary: Mapping[str, Any]) -> list[str]:
    lines = []
    if (expected := summary.get("expected_rms_percent")) is not None:
        lines += ["estimated rms distance from the exact model:", distance_error(expected, summary.get("diameter_mm"))]
    if (height := summary.get("expected_height_percent")) is not None:
        lines.append(f"height give or take {height_error(height, summary['height_mm'])}")
    if (mesh := summary.get("mesh_error_percent")) is not None:
        lines.append(f"mesh error about {mesh:.1f} % of the diameter")
    elif (change := summary.get("mesh_change_percent")) is not None:
        lines += ["mesh error unknown;", f"{change:.1f} % from the next coarser mesh"]
    elif summary and summary.get("model") != "preview":
        lines.append("mesh error unknown: one mesh was solved")
    elif summary and not lines:
        lines.append("no error estimate")
    if (law := summary.get("law")) is not None:
        lines.append(f"law: {law['material']}, edges of {law['edge_mm']:g} mm")
    if lines:
        lines += ["Errors of the computation, not of the print,", "whose distance was not measured."]
    return lines


def _print(job: Job) -> list[str]:
    cost = job.cost
    return [
        *([f"LARGER than the {job.printer.name} can print in its frame"] if job.too_large else []),
        f"{job.printer.name}, {job.plastic.name}",
        *_rounded(job),
        f"{cost.mass_g:.1f} g, {cost.filament_m:.2f} m of filament",
        f"about {cost.minutes:.0f} minutes",
        f"nozzle starts {job.z_offset_mm:g} mm above the bed" + ("" if job.fabric_given else ", on released fabric"),
    ]


def _rounded(job: Job) -> list[str]:
    """The sizes that the printer makes, if they differ from those of the design."""
    lines = []
    for name, size in job.size_changes.items():
        if size.stars_changed or size.rods_changed:
            lines.append(f"{name} " + ", ".join(f"{value:g}" for value in size.values_mm[:4]) + " mm after rounding")
    return lines


def _range(values: np.ndarray) -> str:
    low, high = float(values.min()), float(values.max())
    return f"{low:.3g}" if high - low < 0.005 * high else f"{low:.3g} to {high:.3g}"
