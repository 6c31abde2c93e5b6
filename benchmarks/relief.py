"""Relief by the rules of the preview and by the linear response of its cells, on rolled cells and on exact sheets.

python -m benchmarks.relief [CANOPIES FROZEN] [--write]

Cells: a star's cell is rolled to half and to all of its natural curvature. The response (`benchmarks.relief_response`)
is made of the flat cell and of natural tubes in six directions; the direction of 15 degrees is none of them. The rules
of the preview (`asterism.previews.corrugation`) act on a sheet of such stars, rolled to the tube of the cell. Errors
are root mean squares over the printed area, in % of that of the cell's own relief.

Sheets: CANOPIES keeps exact shapes of `benchmarks.accuracy.canopy_sweep`, FROZEN those of `benchmarks.frozen.solve`
(the first 80 designs); with both, designs of equal three-armed stars are compared that have exact shapes. Both reliefs
lie on the same equilibrium of the shell, at the vertices of the exact mesh. The last line takes the fields of the
response as sums of waves as long as those that the law has for the corrugation. --write puts both tables into
benchmarks/results.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.threads import one_blas_thread
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.pattern.design.design import Design
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.session import Preview
from asterism.previews.surface.surface import Lens
from asterism.shape.comparison import compare_shapes
from benchmarks.accuracy.canopy_sweep import swept
from benchmarks.accuracy.designs import EDGE_MM
from benchmarks.accuracy.exact import lowest
from benchmarks.cells import sheet
from benchmarks.frozen.draw import HALVES, frozen
from benchmarks.frozen.solve import frozen_law, is_solved
from benchmarks.relief_response import CellResponse, ResponseLens, RolledRelief, cell_response, laid, print_axes
from benchmarks.report import markdown, write_report

STARS = ((4.6188, 0.4), (6.0, 0.3), (6.0, 0.4), (7.5, 0.3), (7.5, 0.4), (9.0, 0.3), (9.0, 0.4), (10.3923, 0.38))  # mm
UNFITTED_DEG = 15.0
STATES = ("flat", "half", "natural", "natural, 15 degrees")
RINGS = 3  # of the rolled sheet: its rim does not reach the middle star
RULES, RESPONSE, WAVES = "rules of the preview", "linear response", "linear response in the law's waves"
MEASURES = {
    "rms_percent": "rms %", "whole_percent": "rms of the sheet with its bumps %", "bumps_percent": "bumps %",
    "height_percent": "height %",
}  # fmt: skip


@one_blas_thread()
def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="*", type=Path, metavar="FOLDER")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    if len(options.folders) not in (0, 2):
        parser.error("give both folders, CANOPIES and FROZEN, or none")
    cells, sheets = [cell_row(*star) for star in STARS], []
    if options.folders:
        for design, folder in compared(*options.folders):
            sheets.append(sheet_row(design, folder))
            print(line(sheets[-1]), flush=True)
    text = tables(cells, sheets)
    print(text)
    if options.write:
        write_report("relief", cells + sheets, text, command="python -m benchmarks.relief CANOPIES FROZEN --write")


def tables(cells: Sequence[dict[str, Any]], sheets: Sequence[dict[str, Any]]) -> str:
    """Markdown: the cells, and the sheets if there are any."""
    text = f"Cells with edges of {EDGE_MM:.2f} mm: errors in % of the relief, in brackets of its components along the\n"
    text += f"sheet and of its heights.\n\n{cell_table(cells)}"
    if sheets:
        text += f"\n\nMedian and mean errors of {len(sheets)} sheets:\n\n{sheet_table(sheets)}"
    return text


def cell_row(length: float, thickness: float) -> dict[str, Any]:
    """Errors of both reliefs on the cell of a star, by state."""
    star = sheet(length, thickness)
    response = cell_response(star, EDGE_MM, (0.5,), (UNFITTED_DEG,))
    flat = RolledRelief(0.0, 0.0, 0.0, response.deformation, response.fields[0])
    fitted = [each for each in response.rolled if each.degrees != UNFITTED_DEG]
    natural = [each for each in fitted if each.part == 1.0]
    halves = [each for each in fitted if each.part != 1.0]
    other = [each for each in response.rolled if each.degrees == UNFITTED_DEG and each.part == 1.0]
    preview = Preview(Design.from_dict(star.to_dict() | {"border": {"rings": RINGS}}))
    errors = {
        name: np.mean([cell_errors(preview, response, each) for each in rolled], axis=0).tolist()
        for name, rolled in zip(STATES, ([flat], halves, natural, other), strict=True)
    }
    turn = response.natural_curvature * star.lattice.spacing_mm
    return {"length_mm": length, "thickness_mm": thickness, "turn_rad": turn, "errors": errors}


def cell_errors(preview: Preview, response: CellResponse, rolled: RolledRelief) -> list[list[float]]:
    """Errors of rules and response in % of the relief: of all components, along the sheet, and of heights."""
    plan, bend = preview.sheet.layout, rolled.deformation
    middle = plan.centres[np.linalg.norm(plan.centres - plan.centres.mean(axis=0), axis=1).argmin()]

    def plane(points: Floats) -> Floats:
        out = np.zeros((len(points), 6, 2))
        out[:, 0], out[:, 1:3] = (points - middle) @ bend.T, bend.T
        return out

    tube = SimpleShape("arc", -rolled.curvature, np.radians(rolled.degrees) + np.pi / 2.0)
    x = tube.over(preview.sheet.space, plane)
    places = Lens(preview.sheet, preview.law.waves, middle + response.points)(x, preview.values)
    smooth, weights = places.surface, response.weights
    axes = np.concatenate([print_axes(smooth), smooth.normals[:, None]], axis=1)

    def local(bumps: Floats) -> Floats:
        parts = np.einsum("nic,nc->ni", axes, bumps)
        return np.asarray(parts - weights @ parts)

    right = local(laid(smooth, rolled.relief))
    linear = response.fields[0] + np.tensordot(rolled.components, response.fields[1:], axes=1)
    squares = [weights @ (local(bumps) - right) ** 2 for bumps in (places.bumps, laid(smooth, linear))]
    size = float((weights @ right**2).sum())
    return [[100.0 * np.sqrt(part / size) for part in (s.sum(), s[:2].sum(), s[2])] for s in squares]


def compared(canopies: Path, first: Path) -> Iterator[tuple[Design, Path]]:
    """Designs of equal three-armed stars with exact shapes, and the folder of these."""
    kept = [(design, canopies) for design in swept()]
    kept += [(design, first) for half in HALVES for _, design in frozen(half) if design.lattice.arms == 3]
    for design, folder in kept:
        stars = design.required_stars
        sizes = (stars.length_mm, stars.thickness_mm, stars.width_mm)
        if is_solved(design, folder) and not stars.override and all(isinstance(size, int | float) for size in sizes):
            yield design, folder


def sheet_row(design: Design, folder: Path) -> dict[str, Any]:
    """Errors of the preview's sheet with each relief."""
    reference = lowest(design, folder)
    law = frozen_law(design, folder)
    preview = Preview(design, law)
    x, plan, same, mean = preview.state.x, preview.sheet.layout, symmetries(design, preview.sheet.layout), None
    response = cell_response(design, design.mesh.edge_mm)
    lenses: dict[str, Lens | ResponseLens] = {RULES: Lens(preview.sheet, law.waves, reference.printed)} | {
        name: ResponseLens(preview.sheet, reference.printed, fields, response.natural_curvature)
        for name, fields in ((RESPONSE, response.by_points), (WAVES, response.by_waves))
    }
    errors = {}
    for name, lens in lenses.items():
        shape = replace(reference, positions=lens(x, preview.values).bumpy)
        comparison = compare_shapes(reference, shape, plan, same, design.gravity.pull, mean)
        mean = comparison.mean
        gaps = comparison.other.at(reference.printed) - reference.positions
        whole = np.sqrt(reference.weights @ (gaps**2).sum(axis=1))
        height, other = comparison.heights_mm
        errors[name] = {
            "rms_percent": comparison.rms_percent,
            "whole_percent": float(100.0 * whole / comparison.diameter_mm),
            "bumps_percent": comparison.relief_error_percent,
            "height_percent": 100.0 * abs(other / height - 1.0),
        }
    return {"design": design.name, "errors": errors}


