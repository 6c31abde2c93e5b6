"""The files of a verification."""

from __future__ import annotations

from pathlib import Path

from asterism.pattern.design.arguments import check_type
from asterism.print.formats.obj import write_shape_obj
from asterism.reports.verification_page import verification_page
from asterism.results.files import SUMMARY_FILE, staged_result
from asterism.shape.vtu import write_shape_vtu
from asterism.verification.verification import Verification


def write_verification(verification: Verification, directory: str | Path) -> list[str]:
    """Write report.html, summary.json, and exact and preview (laid on the exact shape) as .vtu and .obj.

    The files appear together, or none of them if writing fails.

    Returns
    -------
    Their names.

    Raises
    ------
    OutputError
        They cannot be written there.
    """
    check_type(verification, Verification, "verify makes them")
    with staged_result(directory) as folder:
        # the command line may hold file names that are not valid text
        (folder / "report.html").write_text(
            verification_page(verification), encoding="utf-8", errors="backslashreplace"
        )
        compared = {"exact": verification.comparison.reference, "preview": verification.comparison.other}
        for name, shape in compared.items():
            write_shape_vtu(shape, folder / f"{name}.vtu")
            write_shape_obj(folder / f"{name}.obj", shape, f"{verification.summary['design']['name']}, {name}")
        (folder / SUMMARY_FILE).write_text(verification.summary.json_text())
        return sorted(file.name for file in folder.iterdir())
