"""The summary of a law, and its cells as a table for a spreadsheet: sizes, responses and stability."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np

from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import law_digest
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL
from asterism.results.records.law import LawRecord

STAR_HEADER = (
    "lambda", "natural_curvature_per_mm", "tight", "flat_bump_mm", "flat_other_side", "natural_bump_mm",
    "flat_eigenvalue", "flat_supercell_eigenvalue", "natural_eigenvalue", "natural_supercell_eigenvalue", "anisotropy",
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
    down_energy = sample["down_energy"]
    return [
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
