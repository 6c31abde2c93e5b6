"""A law as lines of text: its range, some of its values, its errors."""

from __future__ import annotations

import csv
import io
from collections import Counter
from itertools import product
from typing import Any

import numpy as np

from asterism.homogenize.law.axes import AXES
from asterism.homogenize.law.law import Law, LawTable
from asterism.homogenize.law.law_file import law_digest
from asterism.homogenize.law.motif_law import MotifLaw, MotifTable
from asterism.homogenize.law.plan import stretch_text
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL, QUANTITY_NAMES, StarLaw, StarTable
from asterism.laws.directional_values import stretch_axes, values_along
from asterism.laws.law_warnings import directions_warning, held_out_warning, pleat_warning, symmetry_warning
from asterism.process.progress_line import without_numbers
from asterism.results.records.law import LawRecord
from asterism.results.words import table_lines

STAR_HEADER = (
    "lambda", "natural_curvature_per_mm", "tight", "flat_bump_mm", "natural_bump_mm",
    "flat_eigenvalue", "flat_supercell_eigenvalue", "natural_eigenvalue", "natural_supercell_eigenvalue",
)  # fmt: skip


MOTIF_HEADER = ("vertices", "smaller_stretch", "larger_stretch", "excess_over_2_x_2_cells_percent")
TUBE_COLUMNS = ("curvature", "hoop", "axial", "bending")


def law_record(law: Law[Any]) -> LawRecord:
    """The summary of a law.

    Examples
    --------
    >>> from asterism.homogenize.law.law_file import load_law
    >>> law_record(load_law()).table()["stretches"]
    '1.35, 1.75'
    """
    plan = law.plan.to_dict()
    return LawRecord.from_json(
        {
            "plan": plan,
            "digest": law_digest(law),
            "made": law.made,
            "residuals": law.residuals,
            "stretches": plan["stretches"],
            "edge_mm": law.edge_mm,
            "cells": len(law.samples),
            "cells_without_law": [
                {name: value for name, value in sample.items() if name != "sample"}
                for sample in law.samples
                if sample["problem"] is not None
            ],
        }
    )


def cells_csv(law: Law[Any]) -> str:
    """CSV with one line for each cell: stretch, sizes in mm, whether it has a law, and its responses.

    Eigenvalues of stars are in N/mm, the lowest over the directions; "tight" marks stars that are not scale-separated
    (`star_law.MAX_SEPARATED_CURL`). Motifs have principal stretches, how much less energy 2 x 2 cells have, and the
    natural tubes by the printed direction around them: curvature (1/mm), stretches around and along, bending (N mm).
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    keys = ("stretch", *law.plan.names, "held_out")
    samples = [cell["sample"] for cell in law.samples]
    angles = sorted({angle for sample in samples if sample and law.plan.is_motif for angle in _tubes(sample)})
    around = [f"{name}_around_{angle}_deg" for angle in angles for name in TUBE_COLUMNS]
    writer.writerow([*keys, "law", *([*MOTIF_HEADER, *around] if law.plan.is_motif else STAR_HEADER)])
    for cell, sample in zip(law.samples, samples, strict=True):
        row = [*(cell[name] for name in keys), cell["problem"] or "yes"]
        if sample:
            row += _motif_responses(sample, angles) if law.plan.is_motif else _star_responses(sample)
        writer.writerow(row)
    return text.getvalue()


def _motif_responses(sample: dict[str, Any], angles: list[int]) -> list[Any]:
    tubes, energies = _tubes(sample), sample["comparison"]
    excess = (energies["energy"] - energies["larger_energy"]) / abs(energies["larger_energy"])
    around = [f"{tubes[angle][name]:.6g}" if angle in tubes else "" for angle in angles for name in TUBE_COLUMNS]
    stretches = [f"{stretch:.6f}" for stretch in np.linalg.eigvalsh(sample["deformation"])]
    return [sample["vertices"], *stretches, f"{100 * max(excess, 0.0):.2f}", *around]


def _tubes(sample: dict[str, Any]) -> dict[int, dict[str, float]]:
    """Natural tubes of a motif's cell by the direction around them, in degrees."""
    return {round(float(np.degrees(tube["direction_rad"]))): tube for tube in sample["directions"]}


def _star_responses(sample: dict[str, Any]) -> list[Any]:
    curvature = sum(sample["natural_curvature"]) / len(sample["natural_curvature"])
    return [
        f"{sample['lam']:.6f}",
        f"{curvature:.6f}",
        "yes" if abs(curvature) * sample["spacing_mm"] > MAX_SEPARATED_CURL else "no",
        f"{sample['bump_mm']:.4f}",
        f"{min(sample['natural_bump_mm']):.4f}",
        *(f"{sample[name]:.4g}" for name in ("eigenvalue", "supercell_eigenvalue")),
        *(f"{min(sample[name]):.4g}" for name in ("natural_eigenvalue", "natural_supercell_eigenvalue")),
    ]


# nodes of each size in the table of values of a motif, about
LISTED_NODES = 4
# approximate numbers of nodes of the first two axes in the table of values of stars
LISTED_LENGTHS = 4
LISTED_THICKNESSES = 3
# characters of a label in the first lines
LABEL_COLUMN = 11
_MOTIF_HEADER = "lambda        angle  A along/across N/mm   D along/across N mm   curvature along/across 1/mm"


