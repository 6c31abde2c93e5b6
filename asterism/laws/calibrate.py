"""`asterism calibrate`: a campaign of unit cells, and the law from their samples."""

from __future__ import annotations

import os
import platform
import sys
import time
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import TextIO

from asterism.laws.law_text import law_lines, without_numbers
from asterism.process import interruption
from asterism.process.version import __version__
from asterism.results.files import OutputError, check_writable, write_file
from equilibrium.compiled import HAVE_NUMBA
from homogenize.campaign.campaign import CampaignProgress, run_campaign
from homogenize.campaign.code_version import code_version
from homogenize.campaign.fit_law import fit_law
from homogenize.law.axes import sizes_text
from homogenize.law.law import WITHOUT_BENDING, Law
from homogenize.law.law_file import law_bytes
from homogenize.law.material import Material
from homogenize.law.plan import CellTask
from pattern.design.errors import DesignError


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
    check_writable(output.parent, output.name)
    versions = _versions()
    folder = samples_folder(output)
    watch = ProgressLine(stream)
    start = time.perf_counter()
    try:
        records = run_campaign(material, folder, jobs, dask, watch.report)
    except OSError as error:
        raise OutputError(f"cannot write {folder}: {(error.strerror or str(error)).lower()}") from None
    finally:
        watch.close()
        # a folder with finished cells is not empty, and stays
        with suppress(OSError):
            folder.rmdir()
    made = {
        "command": command,
        "code": code_version(),
        "versions": versions,
        "machine": {"cores": os.cpu_count(), "machine": platform.machine(), "python": platform.python_version()},
        "cell_seconds": sum(record.seconds for record in records),
        "wall_seconds_of_last_run": time.perf_counter() - start,
    }
    law = fit_law(material, records, made)
    write_file(output, law_bytes(law))
    return law


def _versions() -> dict[str, str]:
    """Versions of the packages that compute the cells."""
    packages = ["numpy", "scipy", *(["numba"] if HAVE_NUMBA else [])]
    return {"asterism": __version__, **{name: version(name) for name in packages}}


def default_jobs() -> int:
    """One process per core that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class ProgressLine:
    """Progress of a campaign on a stream.

    A terminal shows one line that changes; other streams get a line every 4 s. The first failed cell of each
    reason has a line.
    """

    every_s = 4.0

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stderr
        self._live = self._stream.isatty()
        self._open = False
        self._next = 0.0
        self._reasons: set[str] = set()

    def report(self, progress: CampaignProgress) -> None:
        """Show the progress, at the beginning and after each cell."""
        interruption.check()
        record = progress.last
        if record is not None and record.failed is not None:
            self._failed(record.task, record.failed)
        if self._live:
            self._stream.write("\r\x1b[K" + _state(progress))
            self._stream.flush()
            self._open = True
        elif time.monotonic() >= self._next or progress.done == progress.total:
            self._next = time.monotonic() + self.every_s
            self._line(_state(progress))

    def _failed(self, task: CellTask, problem: str) -> None:
        """Name the first cell that fails for a reason: the others differ from it by their numbers."""
        if (reason := without_numbers(problem)) not in self._reasons:
            self._reasons.add(reason)
            self._line(f"  no answer: stretch {task.stretch:g}, {sizes_text(task.sizes)}: {problem}")

    def close(self) -> None:
        """Move the terminal to a new line."""
        if self._open:
            self._stream.write("\n")
            self._open = False

    def _line(self, text: str) -> None:
        self._stream.write(("\r\x1b[K" if self._open else "") + text + "\n")
        self._stream.flush()
        self._open = False


def _state(progress: CampaignProgress) -> str:
    text = f"  {progress.done} of {progress.total} cells"
    if progress.failed:
        text += f", {progress.failed} without an answer"
    if progress.seconds_left is not None and progress.done < progress.total:
        minutes, seconds = divmod(round(progress.seconds_left), 60)
        text += f", about {minutes} min {seconds:02d} s left"
    return text


def calibration_lines(law: Law, output: Path) -> list[str]:
    """Lines that the command prints at its end."""
    return [*law_lines(law), f"{output}: the law; its cells stay in {samples_folder(output)}"]
