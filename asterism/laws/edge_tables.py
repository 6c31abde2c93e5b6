"""`asterism law edges`: a law with cells of other mesh edges, see `homogenize.law.mesh_edges`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TextIO

from asterism.homogenize.campaign.campaign import run_campaign
from asterism.homogenize.campaign.fit_law import fit_law
from asterism.homogenize.errors import CampaignError
from asterism.homogenize.law.axes import LENGTH, MAX_BRIDGED_LENGTH_RATIO, THICKNESS, WIDTH
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import law_bytes
from asterism.homogenize.law.material import Material
from asterism.homogenize.law.mesh_edges import EdgeTables
from asterism.homogenize.law.plan import MIN_CELL_EDGE_MM
from asterism.laws.calibrate import law_written, solving_cells
from asterism.results.files import write_file

# mesh edges between adjacent stars: arms of ninths of the spacing lie on all of these meshes. Sheets with edges of 2 mm
# have the first; of finer cells than the last each takes more than half a minute
EDGE_COUNTS = (9, 27, 36)
LENGTH_STEPS = 9


def add_edges(
    law: Law,
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

    `Law.at_edge` then gives it on other meshes. Cells of other edges that it has already stay.

    Parameters
    ----------
    output, jobs, dask, stream : as of `asterism.laws.calibrate.calibrate`.
    edges_mm, stretch, lengths_mm, thicknesses_mm : as of `edge_materials`.

    Raises
    ------
    CampaignError, AddressError
        As of `edge_materials`, `run_campaign` and `fit_law`.
    """
    edges = []
    with solving_cells(output, stream) as (folder, report):
        for material in edge_materials(law, edges_mm, stretch, lengths_mm, thicknesses_mm):
            fitted = fit_law(material, run_campaign(material, folder, jobs, dask, report))
            edges.append(EdgeTables(material.plan.edge_mm, fitted.tables))
    added = {each.edge_mm for each in edges}
    new = replace(law, edges=(*(each for each in law.edges if each.edge_mm not in added), *edges))
    write_file(output, law_bytes(new))
    return new


def edge_materials(
    law: Law,
    edges_mm: Sequence[float] | None = None,
    stretch: float | None = None,
    lengths_mm: tuple[float, float] | None = None,
    thicknesses_mm: tuple[float, float] | None = None,
) -> list[Material]:
    """The material of a law with the plan of coarser grids of cells, one for each other edge of the mesh.

    Lengths are ninths of the spacing within the range of the law, or its ends if it has fewer than two of them;
    thicknesses are those of the law, and of several widths the middle one is taken.

    Parameters
    ----------
    edges_mm : edges of the cells, rounded so that ninths of the spacing lie on the mesh; by default those of
        `EDGE_COUNTS`.
    stretch : of the cells; all stretches of the law by default.
    lengths_mm, thicknesses_mm : smallest and largest size of the cells; all of the law by default.

    Raises
    ------
    CampaignError
        The law has scattered cells, no node in the range, or a mesh with the edge length of one of the others.

    Examples
    --------
    >>> from asterism.homogenize.law.law_file import load_law
    >>> for material in edge_materials(load_law(), [1.9, 0.64], 1.35, thicknesses_mm=(0.26, 0.46)):
    ...     print(material.plan.edge_mm, material.plan.lengths_mm, len(material.tasks()))
    1.9245 (3.849, 5.7735, 7.698, 9.6225, 11.547) 31
    0.6415 (3.849, 5.7735, 7.698, 9.6225, 11.547) 31
    """
    plan, spacing = law.material.plan, law.material.lattice.spacing_mm
    if plan.kind != "grid":
        raise CampaignError("cells of other mesh edges need a law whose plan is a grid")
    counts = [LENGTH_STEPS * max(1, round(spacing / each / LENGTH_STEPS)) for each in edges_mm or ()] or EDGE_COUNTS
    edges = [round(spacing / count, 4) for count in sorted(set(counts))]
    if round(spacing / plan.edge_mm) in counts or edges[-1] < MIN_CELL_EDGE_MM:
        others = " and ".join(f"{edge:g}" for edge in edges)
        raise CampaignError(
            f"the law has edges of {plan.edge_mm:g} mm: they must differ from those of its new cells, {others} mm"
        )
    if stretch is not None and not any(abs(each - stretch) < 1e-6 for each in law.stretches):
        raise CampaignError(f"--stretch: must be one of {', '.join(f'{each:g}' for each in law.stretches)}")
    low, high = thicknesses_mm or (0.0, math.inf)
    thickness = [each for each in plan.nodes(THICKNESS) if low <= each <= high]
    if not thickness:
        raise CampaignError(f"--thickness: the law has no thickness from {low:g} to {high:g} mm")
    lengths, width = [each for each in plan.nodes(LENGTH) if each > 0.0], plan.nodes(WIDTH)
    steps = [round(n * spacing / LENGTH_STEPS, 4) for n in range(1, LENGTH_STEPS + 1)]
    shortest = max(lengths[0], MAX_BRIDGED_LENGTH_RATIO * spacing)
    within = [each for each in steps if shortest <= each <= lengths[-1]]
    if lengths_mm is not None:
        within = [each for each in within if lengths_mm[0] <= each <= lengths_mm[1]]
        if not within:
            raise CampaignError(f"--length: no ninth of the spacing from {lengths_mm[0]:g} to {lengths_mm[1]:g} mm")
    starts_at_fabric = lengths[0] <= MAX_BRIDGED_LENGTH_RATIO * spacing
    chosen = {
        LENGTH.nodes_key: within
        if starts_at_fabric and len(within) > 1
        else sorted({lengths[0], *within, lengths[-1]}),
        THICKNESS.nodes_key: thickness,
        WIDTH.nodes_key: [width[len(width) // 2]],
    }
    data = law.material.to_dict()
    stretches = list(law.stretches) if stretch is None else [stretch]
    data["fabric"].pop("stretch", None)
    rest = {key: value for key, value in data["plan"].items() if key != "stretches"}
    return [
        Material.from_dict(data | {"plan": rest | chosen | {"stretches": stretches, "edge_mm": edge, "held_out": 0}})
        for edge in edges
    ]


def edge_lines(law: Law, output: Path) -> list[str]:
    """Lines that the command prints at its end: the edges, and how many cells of each have an answer."""
    lines = [
        f"edges of {each.edge_mm:g} mm, stretch {table.stretch:g}: {int(table.solved[1:].sum())} of "
        f"{table.solved[1:].size} cells have an answer"
        for each in law.edges
        for table in each.tables
    ]
    return [*lines, law_written(output)]