def cell_table(rows: Sequence[dict[str, Any]]) -> str:
    """Markdown; errors along the sheet and of heights in brackets."""
    header = ["star, mm", "kappa d", *(f"{state}: {kind}" for state in STATES for kind in ("rules", "response"))]
    body = [
        [f"l {row['length_mm']:.2f}, h {row['thickness_mm']:g}", f"{row['turn_rad']:.2f}"]
        + [f"{a:.1f} ({b:.1f}, {c:.1f})" for state in STATES for a, b, c in row["errors"][state]]
        for row in rows
    ]
    return markdown(header, body)


def sheet_table(rows: Sequence[dict[str, Any]]) -> str:
    """Markdown, one line for each relief."""
    body = []
    for name in (RULES, RESPONSE, WAVES):
        of = {key: np.array([row["errors"][name][key] for row in rows], dtype=float) for key in MEASURES}
        body.append([name, *(f"{np.nanmedian(each):.2f}, {np.nanmean(each):.2f}" for each in of.values())])
    return markdown(["relief", *MEASURES.values()], body)


def line(row: dict[str, Any]) -> str:
    """The errors of a sheet by each relief."""
    errors = row["errors"].items()
    return f"{row['design']:<24} " + "; ".join(
        f"{name}: " + ", ".join(f"{value or np.nan:.2f}" for value in each.values()) for name, each in errors
    )


if __name__ == "__main__":
    main()
