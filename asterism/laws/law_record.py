"""The summary of a law, and its cells as a table for a spreadsheet: sizes, responses and stability."""

from __future__ import annotations

import csv
import io
from typing import Any

from asterism.homogenize.law.axes import AXES
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import law_digest
from asterism.homogenize.law.law_table import MAX_SEPARATED_CURL
from asterism.results.records.law import LawRecord

TASK_KEYS = ("stretch", *(axis.key for axis in AXES), "held_out")
CSV_HEADER = (
    *TASK_KEYS, "mesh_edges_per_arm", "answer", "lambda", "natural_curvature_per_mm", "tight", "flat_bump_mm",
    "flat_other_side", "natural_bump_mm", "flat_eigenvalue", "flat_supercell_eigenvalue", "natural_eigenvalue",
    "natural_supercell_eigenvalue", "anisotropy",
)  # fmt: skip


def law_record(law: Law) -> LawRecord:
    """The summary of a law.

    Examples
    --------
    >>> from asterism.homogenize.law.law_file import load_law
    >>> law_record(load_law()).table()["stretches"]
    '1.35, 1.75'
    """
    problems = [sample for sample in law.samples if sample["problem"] is not None]
    return LawRecord.from_json(
        {
            "material": law.material.to_dict(),
            "digest": law_digest(law),
            "made": law.made,
            "residuals": law.residuals,
            "stretches": list(law.stretches),
            "edge_mm": law.edge_mm,
            "cells": len(law.samples),
            "cells_without_answer": [
                {name: value for name, value in sample.items() if name != "sample"} for sample in problems
            ],
        }
    )


def cells_csv(law: Law) -> str:
    """CSV with one line for each cell. Eigenvalues are in N/mm, the lowest over the directions.

    "tight" marks stars that are not scale-separated (`law_table.MAX_SEPARATED_CURL`).
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(CSV_HEADER)
    for cell in law.samples:
        sample = cell["sample"]
        responses = _responses(sample) if sample else ["", cell["problem"]]
        writer.writerow([*(cell[name] for name in TASK_KEYS), *responses])
    return text.getvalue()


def _responses(sample: dict[str, Any]) -> list[Any]:
    curvature = sum(sample["natural_curvature"]) / len(sample["natural_curvature"])
    down_energy = sample["down_energy"]
    return [
        " and ".join(str(n) for n in sample["segments"]),
        "yes",
        f"{sample['lam']:.6f}",
        f"{curvature:.6f}",
        "yes" if abs(curvature) * sample["spacing_mm"] > MAX_SEPARATED_CURL else "no",
        f"{sample['bump_mm']:.4f}",
        "none" if down_energy is None else f"{down_energy:+.4g} N/mm",
        f"{min(sample['natural_bump_mm']):.4f}",
        *(f"{sample[name]:.4g}" for name in ("eigenvalue", "supercell_eigenvalue")),
        *(f"{min(sample[name]):.4g}" for name in ("natural_eigenvalue", "natural_supercell_eigenvalue")),
        f"{sample['anisotropy']:.2g}",
    ]
