"""Free sheets of a motif against a shell that has the responses of its cell: is one cell enough for a preview?

python -m benchmarks.motif_shells
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from skfem import MeshTri

from asterism.exact.simulation import exact_shape
from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.relax import relax
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import Shell
from asterism.homogenize.campaign.motif_sample import motif_tensors
from asterism.homogenize.cell.motif_responses import MotifResponses, motif_responses
from asterism.homogenize.cell.rod_bending import GAUSSIAN
from asterism.homogenize.law.tensor_forms import TO_VOIGT
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.print_layout import print_layout
from asterism.pattern.mesh.coarse.sheet_mesh import sheet_mesh
from benchmarks.report import markdown, write_report

SHELL_EDGE_MM, EDGE_MM = 15.0, 2.0
SELF_STRESSED = (("self_stressed_rms_percent", ".2f"), ("self_stressed_shell_rise_mm", ".1f"))
WAVE = [(float(x), float(2.0 * np.sin(0.1 * np.pi * x))) for x in np.linspace(0.0, 20.0, 17)]
RHOMB = (9.0 * np.cos(np.pi / 6), 4.5)
# of the width and height of a sheet: the part whose twist is measured
INNER_PART = 0.7
# motif and lattice
MOTIFS: dict[str, tuple[list[dict[str, Any]], dict[str, Any]]] = {
    "lines": ([{"line_mm": [(0, 2.5), (5, 2.5)]}], {"kind": "square", "spacing_mm": 5.0}),
    "grid": (
        [{"line_mm": [(5, 5), (15, 5)]}, {"line_mm": [(5, 5), (5, 15)]}],
        {"kind": "square", "spacing_mm": 10.0},
    ),
    "diamonds": (
        [{"line_mm": [(0, 0), RHOMB]}, {"line_mm": [(0, 0), (RHOMB[0], -RHOMB[1])]}],
        {"kind": "custom", "vectors_mm": [RHOMB, (RHOMB[0], -RHOMB[1])]},
    ),
    "waves": (
        [{"spline_mm": [(x, y + 4.0) for x, y in WAVE]}],
        {"kind": "custom", "vectors_mm": [(20.0, 0.0), (0.0, 8.0)]},
    ),
}
# motif, width and height of the sheet: the bare rim is at most half a distance of lines wide
SHEETS: list[tuple[str, tuple[float, float]]] = [
    ("lines", (60.0, 60.0)), ("lines", (80.0, 50.0)), ("grid", (60.0, 60.0)), ("diamonds", (64.0, 56.0)),
    ("waves", (70.0, 64.0)), ("lines", (120.0, 120.0)), ("grid", (120.0, 120.0)), ("diamonds", (128.0, 112.0)),
    ("waves", (140.0, 128.0)),
]  # fmt: skip
# the same sheets with shifted motifs: the rim cuts the rods elsewhere. Waves shifted by a quarter of their length are
# their own mirror images, and those of the first table are not
SHIFTS: dict[str, list[tuple[float, float]]] = {
    "grid": [(0.0, 0.0), (0.0, 3.0), (4.0, 4.0)],
    "diamonds": [(0.0, 0.0), (0.0, 2.25), (3.9, 2.25)],
    "waves": [(0.0, 0.0), (0.0, 2.0), (0.0, 4.0), (5.0, 0.0)],
}


def main() -> None:
    cells = {name: motif_responses(sheet(name, (60.0, 60.0)), EDGE_MM) for name in MOTIFS}
    rows = [compare(name, size, cells[name]) for name, size in SHEETS]
    text = "Free sheets of motifs (0.4 mm thick), exact, against a shell with the responses of one cell; distances of\n"
    text += f"printed points over the diameter of the exact shape, edges of {EDGE_MM:g} mm:\n\n{motif_table(rows)}"
    sizes = dict(reversed(SHEETS))  # the smaller one of each motif
    rims = [
        compare(name, sizes[name], cells[name], shift) | uncurled(name, sizes[name], shift)
        for name, shifts in SHIFTS.items()
        for shift in shifts
    ]
    header = ["motif", "shift mm", "rms %", "rise, exact mm", "shell mm"]
    header += ["twist, exact 1/m", "rise without rest curvature mm", "minimum"]
    lines = [
        [
            r["sheet"],
            f"{r['shift_mm'][0]:g}, {r['shift_mm'][1]:g}",
            f"{r['rms_percent']:.2f}",
            f"{r['rise_mm']:.1f}",
            f"{r['shell_rise_mm']:.1f}",
            f"{1e3 * r['twist_per_mm']:.2f}",
            f"{r['uncurled_rise_mm']:.1f}",
            "yes" if r["exact_minimum"] and r["shell_minimum"] and r["uncurled_minimum"] else "no",
        ]
        for r in rims
    ]
    text += (
        f"\n\nThe same sheets, the motif shifted so that the rim cuts the rods elsewhere:\n\n{markdown(header, lines)}"
    )
    write_report("motif_shells", [*rows, *rims], text)
    print(text)


def sheet(name: str, size: tuple[float, float], shift: tuple[float, float] = (0.0, 0.0)) -> Design:
    lines, lattice = MOTIFS[name]
    motif = [{key: [(x + shift[0], y + shift[1]) for x, y in line] for key, line in each.items()} for each in lines]
    rods = {"motif": motif, "thickness_mm": 0.4}
    mesh = {"edge_mm": EDGE_MM}
    return Design.from_dict({"rods": rods, "lattice": lattice, "border": {"rectangle_mm": size}, "mesh": mesh})


def uncurled(name: str, size: tuple[float, float], shift: tuple[float, float]) -> dict[str, Any]:
    """The rise of a sheet whose rods have no rest curvature: the shell of a cell is then flat."""
    design = sheet(name, size, shift)
    plastic = design.plastic.model_copy(update={"rest_curvature": "none"})
    shape = exact_shape(design.model_copy(update={"plastic": plastic}))
    return {"uncurled_rise_mm": _rise(shape.positions), "uncurled_minimum": bool(shape.summary.is_minimum)}


def self_stress_modulus(design: Design) -> float:
    """N mm, the multiple of det K in the energy of a square grid that is cut midway between its rods.

    The fabric has the tension N, and each rod the compression N d. Airy's function of one family of rods is then
    `N (y^2 - d^2/4)/2` around the middle between rods, less its mean; it vanishes at the rim midway for the rods along
    the rim, and in the mean for those that end there. Its mean over the sheet is N d^2/24, and Gaussian curvature does
    the work -K times that.
    """
    fabric, distance = design.fabric, float(np.linalg.norm(design.lattice.vectors[0]))
    stretch, poisson = float(fabric.stretch_xy[0]), fabric.poisson
    shear = fabric.modulus_mpa / (2.0 * (1.0 + poisson))
    lame = fabric.modulus_mpa * poisson / (1.0 - poisson**2)
    tension = fabric.thickness_mm / stretch**2 * (shear * (stretch**2 - 1.0) + 2.0 * lame * np.log(stretch))
    return float(-tension * distance**2 / 24.0)


def compare(
    name: str, size: tuple[float, float], responses: MotifResponses, shift: tuple[float, float] = (0.0, 0.0)
) -> dict[str, Any]:
    """One sheet, by both models."""
    design = sheet(name, size, shift)
    exact = exact_shape(design)
    diameter = float(np.linalg.norm(np.ptp(exact.positions, axis=0)))
    flat = exact.printed @ responses.deformation
    from_flat = _distance(np.pad(flat, ((0, 0), (0, 1))), exact.positions, 1.0)[0]
    row: dict[str, Any] = {
        "sheet": name, "size_mm": size, "shift_mm": shift, "vertices": len(exact.printed),
        "twist_per_mm": twist(exact.printed, exact.positions, size),
        "flat_rms_percent": 100.0 * from_flat / diameter,
        "exact_minimum": bool(exact.summary.is_minimum), "rise_mm": _rise(exact.positions), "doubts": responses.doubts,
    }  # fmt: skip
    moduli = {"": 0.0} | ({"self_stressed_": self_stress_modulus(design)} if name == "grid" else {})
    for kind, modulus in moduli.items():
        outline = sheet_mesh(print_layout(design).outline, SHELL_EDGE_MM)
        space = Argyris(MeshTri(outline.points.T.copy(), outline.triangles.T.copy()))
        shell = relax(Shell(space, motif_fields(responses, modulus)), soft_modes=0)
        # of two images of a symmetric sheet, the nearer one
        distance = min(
            (_distance(space.locate(exact.printed * signs).value @ shell.x, exact.positions, np.prod(signs)))
            for signs in (np.array(pair, dtype=float) for pair in product((1, -1), repeat=2))
        )
        row |= {
            f"{kind}rms_percent": 100.0 * distance[0] / diameter,
            f"{kind}largest_percent": 100.0 * distance[1] / diameter,
            f"{kind}shell_minimum": bool(shell.is_minimum),
            f"{kind}shell_rise_mm": _rise(space.locate(exact.printed).value @ shell.x),
        }
    print(row, flush=True)
    return row


def motif_fields(responses: MotifResponses, modulus: float = 0.0) -> Fields:
    """Uniform fields: the rest metric and the membrane of the flat cell, and the bending of its natural tubes.

    Parameters
    ----------
    modulus : N mm, of the energy `modulus det K`.
    """
    tensors = motif_tensors(responses)
    metric, stiffness = tensors.metric[0], tensors.stiffness[0]
    moment = stiffness[3:, 3:] @ (tensors.curvature[0] * TO_VOIGT)
    stiffness[3:, 3:] += modulus * GAUSSIAN
    curvature = np.linalg.solve(stiffness[3:, 3:], moment) / TO_VOIGT
    return Fields(Density(stiffness), (metric[0], metric[1], metric[2]), curvature)


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


def twist(printed: np.ndarray, places: np.ndarray, size: tuple[float, float]) -> float:
    """1/mm, absolute mean twist of the inner part of a sheet: the second derivative by x and y of the polynomial of
    fourth order nearest to its points, along the normal in the middle."""
    inner = (np.abs(printed) <= INNER_PART * 0.5 * np.array(size)).all(axis=1)
    powers = [(i, k) for i in range(5) for k in range(5 - i)]
    x, y = printed[inner].T
    terms = np.linalg.lstsq(np.column_stack([x**i * y**k for i, k in powers]), places[inner], rcond=None)[0]
    along, across, both = (terms[powers.index(power)] for power in ((1, 0), (0, 1), (1, 1)))
    normal = np.cross(along, across)
    return abs(float(both @ normal / np.linalg.norm(normal)))


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
        "with self-stress: rms %",
        "rise mm",
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
                *(f"{r[key]:{form}}" if key in r else "" for key, form in SELF_STRESSED),
                "yes" if r["exact_minimum"] and r["shell_minimum"] else "no",
            ]
            for r in rows
        ],
    )


if __name__ == "__main__":
    main()
