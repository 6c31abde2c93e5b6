"""How far the membrane response of a sheet is from linear: natural tubes pulled and pushed, and strains in shells.

python -m benchmarks.membrane
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.equilibrium.newton.minimise import minimise
from asterism.homogenize.cell.flat_cell import cell_gradient_tolerance, relax_flat_cell
from asterism.homogenize.cell.natural_curvature import trace_tubes
from asterism.homogenize.cell.rolling import Tube
from asterism.homogenize.cell.tube_membrane import tube_membrane_stiffness
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern import gallery
from asterism.previews.session import Preview
from benchmarks.cells import sheet
from benchmarks.report import markdown, write_report

DESIGNS = ("tube", "dome", "fig8-l-decreasing", "fig8-h-increasing", "doubly-curved", "bell", "fig9-linear", "roof")
STARS = ((4.6188, 0.3), (6.9282, 0.3), (9.2376, 0.3), (6.9282, 0.4), (10.3923, 0.4), (10.3923, 0.5), (10.3923, 0.6))
STRAINS = (-0.04, -0.02, -0.01, 0.01, 0.02, 0.04)
EDGE = 1.15


def main() -> None:
    rows = [secants(length, thickness) for length, thickness in STARS]
    header = ["star, mm", "tangent N/mm", *(f"{100 * strain:+g} %" for strain in STRAINS)]
    body = [
        [f"h {r['thickness_mm']:g}, l {r['length_mm']:.2f}", f"{r['tangent']:.2f}"]
        + ["-" if value is None else f"{value:.2f}" for value in r["secant"]]
        for r in rows
    ]
    text = (
        "Secant over tangent of natural tubes that are pulled along their axes, their radii free; the strain is what\n"
    )
    text += f"the tangent says. Stretch 1.35, edges of {EDGE} mm.\n\n{markdown(header, body)}\n\n"
    used = [strains(name) for name in DESIGNS]
    header = ["design", "least", "1st percentile", "median", "99th percentile", "largest", "minimum"]
    body = [[r["design"], *(f"{v:+.2f}" for v in r["percent"]), "yes" if r["minimum"] else "no"] for r in used]
    text += "Membrane strains that shells with this law use, in percent: principal strains over the metric at rest,\n"
    text += f"over the printed area.\n\n{markdown(header, body)}"
    rows += used
    write_report("membrane", rows, text)
    print(text)


def strains(name: str) -> dict[str, Any]:
    """Percentiles of both principal strains over a sheet of the gallery, without those that its curvature asks for."""
    preview = Preview(gallery.load(name))
    shell, found = preview.shell, preview.equilibrium
    membrane = shell.density.stiffness[..., :3, :3]  # type: ignore[index]
    tension = shell.density(found.strains)[1][..., :3]
    strain, rest = np.linalg.solve(membrane, tension[..., None])[..., 0], shell.rest
    middle = 0.5 * (strain[..., 0] + strain[..., 1])
    radius = np.hypot(0.5 * (strain[..., 0] - strain[..., 1]), 0.5 * strain[..., 2])
    metric = 2.0 * np.stack([rest[..., 0], rest[..., 0]])
    both = 100.0 * np.stack([middle - radius, middle + radius]) / metric
    area = np.broadcast_to(shell.assembly.weights, both.shape).ravel()
    order = np.argsort(both.ravel())
    share = np.cumsum(area[order]) / area.sum()
    percent = [float(np.interp(q, share, both.ravel()[order])) for q in (0.0, 0.01, 0.5, 0.99, 1.0)]
    return {"design": name, "percent": percent, "minimum": found.is_minimum}


def secants(length: float, thickness: float) -> dict[str, Any]:
    """The natural tube around the print's y axis."""
    cell = UnitCell(sheet(length, thickness), EDGE)
    found = trace_tubes(cell, relax_flat_cell(cell)[0], 0.0)
    tube = found.natural or found.tubes[0]
    modulus = float(1.0 / np.linalg.inv(tube_membrane_stiffness(cell, tube))[0, 0])
    ratios = {}
    for side in (-1.0, 1.0):
        ratios |= _along(cell, tube, modulus, [strain for strain in STRAINS if strain * side > 0])
    cell.close()
    return {
        "length_mm": length, "thickness_mm": thickness, "tangent": modulus, "strain": STRAINS,
        "secant": [ratios[strain] for strain in STRAINS],
    }  # fmt: skip


def _along(cell: UnitCell, tube: Tube, modulus: float, strains: list[float]) -> dict[float, float | None]:
    """Secant over tangent at growing pulls; None where there is no equilibrium."""
    cell.set_tube(tube.curvature, tube.angle)
    macro = slice(3 * cell.mesh.n_base, None, 3)
    share = np.linalg.inv(cell.cell_vectors)[0]  # of the two axial shifts in the stretch
    found: dict[float, float | None] = dict.fromkeys(strains)
    state = tube.state
    for strain in sorted(strains, key=abs):
        pull = modulus * strain * tube.axial  # N/mm per printed length, conjugate to the stretch
        cell.load = np.zeros(3 * cell.n_vertices)
        cell.load[macro] = pull * cell.area * share
        at = minimise(cell, state, cell.factor(), cell_gradient_tolerance(cell))
        if not at.converged:
            break
        state = at.state
        stretch = float(share @ state.positions.ravel()[macro])
        found[strain] = float(pull / stretch / (0.5 * (stretch**2 - tube.axial**2)) / modulus)
    cell.load = np.zeros(3 * cell.n_vertices)
    return found


if __name__ == "__main__":
    main()
