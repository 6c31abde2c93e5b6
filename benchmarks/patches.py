"""Free patches of the exact model against the cell: how a finite sheet comes near to the endless one.

python -m benchmarks.patches
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.star_bumps import add_bumps
from asterism.discrete.model.state import State, moved_state
from asterism.discrete.release.single_mesh import solve_on_mesh
from asterism.homogenize.cell.sample import Sample, solve_cell
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from benchmarks.patch_shell import shell_stars
from benchmarks.report import markdown, write_report

PICTURE = Path(__file__).parent.parent / "docs" / "pictures" / "cell_vs_patch.png"
EDGE = 10.0 * np.sqrt(3.0) / 9.0
SIZES = ((5.0 * EDGE, 0.4), (5.0 * EDGE, 0.6), (4.0 * EDGE, 0.3))  # mm; arms that sheet and cell cut alike
RINGS = (1, 2, 3, 4, 5)


def main() -> None:
    rows = [row for rim in (True, False) for length, thickness in SIZES for row in compare(length, thickness, rim)]
    text = "The core of free patches, rolled at first, against the cell's natural tube and against a free shell of\n"
    text += f"the patch's size that has the cell's responses; edges of {EDGE:.2f} mm:\n\n{patch_table(rows)}"
    write_report("patches", rows, text)
    plot(rows)
    print(text)


def sheet(length: float, thickness: float, rings: int, edge: float = EDGE, rim: bool = True) -> Design:
    """A hexagon of equal stars that nothing holds; without a rim it ends half the spacing beyond the outer stars."""
    if not rim:
        spacing = sheet(length, thickness, rings).lattice.spacing_mm
        corner = spacing * (rings + np.sqrt(1.0 / 3.0))
        angle = np.radians(30.0 + 60.0 * np.arange(6))
        border = corner * np.column_stack([np.cos(angle), np.sin(angle)])
        return Design.from_dict(
            {
                "stars": {"length_mm": length, "thickness_mm": thickness},
                "border": {"polygon_mm": border.tolist(), "star_margin_mm": 0.499 * spacing},
                "mesh": {"edge_mm": edge},
            }
        )
    return Design.from_dict(
        {
            "stars": {"length_mm": length, "thickness_mm": thickness},
            "border": {"rings": rings},
            "mesh": {"edge_mm": edge},
        }
    )


def compare(length: float, thickness: float, rim: bool = True) -> list[dict[str, Any]]:
    """Patches of growing size against the cell."""
    sample = solve_cell(sheet(length, thickness, 1), EDGE)
    best = int(np.argmin(sample.natural_energy))
    bare = solve_cell(sheet(0.0, thickness, 1), EDGE)
    vectors = sheet(length, thickness, 1).lattice.vectors
    expected = measure(vectors, on_tube(sample, best))
    rows = []
    for rings in RINGS:
        design = sheet(length, thickness, rings, rim=rim)
        model, start = rolled_up(design, sample, best)
        solved = solve_on_mesh(model, start=start)
        stars = model.mesh.star_vertices
        places = solved.state.positions[stars]
        near = core(rings, model.mesh.points[stars], places)
        found = [float(value) for value in np.mean([measure(step, at) for step, at in near], axis=0)]
        places, shell_is_minimum = shell_stars(design, sample, bare)
        near = core(rings, model.mesh.points[stars], places)
        shell = [float(value) for value in np.mean([measure(step, at) for step, at in near], axis=0)]
        rows.append(
            {
                "length_mm": length, "thickness_mm": thickness, "rings": rings, "rim": rim,
                "stars": len(places), "stars_up": solved.stars_up, "minimum": solved.is_minimum,
                "stretch": found[0], "curvature": found[1], "other_curvature": found[2],
                "cell_stretch": expected[0], "cell_curvature": expected[1],
                "shell_stretch": shell[0], "shell_curvature": shell[1], "shell_other_curvature": shell[2],
                "shell_minimum": shell_is_minimum,
                "angle_deg": float(np.degrees(sample.angles_rad[best])), "seconds": solved.seconds,
            }
        )  # fmt: skip
        print(rows[-1], flush=True)
    return rows


def rolled_up(design: Design, sample: Sample, direction: int) -> tuple[DiscreteModel, State]:
    """The patch's model, and the patch rolled as the cell's natural tube is, its stars bumped up."""
    plan = layout(design)
    model = DiscreteModel(design, plan, mesh_layout(plan, EDGE))
    angle, curvature = sample.angles_rad[direction], sample.natural_print_curvature[direction]
    x, y = model.mesh.points.T
    along, turn = x * np.cos(angle) + y * np.sin(angle), curvature * (y * np.cos(angle) - x * np.sin(angle))
    radius = 1.0 / sample.natural_curvature[direction]
    tube = [sample.natural_axial[direction] * along, radius * np.sin(turn), radius * np.cos(turn)]
    middle = turn[model.edges].mean(axis=1)
    state = State(np.column_stack(tube), np.column_stack([0.0 * middle, np.sin(middle), np.cos(middle)]))
    state = moved_state(state, model.edges, state.positions, np.zeros(len(model.edges)))
    return model, add_bumps(model, state, np.full(len(plan.centres), sample.natural_bump_mm[direction]))


def on_tube(sample: Sample, direction: int) -> np.ndarray:
    """(7, 3) a star and its six neighbours, printed `neighbours`, on the cell's natural tube."""
    angle = sample.angles_rad[direction]
    printed = neighbours(sheet(1.0, 0.4, 1).lattice.vectors)
    along, around = printed @ [np.cos(angle), np.sin(angle)], printed @ [-np.sin(angle), np.cos(angle)]
    radius = 1.0 / sample.natural_curvature[direction] + sample.natural_centre_offset_mm[direction]
    turn = sample.natural_print_curvature[direction] * around
    return np.column_stack([sample.natural_axial[direction] * along, radius * np.sin(turn), radius * np.cos(turn)])


