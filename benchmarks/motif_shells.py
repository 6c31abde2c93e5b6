"""Free sheets of a motif against a shell that has the responses of its cell: is one cell enough for a preview?

python -m benchmarks.motif_shells
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from skfem import MeshTri

from asterism.exact.simulation import exact_shape
from benchmarks.report import markdown, write_report
from fem.elements.argyris import Argyris
from fem.search.relax import relax
from fem.shell.density import Density
from fem.shell.fields import Fields
from fem.shell.shell import Shell
from homogenize.cell.motif_responses import MotifResponses, motif_responses
from homogenize.law.anisotropy import BENDING_POISSON, VOIGT_ENTRIES, mean_q12, voigt_matrices
from pattern.design.design import Design
from pattern.geometry.rigid_fit import rigid_fit
from pattern.layout.print_layout import print_layout
from pattern.mesh.coarse.sheet_mesh import sheet_mesh

SHELL_EDGE_MM, EDGE_MM = 15.0, 2.0
# of the largest bending stiffness, at least
MIN_STIFFNESS_RATIO = 0.01
WAVE = [(float(x), float(2.0 * np.sin(0.1 * np.pi * x))) for x in np.linspace(0.0, 20.0, 17)]
RHOMB = (9.0 * np.cos(np.pi / 6), 4.5)
# motif, lattice, width and height of the sheet: the bare rim is at most half a distance of lines wide
SHEETS: dict[str, tuple[list[dict[str, Any]], dict[str, Any], tuple[float, float]]] = {
    "lines": (
        [{"line_mm": [(0, 2.5), (5, 2.5)]}], {"kind": "square", "spacing_mm": 5.0}, (60.0, 60.0)
    ),
    "lines, longer": (
        [{"line_mm": [(0, 2.5), (5, 2.5)]}], {"kind": "square", "spacing_mm": 5.0}, (80.0, 50.0)
    ),
    "grid": (
        [{"line_mm": [(5, 5), (15, 5)]}, {"line_mm": [(5, 5), (5, 15)]}],
        {"kind": "square", "spacing_mm": 10.0},
        (60.0, 60.0),
    ),
    "diamonds": (
        [{"line_mm": [(0, 0), RHOMB]}, {"line_mm": [(0, 0), (RHOMB[0], -RHOMB[1])]}],
        {"kind": "custom", "vectors_mm": [RHOMB, (RHOMB[0], -RHOMB[1])]},
        (64.0, 56.0),
    ),
    "waves": (
        [{"spline_mm": [(x, y + 4.0) for x, y in WAVE]}],
        {"kind": "custom", "vectors_mm": [(20.0, 0.0), (0.0, 8.0)]},
        (70.0, 64.0),
    ),
}  # fmt: skip


def main() -> None:
    rows = [compare(name) for name in SHEETS]
    text = "Free sheets of motifs (0.4 mm thick), exact, against a shell with the responses of one cell; distances of\n"
    text += f"printed points over the diameter of the exact shape, edges of {EDGE_MM:g} mm:\n\n{motif_table(rows)}"
    write_report("motif_shells", rows, text)
    print(text)


def sheet(name: str) -> Design:
    motif, lattice, size = SHEETS[name]
    rods = {"motif": motif, "thickness_mm": 0.4}
    mesh = {"edge_mm": EDGE_MM}
    return Design.from_dict({"rods": rods, "lattice": lattice, "border": {"rectangle_mm": size}, "mesh": mesh})


def compare(name: str) -> dict[str, Any]:
    """One sheet, by both models."""
    design = sheet(name)
    exact = exact_shape(design)
    responses = motif_responses(design, EDGE_MM)
    outline = sheet_mesh(print_layout(design).outline, SHELL_EDGE_MM)
    space = Argyris(MeshTri(outline.points.T.copy(), outline.triangles.T.copy()))
    shell = relax(Shell(space, motif_fields(responses)), soft_modes=0)
    # of two images of a symmetric sheet, the nearer one
    distance = min(
        (_distance(space.locate(exact.printed * signs).value @ shell.x, exact.positions, np.prod(signs)))
        for signs in (np.array(pair, dtype=float) for pair in product((1, -1), repeat=2))
    )
    flat = exact.printed @ responses.deformation
    from_flat = _distance(np.pad(flat, ((0, 0), (0, 1))), exact.positions, 1.0)[0]
    diameter = float(np.linalg.norm(np.ptp(exact.positions, axis=0)))
    row = {
        "sheet": name, "size_mm": SHEETS[name][2], "vertices": len(exact.printed),
        "rms_percent": 100.0 * distance[0] / diameter, "largest_percent": 100.0 * distance[1] / diameter,
        "flat_rms_percent": 100.0 * from_flat / diameter,
        "exact_minimum": bool(exact.summary.is_minimum), "shell_minimum": bool(shell.is_minimum),
        "rise_mm": _rise(exact.positions), "shell_rise_mm": _rise(space.locate(exact.printed).value @ shell.x),
        "doubts": responses.doubts,
    }  # fmt: skip
    print(row, flush=True)
    return row


def motif_fields(responses: MotifResponses) -> Fields:
    """Uniform fields: the rest metric and the membrane of the flat cell, and the bending of its natural tubes."""
    stiffness = np.zeros((6, 6))
    stiffness[:3, :3] = 0.5 * (responses.linear.stiffness[:3, :3] + responses.linear.stiffness[:3, :3].T)
    stiffness[3:, 3:], moment = bending_of_tubes(responses)
    metric = responses.deformation @ responses.deformation
    natural = np.linalg.solve(stiffness[3:, 3:], moment)
    # plastic outside: edges go down
    curvature = -natural * [1.0, 1.0, 0.5]
    return Fields(Density(stiffness), (metric[0, 0], metric[1, 1], metric[0, 1]), curvature)


def bending_of_tubes(responses: MotifResponses) -> tuple[np.ndarray, np.ndarray]:
    """Q (3, 3) N mm and m (3,) N, in curvatures of the print: the energy `b . Q b/2 - m . b` nearest to the tubes.

    Tubes leave Q12 open up to Q33: the mean of Q12 over all axes is 0.05 of the mean stiffness, as in laws of stars.
    """
    angle = np.array([tube.direction_rad for tube in responses.directions])
    along = np.stack([np.cos(angle) ** 2, np.sin(angle) ** 2, np.sin(2.0 * angle)], axis=-1)
    hoop = np.array([tube.hoop for tube in responses.directions])
    curvature = np.array([tube.curvature for tube in responses.directions]) * hoop**2
    bending = np.array([tube.bending for tube in responses.directions]) / hoop**4
    pairs = np.array([along[:, i] * along[:, j] * (1.0 if i == j else 2.0) for i, j in VOIGT_ENTRIES]).T
    mean = np.array([mean_q12(voigt_matrices(row)) for row in np.eye(6)])
    rows = np.vstack([pairs, mean])
    entries = np.linalg.lstsq(rows, np.append(bending, BENDING_POISSON * bending.mean()), rcond=None)[0]
    sizes, axes = np.linalg.eigh(voigt_matrices(entries))
    q = (axes * np.maximum(sizes, MIN_STIFFNESS_RATIO * sizes.max())) @ axes.T
    moment = np.linalg.lstsq(along, bending * curvature, rcond=None)[0]
    return q, moment


def _distance(places: np.ndarray, exact: np.ndarray, parity: float) -> tuple[float, float]:
    """Root mean square and largest distance (mm) after the best rigid motion; mirrored images are mirrored back."""
    mirrored = places * [parity, 1.0, 1.0]
    rotation, shift = rigid_fit(mirrored, exact)
    off = np.linalg.norm(mirrored @ rotation.T + shift - exact, axis=1)
    return float(np.sqrt((off**2).mean())), float(off.max())


def _rise(places: np.ndarray) -> float:
    """mm, extent across the plane nearest to the points."""
    centred = places - places.mean(axis=0)
    return float(np.ptp(centred @ np.linalg.svd(centred, full_matrices=False)[2][2]))


def motif_table(rows: list[dict[str, Any]]) -> str:
    header = [
        "sheet",
        "mm",
        "vertices",
        "rms %",
        "largest %",
        "flat sheet rms %",
        "rise, exact mm",
        "shell mm",
        "minimum",
    ]
    return markdown(
        header,
        [
            [
                r["sheet"],
                " x ".join(f"{side:g}" for side in r["size_mm"]),
                str(r["vertices"]),
                f"{r['rms_percent']:.2f}",
                f"{r['largest_percent']:.2f}",
                f"{r['flat_rms_percent']:.2f}",
                f"{r['rise_mm']:.1f}",
                f"{r['shell_rise_mm']:.1f}",
                "yes" if r["exact_minimum"] and r["shell_minimum"] else "no",
            ]
            for r in rows
        ],
    )


if __name__ == "__main__":
    main()
