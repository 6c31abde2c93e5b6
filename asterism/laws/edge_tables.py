"""`asterism law edges`: a law with cells of other mesh edges."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

from asterism.homogenize.campaign.edge_campaign import with_edges
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import law_bytes, load_law
from asterism.laws.calibrate import law_written, solving_cells
from asterism.results.files import write_file


def add_edges(
    path: Path | None,
    output: Path,
    jobs: int = 1,
    dask: str | None = None,
    stream: TextIO | None = None,
    edges_mm: Sequence[float] | None = None,
    stretch: float | None = None,
    lengths_mm: tuple[float, float] | None = None,
    thicknesses_mm: tuple[float, float] | None = None,
) -> Law:
    """Solve the cells of a law on meshes of other edge lengths, those that are not there yet, and write the law.

    Parameters
    ----------
    path : file of the law; None for the law of the paper's material.
    output, jobs, dask, stream : as of `asterism.laws.calibrate.calibrate`.
    edges_mm, stretch, lengths_mm, thicknesses_mm : as of `homogenize.campaign.edge_campaign.edge_materials`.

    Raises
    ------
    LawError
        The file is not a law.
    CampaignError, AddressError
        As of `with_edges`.
    """
    law = load_law(path)
    with solving_cells(output, stream) as (folder, report):
        new = with_edges(law, folder, jobs, dask, report, edges_mm, stretch, lengths_mm, thicknesses_mm)
    write_file(output, law_bytes(new))
    return new


def edge_lines(law: Law, output: Path) -> list[str]:
    """Lines that the command prints at its end: the edges, and how many cells of each have an answer."""
    lines = [
        f"edges of {each.edge_mm:g} mm, stretch {table.stretch:g}: {int(table.solved[1:].sum())} of "
        f"{table.solved[1:].size} cells have an answer"
        for each in law.edges
        for table in each.tables
    ]
    return [*lines, law_written(output)]
