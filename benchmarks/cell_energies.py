"""The energy of cells over their curvature, against the parabola that the preview makes of it.

python -m benchmarks.cell_energies

Cells are rolled to tubes of given parts of their natural curvature, about two axes. The second fundamental form around
a tube is b = k hoop, with the curvature k and the hoop stretch over the print; x is b over its natural value. The
preview's energy is `D kappa^2 (x^2/2 - x)`, with `D kappa^2` from the natural energy: both agree at x = 0 and 1.
Moments are derivatives by x, over `D kappa^2` too. At the flat cell, moment and tangent come from its linear response.
The moment that the flat cell lacks is `c = 1 + moment at x = 0`, and `c x (1 - x)^2` is the simplest energy with
this moment that leaves the natural tube as it is. A second table gives c from the linear responses of the packaged law.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.threads import one_blas_thread
from asterism.homogenize.cell.effective_stiffness import effective_stiffness
from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.natural_curvature import trace_tubes
from asterism.homogenize.cell.rolling import roll_cell, unroll
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.previews.default_law import paper_law
from benchmarks.cells import sheet
from benchmarks.report import markdown, write_report

# length and thickness in mm
STARS = (
    (4.6188, 0.3), (4.6188, 0.5), (6.9282, 0.3), (6.9282, 0.42), (9.2376, 0.38), (10.3923, 0.3), (10.3923, 0.38),
    (10.3923, 0.5),
)  # fmt: skip
PARTS = (0.25, 0.5, 0.75, 1.0, 1.25)  # of the natural curvature
ANGLES_DEG = (0.0, 30.0)
EDGE_MM, STRETCH, WIDTH_MM = 1.15, 1.35, 1.25
# of the law's table
LENGTHS_MM = (4.6188, 6.9282, 8.0829, 9.2376, 10.3923, 11.547, 13.0)
THICKNESSES_MM = (0.2, 0.26, 0.3, 0.34, 0.38, 0.42, 0.46, 0.5, 0.6)


@one_blas_thread()
def main() -> None:
    rows = []
    for length, thickness in STARS:
        rows += energies(length, thickness)
        print(rows[-2], rows[-1], sep="\n", flush=True)
    header = ["star, mm", "kappa d", "axis deg", "moment at 0", *(f"at {p:g}" for p in PARTS), "tangent at 0"]
    header += ["energy off % of D kappa^2", "moment off", "with c: energy", "moment"]
    body = [
        [f"l {row['length_mm']:.2f}, h {row['thickness_mm']:g}", f"{row['turn_rad']:.2f}", f"{row['angle_deg']:.0f}"]
        + [f"{value:+.3f}" for value in row["moment"]]
        + [f"{row['tangent']:.2f}"]
        + [f"{100.0 * row[key]:.1f}" for key in ("energy_off", "moment_off", "energy_off_c", "moment_off_c")]
        for row in rows
    ]
    text = f"Stretch {STRETCH}, edges of {EDGE_MM} mm. The parabola has the moments -1, -0.75, -0.5, -0.25, 0, 0.25\n"
    text += f"and the tangent 1. Largest deviations are those up to the natural tube.\n\n{markdown(header, body)}\n\n"
    lacks = flat_lack()
    rows += [
        {"length_mm": length, "thickness_mm": thickness, "c": value} for (length, thickness), value in lacks.items()
    ]
    body = [
        [f"{length:.2f}", *(f"{lacks[length, thickness]:.2f}" for thickness in THICKNESSES_MM)] for length in LENGTHS_MM
    ]
    text += f"c of the law's cells of width {WIDTH_MM} mm, mean of both axes, by length and thickness in mm:\n\n"
    text += markdown(["l", *(f"h {thickness:g}" for thickness in THICKNESSES_MM)], body)
    print(text)
    write_report("cell_energies", rows, text)


def energies(length: float, thickness: float) -> list[dict[str, Any]]:
    """Energies and moments of one star about each axis, over `D kappa^2`."""
    cell = UnitCell(sheet(length, thickness), EDGE_MM)
    flat = relax_flat_cell(cell)[0]
    linear = effective_stiffness(cell, flat)
    rows = []
    for degrees in ANGLES_DEG:
        angle = np.radians(degrees)
        branch = trace_tubes(cell, flat, angle)
        assert branch.natural is not None
        natural, tubes = branch.natural, list(branch.tubes)
        for part in PARTS:
            near = min(tubes, key=lambda tube: abs(tube.curvature - part * natural.curvature))
            tubes.append(roll_cell(cell, unroll(cell, near), part * natural.curvature, angle))
        rolled = tubes[-len(PARTS) :]
        along = np.array([-np.sin(angle), np.cos(angle)])
        k = np.array([0.0, *(tube.curvature for tube in rolled)])
        hoop = np.array([np.linalg.norm(flat.deformation @ along), *(tube.hoop for tube in rolled)])
        form = CubicSpline(k, k * hoop)
        whole = natural.curvature * natural.hoop
        unit = -2.0 * (natural.energy - flat.energy)
        slopes = np.array([tube.moment for tube in rolled]) * whole / form(k[1:], 1) / unit
        flat_moment, tangent = flat_bending(linear.stiffness, linear.moment, along)
        x = k * hoop / whole
        energy = np.array([0.0, *(tube.energy - flat.energy for tube in rolled)]) / unit
        moment = np.array([flat_moment * whole / unit, *slopes])
        lack = 1.0 + moment[0]
        up_to = x < 1.0 + 1e-6
        off = energy - (0.5 * x**2 - x), moment - (x - 1.0)
        better = off[0] - lack * x * (1.0 - x) ** 2, off[1] - lack * (1.0 - x) * (1.0 - 3.0 * x)
        rows.append(
            {
                "length_mm": length, "thickness_mm": thickness, "angle_deg": degrees,
                "turn_rad": natural.contracted_curvature * cell.spacing, "x": x.tolist(), "energy": energy.tolist(),
                "moment": moment.tolist(), "tangent": tangent * whole**2 / unit, "c": lack,
                **{
                    name: float(np.abs(of[up_to]).max())
                    for name, of in zip(
                        ("energy_off", "moment_off", "energy_off_c", "moment_off_c"), (*off, *better), strict=True
                    )
                },
            }
        )  # fmt: skip
    cell.close()
    return rows


def flat_bending(stiffness: Floats, moment: Floats, along: Floats) -> tuple[float, float]:
    """N and N mm: derivatives of a flat cell's energy by b around a tube in a direction (2,), stretches free."""
    form = np.array([along[0] ** 2, along[1] ** 2, 2.0 * along[0] * along[1]])
    coupling = stiffness[:3, 3:]
    tangent = stiffness[3:, 3:] - coupling.T @ np.linalg.solve(stiffness[:3, :3], coupling)
    return float(moment @ form), float(form @ tangent @ form)


def flat_lack() -> dict[tuple[float, float], float]:
    """c by length and thickness of the packaged law's cells; nan without one."""
    out = dict.fromkeys([(length, thickness) for length in LENGTHS_MM for thickness in THICKNESSES_MM], np.nan)
    for record in paper_law().samples:
        size = record["length_mm"], record["thickness_mm"]
        if size not in out or (record["stretch"], record["width_mm"]) != (STRETCH, WIDTH_MM) or not record["sample"]:
            continue
        sample = record["sample"]
        both = []
        for i in (0, -1):
            angle = sample["angles_rad"][i]
            along = np.array([-np.sin(angle), np.cos(angle)])
            moment = flat_bending(np.array(sample["stiffness"]), np.array(sample["moment"]), along)[0]
            whole = sample["natural_print_curvature"][i] * sample["natural_hoop"][i]
            both.append(1.0 - moment * whole / (2.0 * sample["natural_energy"][i]))
        out[size] = float(np.mean(both))
    return out


if __name__ == "__main__":
    main()
