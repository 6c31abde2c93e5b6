"""`asterism calibrate`: a campaign of unit cells, and the law from their samples."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any, TextIO

from asterism.homogenize.campaign.campaign import CampaignProgress, run_campaign
from asterism.homogenize.campaign.code_version import code_version
from asterism.homogenize.campaign.fit_law import fit_law
from asterism.homogenize.law.law import WITHOUT_BENDING, Law
from asterism.homogenize.law.law_file import law_bytes
from asterism.homogenize.law.material import Material
from asterism.laws.law_text import law_lines
from asterism.pattern.design.errors import DesignError
from asterism.process.count_line import CountLine
from asterism.process.version import __version__
from asterism.results.files import OutputError, check_folder, check_writable, write_file


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
    made = origin(command, start, sum(record.seconds for record in records))
    law = fit_law(material, records, made)
    write_file(output, law_bytes(law))
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


def origin(command: str, start: float, cell_seconds: float) -> dict[str, Any]:
    """What made a law, for its file.

    Parameters
    ----------
    start : time of `time.perf_counter` when the campaign began.
    cell_seconds : sum of the wall times of its cells.
    """
    return {
        "command": command,
        "code": code_version(),
        "versions": package_versions(),
        "machine": {"cores": os.cpu_count(), "machine": platform.machine(), "python": platform.python_version()},
        "cell_seconds": cell_seconds,
        "wall_seconds_of_last_run": time.perf_counter() - start,
    }


def package_versions() -> dict[str, str]:
    """Versions of the packages that compute the cells."""
    return {"asterism": __version__, **{name: version(name) for name in ("numpy", "scipy", "numba")}}


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


def calibration_lines(law: Law, output: Path) -> list[str]:
    """Lines that the command prints at its end."""
    return [*law_lines(law), law_written(output)]


def law_written(output: Path) -> str:
    """The line that names the file of a new law."""
    return f"{output}: the law; its cells stay in {samples_folder(output)}"
