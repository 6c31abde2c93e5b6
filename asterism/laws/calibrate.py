"""`asterism calibrate`: a campaign of unit cells of a star or a motif, and the law from their samples."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, TextIO

from asterism.homogenize.campaign.campaign import SolveCell, run_campaign
from asterism.homogenize.campaign.fit_law import fit_law
from asterism.homogenize.campaign.kept_samples import cells_folder, code_version
from asterism.homogenize.law.law_file import law_bytes
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.plan import LawPlan, SampleRecord, without_law
from asterism.homogenize.law.star_law import StarLaw
from asterism.process.progress import CountLine
from asterism.process.version import __version__
from asterism.results.files import OutputError, check_writable, write_file


def calibrate(
    plan: LawPlan,
    output: Path,
    jobs: int = 1,
    dask: str | None = None,
    command: str = "asterism in Python",
    stream: TextIO | None = None,
    respond: SolveCell | None = None,
) -> StarLaw | MotifLaw:
    """Solve the plan's cells, those that are not there yet, fit the law and write it.

    Parameters
    ----------
    plan : of a material or of a design, see `asterism.laws.from_files`.
    jobs : processes of this machine.
    dask : address of a scheduler to use in their place.
    command : that the law's file names as its origin.
    stream : where progress is printed; standard error by default.
    respond : solves a cell, as of `run_campaign`.

    Raises
    ------
    DesignError
        There is no law of such a material.
    AddressError
        No cluster answers at the address.
    CampaignError
        There is no law: too many cells without an answer, or workers that have ended.
    OutputError
        The law or a cell cannot be written.
    """
    if (refused := without_law(plan.design)) is not None:
        raise refused
    check_writable(output.parent, output.name)
    start, folder = time.perf_counter(), cells_folder()
    try:
        with CountLine("cells", stream) as watch:
            records = run_campaign(plan, folder, jobs, dask, watch.report, respond)
    except OSError as error:
        raise OutputError(f"cannot write {folder}: {(error.strerror or str(error)).lower()}") from None
    law = fit_law(plan, records, _origin(command, start, records))
    write_file(output, law_bytes(law))
    return law


def _origin(command: str, start: float, records: Sequence[SampleRecord]) -> dict[str, Any]:
    """What made a law, for its file."""
    return {
        "command": command,
        "code": code_version(),
        "versions": {"asterism": __version__, **{name: version(name) for name in ("numpy", "scipy", "numba")}},
        "machine": {"cores": os.cpu_count(), "machine": platform.machine(), "python": platform.python_version()},
        "cell_seconds": sum(record.seconds for record in records),
        "wall_seconds_of_last_run": time.perf_counter() - start,
    }
