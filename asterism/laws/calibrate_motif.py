"""`asterism calibrate` for a design with a motif: the cells of its law, and the law from them."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TextIO

from asterism.homogenize.campaign.fit_motif_law import fit_motif_law
from asterism.homogenize.campaign.motif_campaign import SolveMotif, motif_code_version, run_motif_campaign
from asterism.homogenize.campaign.motif_design_plan import plan_for_motif
from asterism.homogenize.cell.motif_responses import motif_responses
from asterism.homogenize.law.material import Material
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.motif_law_file import motif_law_bytes
from asterism.homogenize.law.motif_plan import MotifPlan
from asterism.laws.calibrate import law_written, origin, solving_cells
from asterism.laws.design_law import is_design, material_from_file
from asterism.laws.motif_law_text import motif_law_lines
from asterism.laws.replace_material import Note, with_material
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.load_design import load_design
from asterism.results.files import write_file


def plan_from_file(file: Path | None, other: Path | None = None, note: Note | None = None) -> Material | MotifPlan:
    """The cells of the law of a material, of a design's stars, or of a design's motif.

    Parameters
    ----------
    file, other, note : as of `material_from_file`.

    Raises
    ------
    DesignError
        The file is wrong, or there is no law of its material or pattern.
    """
    if file is None or not is_design(file) or (design := load_design(file)).rods is None:
        return material_from_file(file, other, note)
    try:
        return plan_for_motif(with_material(design, other, note))
    except DesignError as error:
        raise error.within(file) from None


def calibrate_motif(
    plan: MotifPlan,
    output: Path,
    jobs: int = 1,
    dask: str | None = None,
    command: str = "asterism in Python",
    stream: TextIO | None = None,
    respond: SolveMotif = motif_responses,
) -> MotifLaw:
    """Solve the plan's cells, those that are not there yet, fit the law and write it.

    Parameters
    ----------
    plan : of a design, see `homogenize.campaign.motif_design_plan`.
    output, jobs, dask, command, stream : as of `asterism.laws.calibrate.calibrate`.
    respond : solves a cell.

    Raises
    ------
    AddressError
        No cluster answers at the address.
    CampaignError
        No cell has a law, or the workers have ended.
    """
    start = time.perf_counter()
    with solving_cells(output, stream) as (folder, report):
        records = run_motif_campaign(plan, folder, jobs, dask, report, respond)
    made = origin(command, start, sum(record.seconds for record in records)) | {"code": motif_code_version()}
    law = fit_motif_law(plan, records, made)
    write_file(output, motif_law_bytes(law))
    return law


def motif_calibration_lines(law: MotifLaw, output: Path) -> list[str]:
    """Lines that the command prints at its end."""
    return [*motif_law_lines(law), law_written(output)]