def neighbours(vectors: Any) -> np.ndarray:
    """(7, 2) mm, the star itself and its six neighbours in the print."""
    return np.array([[0, 0], [1, 0], [0, 1], [-1, 1], [-1, 0], [0, -1], [1, -1]]) @ np.asarray(vectors)


def core(rings: int, printed: np.ndarray, places: np.ndarray) -> list[tuple[Any, np.ndarray]]:
    """Stars two rings or more from the outermost (the centre, if there is none), each with its neighbours' places."""
    lattice = sheet(1.0, 0.4, 1).lattice
    depth = max(rings - 2, 0) * lattice.spacing_mm
    out = []
    for centre in printed[np.linalg.norm(printed, axis=1) < depth + 1.0]:
        wanted = centre + neighbours(lattice.vectors)
        found = np.linalg.norm(printed[:, None] - wanted, axis=2).argmin(axis=0)
        out.append((lattice.vectors, places[found]))
    return out


def measure(vectors: Any, places: np.ndarray) -> tuple[float, float, float]:
    """Stretch of the surface through star centres and its principal curvatures, positive with the plastic outside.

    The same quadratic through a star and its neighbours for cell and patch.
    """
    x, y = neighbours(vectors)[1:].T
    terms = np.column_stack([x, y, 0.5 * x * x, x * y, 0.5 * y * y])
    fit = np.linalg.lstsq(terms, places[1:] - places[0], rcond=None)[0]
    first, normal = fit[:2] @ fit[:2].T, np.cross(fit[0], fit[1])
    second = -(fit[2:] @ normal) / np.linalg.norm(normal)
    curvatures = np.linalg.eigvals(np.linalg.solve(first, second[[[0, 1], [1, 2]]])).real
    order = np.argsort(-abs(curvatures))
    return float(np.linalg.det(first) ** 0.25), float(curvatures[order[0]]), float(curvatures[order[1]])


def patch_table(rows: list[dict[str, Any]]) -> str:
    header = [
        "star, mm", "stars", "up", "stretch", "from the cell %", "from the shell %", "curvature 1/mm",
        "from the cell %", "from the shell %", "other curvature", "of the shell", "minimum",
    ]  # fmt: skip
    return markdown(
        header,
        [
            [
                _name(r),
                str(r["stars"]),
                str(r["stars_up"]),
                f"{r['stretch']:.4f}",
                f"{100 * (r['stretch'] / r['cell_stretch'] - 1):+.2f}",
                f"{100 * (r['stretch'] / r['shell_stretch'] - 1):+.2f}",
                f"{r['curvature']:.4f}",
                f"{100 * (r['curvature'] / r['cell_curvature'] - 1):+.1f}",
                f"{100 * (r['curvature'] / r['shell_curvature'] - 1):+.1f}",
                f"{r['other_curvature']:+.4f}",
                f"{r['shell_other_curvature']:+.4f}",
                "yes" if r["minimum"] and r["shell_minimum"] else "no",
            ]
            for r in rows
        ],
    )


def _name(r: dict[str, Any]) -> str:
    return f"h {r['thickness_mm']:g}, l {r['length_mm']:.2f}" + ("" if r["rim"] else ", no rim")


def plot(rows: list[dict[str, Any]]) -> None:
    """Differences over the number of stars: from the endless sheet, and from the shell of the same size."""
    figure, axes = plt.subplots(1, 2, figsize=(10.0, 4.2), layout="constrained", sharey=True)
    names = list(dict.fromkeys(_name(r) for r in rows))
    for number, label in enumerate(names):
        mine = [r for r in rows if _name(r) == label]
        stars = [r["stars"] for r in mine]
        for axis, other in zip(axes, ("cell", "shell"), strict=True):
            off = [100 * abs(r["curvature"] / r[f"{other}_curvature"] - 1) for r in mine]
            dash = "-" if mine[0]["rim"] else "--"
            axis.plot(stars, off, f"o{dash}", color=f"C{number % 3}", label=label)
    for axis, other in zip(axes, ("endless sheet", "shell of its size"), strict=True):
        axis.set(xscale="log", yscale="log", xlabel="stars of the patch", title=f"curvature against the {other}, %")
        axis.set_xticks([7, 19, 37, 61, 91], ["7", "19", "37", "61", "91"], minor=False)
        axis.minorticks_off()
        axis.grid(alpha=0.3)
    axes[0].legend(fontsize=8)
    figure.savefig(PICTURE, dpi=120)
    plt.close(figure)


if __name__ == "__main__":
    main()
