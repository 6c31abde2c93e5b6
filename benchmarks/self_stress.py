"""The stress of flat sheets of equal stars, in the exact model and in the preview's shell.

python -m benchmarks.self_stress

Both sheets are free, and stay in their plane. Their stress sigma is in equilibrium, so that it is made of Airy's
function phi, which vanishes at the border. A small deflection w does the work `sigma_ij w_i w_j / 2` on it, which for
constant curvatures k1 and k2 is `-k1 k2` times the integral of phi: here it comes from a cap and a saddle, the
difference of which leaves out what arms bend within the plane. What the shell lacks over `share^2` times the pull of
the fabric is the area G of `asterism/previews/fields/self_stress.py`. It counts for stars whose membrane is
as stiff as bare fabric. Stars that buckle have a softer one, but not in the exact sheet of this comparison, which is
planar.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.model.system import System
from asterism.equilibrium.newton.minimise import minimise
from asterism.equilibrium.threads import one_blas_thread
from asterism.fem.search.mixed_newton import mixed_newton
from asterism.fem.search.relax import GRADIENT_TOLERANCE
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews.default_law import paper_law
from asterism.previews.edges.free_rim import stars_share
from asterism.previews.fields.self_stress import pulls
from asterism.previews.fields.star_values import StarValues, star_values
from asterism.previews.sheet import sheet_of
from benchmarks.report import markdown, write_report

# stretch, rings, length and thickness in mm
SHEETS = [
    (1.35, 1, 4.5, 0.4), (1.35, 1, 5.5, 0.4), (1.35, 2, 5.5, 0.4), (1.35, 1, 6.5, 0.4), (1.35, 1, 8.0, 0.4),
    (1.35, 1, 8.0, 0.44), (1.35, 1, 10.0, 0.4), (1.35, 1, 8.0, 0.3), (1.35, 1, 8.0, 0.5), (1.75, 1, 4.5, 0.4),
    (1.75, 1, 6.0, 0.4), (1.75, 2, 6.0, 0.4), (1.75, 1, 8.0, 0.4),
]  # fmt: skip
EDGE_MM, RELEASES, DEFLECTION_MM = 1.15, 10, 0.01
# difference of the membrane's stiffness from that of bare fabric, up to which stars count as unbuckled
MAX_SOFTENING = 0.05
BEND = (1.0, -1.0)  # k2 over k1: a cap and a saddle


@one_blas_thread()
def main() -> None:
    rows = [measured(*sheet) for sheet in SHEETS]
    keys = ["stretch", "rings", "length_mm", "thickness_mm", "softening", "exact_n_mm2", "shell_n_mm2", "area_mm2"]
    keys += ["share"]
    header = ["stretch", "rings", "l mm", "h mm", "membrane, bare over stars", "phi, exact N mm^2", "shell N mm^2"]
    header += ["G mm^2", "d^2 / G"]
    formats = [".2f", ".0f", ".1f", ".2f", ".2f", ".0f", ".0f", ".1f", ".0f"]
    text = markdown(header, [[f"{row[key]:{form}}" for key, form in zip(keys, formats, strict=True)] for row in rows])
    flat = [row["share"] for row in rows if abs(row["softening"] - 1.0) < MAX_SOFTENING]
    text += f"\n\nMedian of d^2 / G over the {len(flat)} sheets whose stars are as stiff as bare fabric within "
    text += f"{100 * MAX_SOFTENING:.0f} %: {np.median(flat):.0f}, from {min(flat):.0f} to {max(flat):.0f}."
    print(text)
    write_report("self_stress", rows, text)


def measured(stretch: float, rings: int, length: float, thickness: float) -> dict[str, float]:
    """Integrals of phi of a hexagon of stars, and the area that makes up for their difference."""
    stars = {"length_mm": length, "thickness_mm": thickness}
    fabric, border = {"stretch": stretch}, {"rings": rings}
    design = Design.from_dict({"stars": stars, "fabric": fabric, "border": border, "mesh": {"edge_mm": EDGE_MM}})
    exact = exact_integral(design)
    shell, per_area, values = shell_integral(design)
    area = (exact - shell) / per_area
    stretching = values.value["a11"] + values.value["a12"]
    return {
        "stretch": stretch,
        "rings": rings,
        "length_mm": length,
        "thickness_mm": thickness,
        "exact_n_mm2": exact,
        "shell_n_mm2": shell,
        "area_mm2": area,
        "share": design.lattice.spacing_mm**2 / area,
        "softening": float(stretching[-1] / stretching[0]),
    }


def exact_integral(design: Design) -> float:
    """N mm^2, of the exact model that may not leave its plane."""
    plan = layout(design)
    mesh = mesh_layout(plan, design.mesh.edge_mm)
    model = DiscreteModel(design, plan, mesh)
    held = np.ones(model.n_dofs, dtype=bool)
    held[: 3 * model.n_vertices].reshape(-1, 3)[:, :2] = False
    inside = System(
        {name: model.parts[name] for name in ("membrane", "rod_stretch", "rod_bending", "rod_twist")},
        model.n_vertices,
        model.edges,
        held,
    )
    factor, state = inside.factor(), model.flat_state()
    for release in np.linspace(0.0, 1.0, RELEASES + 1)[1:]:
        model.set_release(float(release))
        found = minimise(inside, state, factor, 1e-9)
        state = found.state
    factor.close()
    assert found.converged
    assert found.definite
    bearing = {name: model.parts[name] for name in ("membrane", "rod_stretch")}
    stressed = System(bearing, model.n_vertices, model.edges, held)
    flat = stressed.energy(state)
    x = state.positions - state.positions.mean(axis=0)
    work = []
    for second in BEND:
        w = 0.5 * (x[:, 0] ** 2 + second * x[:, 1] ** 2)
        small = DEFLECTION_MM / np.abs(w).max()
        bent = state.positions + np.column_stack([np.zeros((len(w), 2)), small * w])
        work.append((stressed.energy(State(bent, state.directors)) - flat) / small**2)
    return float(work[1] - work[0]) / 2.0


def shell_integral(design: Design) -> tuple[float, float, StarValues]:
    """N mm^2 of the preview's membrane in its plane, and what a modulus of one mm^2 adds; the stars."""
    plan = layout(design)
    values, sheet = star_values(design, plan, paper_law()), sheet_of(design, plan)
    fields = sheet.fields(values)
    density = fields.density
    assert isinstance(density, Density)
    stiffness = np.array(density.stiffness)
    stiffness[..., :3, 3:] = stiffness[..., 3:, :3] = 0.0
    membrane = Fields(replace(density, stiffness=stiffness, sixfold=0.0), fields.metric)
    shell = sheet.shell(membrane, 0)
    factor = shell.factor()
    start = shell.flat * np.sqrt(np.asarray(fields.metric)[..., 0].mean())
    found = mixed_newton(shell, start, factor, GRADIENT_TOLERANCE * shell.force_scale)
    factor.close()
    assert found.converged
    stress = shell.density(found.strains)[1]
    table, weight = sheet.space.tabulate(shell.order), shell.assembly.weights
    place = np.einsum("tqm,tmc->tqc", table.values, found.x[table.dofs])
    tangent = np.einsum("tqma,tmc->tqac", table.gradients, found.x[table.dofs])
    place -= (weight[..., None] * place).sum(axis=(0, 1)) / weight.sum()
    work = []
    for second in BEND:
        slope = np.einsum("tqac,tqc->tqa", tangent[..., :2], place[..., :2] * [1.0, second])
        both = np.stack([slope[..., 0] ** 2, slope[..., 1] ** 2, 2.0 * slope[..., 0] * slope[..., 1]], axis=-1)
        work.append(0.5 * float((weight[..., None] * stress[..., :3] * both).sum()))
    # per unit curvature, det b is the square of the area that a printed one has become
    area = np.linalg.det(tangent[..., :2])
    weights = sheet.stars.cells.shares(table.points.reshape(-1, 2))(values.sizes[:, 0])
    saved = (stars_share(weights) * (weights @ pulls(values))).reshape(area.shape)
    return (work[1] - work[0]) / 2.0, float((weight * saved * area**2).sum()), values


if __name__ == "__main__":
    main()
