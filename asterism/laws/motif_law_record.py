"""The summary of the law of a motif, and its cells as a table."""

from __future__ import annotations

import csv
import io

import numpy as np

from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.motif_law_file import motif_law_digest
from asterism.results.records.motif_law import MotifLawRecord


def motif_law_record(law: MotifLaw) -> MotifLawRecord:
    """The summary of the law of a motif."""
    return MotifLawRecord.from_json(
        {
            "plan": law.plan.to_dict(),
            "digest": motif_law_digest(law),
            "made": law.made,
            "held_out": law.residuals["held_out"],
            "edge_mm": law.edge_mm,
            "cells": len(law.samples),
            "cells_without_law": [
                {"sizes_mm": each["sizes"], "held_out": each["held_out"], "problem": each["problem"]}
                for each in law.samples
                if each["problem"] is not None
            ],
        }
    )


def motif_cells_csv(law: MotifLaw) -> str:
    """CSV with one line for each cell: sizes in mm, principal stretches, natural curvatures by direction in 1/mm."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    keys = [f"{size.key}_of_lines_{'_'.join(map(str, size.lines))}" for size in law.plan.sizes]
    samples = [each for each in law.samples if each["sample"] is not None]
    angles = sorted(
        {round(np.degrees(tube["direction_rad"])) for each in samples for tube in each["sample"]["directions"]}
    )
    header = [*keys, "held_out", "law", "smaller_stretch", "larger_stretch"]
    writer.writerow([*header, *(f"natural_curvature_around_{angle}_deg_per_mm" for angle in angles)])
    for each in law.samples:
        row = [*each["sizes"], each["held_out"], each["problem"] or "yes"]
        if (sample := each["sample"]) is not None:
            row += [f"{stretch:.6f}" for stretch in np.linalg.eigvalsh(sample["deformation"])]
            tubes = {round(np.degrees(tube["direction_rad"])): tube["curvature"] for tube in sample["directions"]}
            row += [f"{tubes[angle]:.6f}" if angle in tubes else "" for angle in angles]
        writer.writerow(row)
    return text.getvalue()
