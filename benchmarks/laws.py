"""The law that a benchmark takes for a design."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from asterism.homogenize.campaign.workers import default_jobs
from asterism.homogenize.errors import ForeignLaw
from asterism.homogenize.law.law import Law
from asterism.laws.calibrate import calibrate
from asterism.laws.design_law import material_for_design
from asterism.pattern.design.design import Design


def law_of(design: Design, paper: Law) -> Law:
    """The paper's law, or one of the design's own stars where that is for another material."""
    try:
        paper.check(design)
    except ForeignLaw:
        with TemporaryDirectory() as folder:
            return calibrate(material_for_design(design), Path(folder) / "law.npz", default_jobs())
    return paper
