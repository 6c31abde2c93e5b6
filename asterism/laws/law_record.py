"""The summary of a law."""

from __future__ import annotations

from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import law_digest
from asterism.results.records.law import LawRecord


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
