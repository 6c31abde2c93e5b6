"""`asterism calibrate`: a campaign of unit cells of a star or a motif, and the law from their samples."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any, TextIO

from asterism.homogenize.campaign.campaign import CampaignProgress, SampleRecord, run_campaign
from asterism.homogenize.campaign.code_version import code_version
from asterism.homogenize.campaign.fit_law import fit_law
from asterism.homogenize.campaign.fit_motif_law import fit_motif_law
from asterism.homogenize.campaign.motif_campaign import MotifRecord, SolveMotif, motif_code_version, run_motif_campaign
from asterism.homogenize.campaign.motif_design_plan import plan_for_motif
from asterism.homogenize.cell.motif_responses import motif_responses
from asterism.homogenize.law.any_law import AnyLaw
from asterism.homogenize.law.law import WITHOUT_BENDING, Law
from asterism.homogenize.law.law_file import law_bytes
from asterism.homogenize.law.material import Material
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.motif_law_file import motif_law_bytes
from asterism.homogenize.law.motif_plan import MotifPlan
from asterism.laws.design_law import is_design, material_from_file
from asterism.laws.law_text import law_lines
from asterism.laws.motif_law_text import motif_law_lines
from asterism.laws.replace_material import Note, with_material
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.load_design import load_design
from asterism.process.count_line import CountLine
from asterism.process.version import __version__
from asterism.results.files import OutputError, check_folder, check_writable, write_file


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


def samples_folder(law: Path) -> Path:
    """Folder of the finished cells of a law."""
    return law.with_suffix(".samples")


def calibrate(
    material: Material,
    output: Path,
    jobs: int = 1,
    dask: str | None = None,
    command: str = "asterism in Python",
    stream: TextIO | None = None,
) -> Law:
    """Solve the plan's cells, those that are not there yet, fit the law and write it.

    Parameters
    ----------
    material : with its plan, see `asterism.laws.design_law`.
    jobs : processes of this machine.
    dask : address of a scheduler to use in their place.
    command : that the law's file names as its origin.
    stream : where progress is printed; standard error by default.

    Raises
    ------
    DesignError
        There is no law of such a material.
    AddressError
        No cluster answers at the address.
    CampaignError
        There is no law: too many cells without an answer, or workers that have ended.
    """
    if not material.fabric.has_bending:
        raise DesignError("fabric.bending", WITHOUT_BENDING, material.fabric.bending)
    start = time.perf_counter()
    with solving_cells(output, stream) as (folder, report):
        records = run_campaign(material, folder, jobs, dask, report)
    made = _origin(command, code_version(), start, records)
    law = fit_law(material, records, made)
    write_file(output, law_bytes(law))
    return law


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
    output, jobs, dask, command, stream : as of `calibrate`.
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
    made = _origin(command, motif_code_version(), start, records)
    law = fit_motif_law(plan, records, made)
    write_file(output, motif_law_bytes(law))
    return law


@contextmanager
def solving_cells(output: Path, stream: TextIO | None) -> Iterator[tuple[Path, Callable[[CampaignProgress], None]]]:
    """The folder of the cells of a law and a listener of their progress; without finished cells the folder goes again.

    Raises
    ------
    OutputError
        The law or the folder cannot be written; the first is known before the block.
    """
    check_writable(output.parent, output.name)
    folder = samples_folder(output)
    check_folder(folder)
    try:
        with ProgressLine(stream) as watch:
            yield folder, watch.report
    except OSError as error:
        raise OutputError(f"cannot write {folder}: {(error.strerror or str(error)).lower()}") from None
    finally:
        with suppress(OSError):  # a folder with finished cells is not empty, and stays
            folder.rmdir()


def _origin(command: str, code: str, start: float, records: Sequence[SampleRecord | MotifRecord]) -> dict[str, Any]:
    """What made a law, for its file.

    Parameters
    ----------
    code : version of the code that solves its cells.
    start : time of `time.perf_counter` when the campaign began.
    """
    return {
        "command": command,
        "code": code,
        "versions": {"asterism": __version__, **{name: version(name) for name in ("numpy", "scipy", "numba")}},
        "machine": {"cores": os.cpu_count(), "machine": platform.machine(), "python": platform.python_version()},
        "cell_seconds": sum(record.seconds for record in records),
        "wall_seconds_of_last_run": time.perf_counter() - start,
    }


class ProgressLine(CountLine):
    """Progress of a campaign on a stream."""

    def __init__(self, stream: TextIO | None = None) -> None:
        super().__init__("cells", stream)

    def report(self, progress: CampaignProgress) -> None:
        """Show the progress, at the beginning and after each cell."""
        record = progress.last
        if record is not None and record.failed is not None:
            self.failed(record.label, record.failed)
        self.show(progress.done, progress.total, progress.failed, progress.seconds_left)


def calibration_lines(law: AnyLaw, output: Path) -> list[str]:
    """Lines that the command prints at its end."""
    lines = motif_law_lines(law) if isinstance(law, MotifLaw) else law_lines(law)
    return [*lines, law_written(output)]


def law_written(output: Path) -> str:
    """The line that names the file of a new law."""
    return f"{output}: the law; its cells stay in {samples_folder(output)}"
