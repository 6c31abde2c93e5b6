"""What gives way around a point that is held, in the exact model's fabric and in the preview's shell.

python -m benchmarks.point_pins

A wedge of bare fabric is held along its arc, where it is as long as it wants to be, and its tip is pulled out a little;
for 360 degrees it is a disc, and its middle is pulled aside. With K of `asterism/previews/supports/point_pins.py` (for
a full turn that of a plane, `4 pi E t/((1 + nu)(3 - nu))`) the table has the numbers of that file: c, d, d - c and g.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve
from skfem import MeshTri

from asterism.discrete.energies.membrane import Membrane
from asterism.fem.elements.argyris import Argyris
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import QUADRATURE_ORDER, Shell
from asterism.fem.supports.conditions import vertices_at
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.coarse.sheet_mesh import sheet_mesh
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.supports.conditions import conditions
from asterism.previews.supports.point_pins import around, softened, spot
from benchmarks.report import markdown, write_report

RADIUS, STRETCH = 60.0, 1.35
EXACT_MM, TURNED_DEG, SHELL_MM = (2.0, 1.6, 1.2), (0.0, 11.0, 30.0, 90.0), (20.0, 30.0)
FABRIC = Design.from_dict({"stars": {"length_mm": 1.0, "thickness_mm": 0.3}, "border": {"rings": 1}}).fabric
KEYS = ("c", "d", "lack", "gain", "stiffer")
STIFFER = f"stiffness, shell of {SHELL_MM[0]:.0f} mm over exact of {EXACT_MM[-1]} mm"


def main() -> None:
    rows = [measured(angle) for angle in PREVIEW_MODEL.point_angles_deg]
    lines = [[f"{row['angle_deg']:.0f}", *(f"{row[key]:.2f}" for key in KEYS)] for row in rows]
    text = markdown(["angle, deg", "exact, c", "shell, d", "d - c", "g", STIFFER], lines)
    print(text)
    write_report("point_pins", rows, text)


def measured(angle: float) -> dict[str, float]:
    """c, d, d - c and g for one angle in degrees, means over several meshes; and how much stiffer the shell is."""
    meshes = [(edge, turned) for edge in EXACT_MM for turned in TURNED_DEG]
    c = np.mean([ease(exact_stiffness(angle, *mesh), angle) - np.log(RADIUS / mesh[0]) for mesh in meshes])
    d, gain = [], []
    for size in SHELL_MM:
        (hard, edge), (soft, _) = (shell_stiffness(angle, size, amount) for amount in (0.0, 1.0))
        d.append(ease(hard, angle) - np.log(RADIUS / edge))
        gain.append(ease(soft, angle) - ease(hard, angle))
    found = {"angle_deg": angle, "c": float(c), "d": float(np.mean(d)), "gain": float(np.mean(gain))}
    fine, coarse = np.log(RADIUS / EXACT_MM[-1]) + found["c"], np.log(RADIUS / SHELL_MM[0]) + found["d"]
    return found | {"lack": found["d"] - found["c"], "stiffer": float(fine / coarse)}


def ease(stiffness: float, angle: float) -> float:
    """`u K / F`, from F / u in N/mm."""
    a, nu = np.radians(angle), FABRIC.poisson
    turn = 4.0 * np.pi / ((1.0 + nu) * (3.0 - nu)) if angle == 360.0 else 0.5 * (a + np.sin(a))
    return float(FABRIC.modulus_mpa * FABRIC.thickness_mm * turn / stiffness)


def wedge(angle: float, edge_mm: float, turned: float = 0.0) -> Design:
    """A sheet that is held along its arc and at the origin; its stars are there only because a sheet has some.

    It opens along x, or along a direction turned from there, in degrees.
    """
    count = max(3, round(angle / 6.0))
    turn = np.radians(turned + angle * (np.arange(count + 1) / count - 0.5))
    arc = RADIUS * np.column_stack([np.cos(turn), np.sin(turn)])
    border = arc[:-1] if angle == 360.0 else np.concatenate([np.zeros((1, 2)), arc])
    length = {"profile": "radial", "from": 0.0, "to": 1.2, "over_mm": 0.5 * RADIUS}
    first = len(border) > count  # with a tip the first side leads from there to the arc
    return Design.from_dict(
        {
            "stars": {"length_mm": length, "thickness_mm": 0.3},
            "border": {"polygon_mm": border.tolist()},
            "mesh": {"edge_mm": edge_mm},
            "pins": [{"edges": [first + k for k in range(count)]}, {"points_mm": [[0.0, 0.0]]}],
        }
    )


def exact_stiffness(angle: float, edge_mm: float, turned: float) -> float:
    """N/mm, of constant strain triangles."""
    design = wedge(angle, edge_mm, turned)
    mesh = mesh_layout(layout(design), edge_mm, design.mesh.kind, design.mesh.seed)
    rest = mesh.points / STRETCH
    fabric = Membrane(mesh.triangles, rest, FABRIC.thickness_mm, FABRIC.modulus_mpa, FABRIC.poisson)
    flat = np.column_stack([rest, np.zeros(len(rest))]).ravel()
    both = np.zeros((len(fabric), 9, 9))
    i, j = np.tril_indices(9)
    both[:, i, j] = both[:, j, i] = fabric.hessians(flat)
    rows, columns = np.broadcast_arrays(fabric.dofs[:, :, None], fabric.dofs[:, None])
    whole = sp.csc_matrix((both.ravel(), (rows.ravel(), columns.ravel())), shape=(flat.size, flat.size))
    (arc, (point,)), free = mesh.pin_vertices, np.ones((len(rest), 3), dtype=bool)
    free[arc] = free[:, 2] = False
    inner = np.flatnonzero(free)
    x, y = np.cos(np.radians(turned)), np.sin(np.radians(turned))
    pull = x * (inner == 3 * point) + y * (inner == 3 * point + 1)
    return float(1.0 / (pull @ spsolve(whole[inner][:, inner], pull)))


def shell_stiffness(angle: float, edge_mm: float, amount: float) -> tuple[float, float]:
    """N/mm, of a shell with a softness at the point; and the mean edge there, mm."""
    plan, point = layout(wedge(angle, EXACT_MM[0])), np.zeros((1, 2))
    mesh = sheet_mesh(plan.outline, edge_mm, point, plan.supported_edge_groups)
    edge = float(around(mesh, point)[0][0])
    space = Argyris(MeshTri(np.ascontiguousarray(mesh.points.T), np.ascontiguousarray(mesh.triangles.T)))
    at = space.tabulate(QUADRATURE_ORDER).points
    plain = isotropic(FABRIC.modulus_mpa * FABRIC.thickness_mm / (1.0 - FABRIC.poisson**2), 1.0, FABRIC.poisson)
    soft = softened(np.broadcast_to(plain, (*at.shape[:2], 6, 6)), 1.0 / (1.0 + amount * spot(point[0], edge, at)))
    arc = conditions(replace(plan, pins=plan.pins[:1]), mesh, space.mesh, 0)
    shell = Shell(space, Fields(Density(soft)), arc)
    factor = shell.factor()
    assert factor.factorise(shell.flat_stiffness)
    tip = int(space.vertex_dofs[vertices_at(space.mesh, point)[0], 0])
    pull = (shell.reduction.free == 3 * tip).astype(float)
    return float(1.0 / (pull @ factor.solve(pull))), edge


if __name__ == "__main__":
    main()