def law_lines(law: StarLaw | MotifLaw) -> list[str]:
    """The law as lines of text."""
    lines = table_lines(law_record(law).table(), LABEL_COLUMN)
    for table in law.tables:
        values = _star_values(table) if isinstance(table, StarTable) else _motif_values(table)
        lines += ["", f"  {table_title(table)}", *values, *_errors(law, table)]
    warnings = [held_out_warning(law)]
    if isinstance(law, StarLaw):
        lines += _stability(law)
        warnings = [directions_warning(law), *warnings, symmetry_warning(law), pleat_warning(law)]
    said = [f"  {line}" for line in warnings if line]
    return [*lines, *([""] if said else []), *said, *_problems(law)]


def middle_sizes(table: StarTable) -> tuple[float, ...]:
    """The middle node of each axis after the first two, which text and pictures vary."""
    return tuple(float(nodes[len(nodes) // 2]) for nodes in table.axis_nodes[2:])


def table_title(table: LawTable) -> str:
    """The stretch of a table and its middle sizes, such as "stretch 1.35, width 1.2 mm"."""
    title = f"stretch {stretch_text(table.stretch)}"
    if not isinstance(table, StarTable):
        return title
    sizes = zip(AXES[2:], middle_sizes(table), strict=True)
    return ", ".join([title, *(f"{axis.name} {size:g} mm" for axis, size in sizes)])


def _star_values(table: StarTable) -> list[str]:
    lengths, thicknesses = table.axis_nodes[:2]
    (length_name, thickness_name) = (f"{axis.symbol} mm" for axis in AXES[:2])
    lines = [
        f"    {length_name}   {thickness_name}  lambda lambda_n   kappa 1/mm  D N mm  A11 N/mm  A12 N/mm  c3 N mm2  "
        "offset mm",
    ]
    for length in lengths[1:][:: max(1, (len(lengths) - 1) // LISTED_LENGTHS)]:
        for thickness in thicknesses[:: max(1, (len(thicknesses) - 1) // LISTED_THICKNESSES)]:
            row = table(length, thickness, *middle_sizes(table))
            v = {name: float(row.value[name][0]) for name in QUANTITY_NAMES}
            numbers = (
                f"{v['lam']:.4f}   {v['lam_n']:.4f}     {v['kappa']:8.5f} {v['bending']:7.3f} {v['a11']:9.3f} "
                f"{v['a12']:9.3f} {v['c3']:9.3f} {v['offset_mm']:10.3f}"
            )
            mark = "  not scale-separated" if row.not_scale_separated[0] else ""
            lines.append(f"  {length:6.2f} {thickness:6.3f}  " + (numbers + mark if row.inside[0] else "no answer"))
    return lines


def _motif_values(table: MotifTable) -> list[str]:
    """Principal stretches of the flat sheet, and stiffness and curvature along the smaller one and across."""
    names = [size.key.removesuffix("_mm") for size in table.plan.sizes]
    lines = [f"    {'   '.join(f'{name} mm' for name in names)}   {_MOTIF_HEADER}"]
    chosen = [nodes[:: max(1, (len(nodes) + 1) // LISTED_NODES)] for nodes in (size.nodes for size in table.plan.sizes)]
    for sizes in product(*chosen):
        found = table(np.array([sizes]).reshape(1, len(sizes)))
        shown = "  ".join(f"{size:{len(name) + 3}.4g}" for name, size in zip(names, sizes, strict=True))
        if not found.inside[0]:
            lines.append(f"    {shown}   no law")
            continue
        axes = stretch_axes(found.metric)
        x, y = axes[0, 0]
        angle = round(float(np.degrees(np.arctan2(y, x)))) % 180
        values = values_along(found, axes)
        (smaller, larger), a, d, k = values.stretch[0], values.membrane[0], values.bending[0], values.curvature[0]
        lines.append(
            f"    {shown}   {smaller:.4f} {larger:.4f} {angle:3d} deg  {a[0]:8.4g} {a[1]:8.4g}     "
            f"{d[0]:8.4g} {d[1]:8.4g}     {k[0]:8.5f} {k[1]:8.5f}"
        )
    return lines


def _errors(law: Law[Any], table: LawTable) -> list[str]:
    entry = law.residuals.get(stretch_text(table.stretch), {}).get("held_out", {})
    errors = entry.get("errors")
    if not errors:
        return []
    title = f"  held out, {entry['count']} cells; error in % of the cell's value"
    if entry["tight"]["count"]:
        title += f"; {entry['tight']['count']} more are not scale-separated"
    lines = ["", title, f"  {'':11} median    rms  largest"]
    for name in table.error_names:
        e = errors[name]
        lines.append(f"    {name:<10} {e['median_percent']:5.2f} {e['rms_percent']:6.2f} {e['largest_percent']:8.2f}")
    return lines


def _stability(law: StarLaw) -> list[str]:
    """Numbers of stable cells; cells.csv has the eigenvalues of each cell."""
    solved = [s["sample"] for s in law.samples if s["problem"] is None and s["length_mm"] > 0]
    if not solved:
        return []
    count = len(solved)
    flat = sum(sample["supercell_eigenvalue"] > 0 for sample in solved)
    tubes = count - sum(entry["tubes"]["unstable"] for entry in law.residuals.values())
    return [
        "",
        f"  natural tubes that are stable on 2 x 2 stars: {tubes} of {count} cells",
        f"  flat cells that are stable on 2 x 2 stars: {flat}",
    ]


def _problems(law: Law[Any]) -> list[str]:
    """The reasons why cells have no law, without their numbers, and how often each occurs."""
    reasons = Counter(without_numbers(s["problem"]) for s in law.samples if s["problem"] is not None)
    lines = [f"    {count:4d}  {reason}" for reason, count in reasons.most_common()]
    return ["", "  cells without a law", *lines] if lines else []
