"""Unit cells: what a sample costs, and how free patches of the exact model come near to the endless sheet.

python -m benchmarks.cells
"""

from __future__ import annotations

import statistics
import time
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from benchmarks.report import markdown, write_report
from discrete.model import Model
from discrete.solve import relax
from discrete.stars import bumped
from discrete.state import State, carried
from homogenize.sample import Sample, respond
from pattern.build import layout
from pattern.design import Design
from pattern.meshing import mesh_layout

PICTURE = Path(__file__).parent.parent / "docs" / "pictures" / "cell_vs_patch.png"
SIZES = ((10.0, 0.4), (10.0, 0.6), (7.0, 0.3))  # length and thickness, mm
RINGS = (1, 2, 3, 4, 5)
EDGES = (2.1, 1.15)
PATCH_EDGE = 1.92
RUNS = 3


def main() -> None:
    respond(sheet(5.0, 0.4, 1), 2.1)  # compiles
    costs = [cost(length, thickness, edge) for length, thickness in SIZES for edge in EDGES]
    print(cost_table(costs), flush=True)
    patches = [row for length, thickness in SIZES for row in compare(length, thickness)]
    patches += compare(7.0, 0.3, rim=False)
    print(patch_table(patches), flush=True)
    text = f"Seconds of one sample by part, median of {RUNS}:\n\n{cost_table(costs)}\n\n"
    text += f"The core of free patches, rolled at first, against the cell's natural tube, edges of {PATCH_EDGE} mm:\n\n"
    write_report("cells", costs + patches, text + patch_table(patches))
    plot(patches)


def sheet(length: float, thickness: float, rings: int, edge: float = PATCH_EDGE, rim: bool = True) -> Design:
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


def cost(length: float, thickness: float, edge: float) -> dict[str, Any]:
    """Median seconds of a sample by part."""
    runs = []
    for _ in range(RUNS):
        start = time.perf_counter()
        sample = respond(sheet(length, thickness, 1), edge)
        runs.append(sample.seconds | {"all": time.perf_counter() - start})
    seconds = {part: statistics.median(run[part] for run in runs) for part in runs[0]}
    return {
        "kind": "cost", "length_mm": length, "thickness_mm": thickness, "edge_mm": edge, "vertices": sample.vertices,
        "iterations": sample.iterations, "seconds": seconds,
    }  # fmt: skip


def compare(length: float, thickness: float, rim: bool = True) -> list[dict[str, Any]]:
    """Patches of growing size against the cell."""
    sample = respond(sheet(length, thickness, 1), PATCH_EDGE)
    best = int(np.argmin(sample.natural_energy))
    expected = measure(sheet(length, thickness, 1).lattice.vectors, on_tube(sample, best))
    rows = []
    for rings in RINGS:
        design = sheet(length, thickness, rings, rim=rim)
        model, start = rolled_up(design, sample, best)
        solved = relax(model, start=start)
        stars = model.mesh.star_vertices
        places = solved.state.positions[stars]
        near = core(rings, model.mesh.points[stars], places)
        found = [float(value) for value in np.mean([measure(step, at) for step, at in near], axis=0)]
        rows.append(
            {
                "kind": "patch", "length_mm": length, "thickness_mm": thickness, "rings": rings, "rim": rim,
                "stars": len(places), "stars_up": solved.stars_up, "minimum": solved.is_minimum,
                "stretch": found[0], "curvature": found[1], "other_curvature": found[2],
                "cell_stretch": expected[0], "cell_curvature": expected[1],
                "angle_deg": float(np.degrees(sample.angles_rad[best])), "seconds": solved.seconds,
            }
        )  # fmt: skip
        print(rows[-1], flush=True)
    return rows


def rolled_up(design: Design, sample: Sample, direction: int) -> tuple[Model, State]:
    """The patch's model, and the patch rolled as the cell's natural tube is, its stars bumped up."""
    plan = layout(design)
    model = Model(design, plan, mesh_layout(plan, PATCH_EDGE))
    angle, curvature = sample.angles_rad[direction], sample.natural_print_curvature[direction]
    x, y = model.mesh.points.T
    along, turn = x * np.cos(angle) + y * np.sin(angle), curvature * (y * np.cos(angle) - x * np.sin(angle))
    radius = 1.0 / sample.natural_curvature[direction]
    tube = [sample.natural_axial[direction] * along, radius * np.sin(turn), radius * np.cos(turn)]
    middle = turn[model.edges].mean(axis=1)
    state = State(np.column_stack(tube), np.column_stack([0.0 * middle, np.sin(middle), np.cos(middle)]))
    state = carried(state, model.edges, state.positions, np.zeros(len(model.edges)))
    return model, bumped(model, state, np.full(len(plan.centres), sample.natural_bump_mm[direction]))


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


def cost_table(rows: list[dict[str, Any]]) -> str:
    parts = list(dict.fromkeys(part for row in rows for part in row["seconds"]))
    table = [
        [
            f"h {r['thickness_mm']:g}, l {r['length_mm']:g}",
            f"{r['edge_mm']:g}",
            str(r["vertices"]),
            str(r["iterations"]),
        ]
        + [f"{r['seconds'].get(part, 0.0):.2f}" for part in parts]
        for r in rows
    ]
    return markdown(["star, mm", "edge mm", "vertices", "iterations", *(f"{part} s" for part in parts)], table)


def patch_table(rows: list[dict[str, Any]]) -> str:
    header = [
        "star, mm", "stars", "up", "stretch", "of the cell", "difference %", "curvature 1/mm", "of the cell",
        "difference %", "other curvature", "minimum",
    ]  # fmt: skip
    return markdown(
        header,
        [
            [
                _name(r),
                str(r["stars"]),
                str(r["stars_up"]),
                f"{r['stretch']:.4f}",
                f"{r['cell_stretch']:.4f}",
                f"{100 * (r['stretch'] / r['cell_stretch'] - 1):+.2f}",
                f"{r['curvature']:.4f}",
                f"{r['cell_curvature']:.4f}",
                f"{100 * (r['curvature'] / r['cell_curvature'] - 1):+.1f}",
                f"{r['other_curvature']:+.4f}",
                "yes" if r["minimum"] else "no",
            ]
            for r in rows
        ],
    )


def _name(r: dict[str, Any]) -> str:
    return f"h {r['thickness_mm']:g}, l {r['length_mm']:g}" + ("" if r["rim"] else ", no rim")


def plot(rows: list[dict[str, Any]]) -> None:
    """Differences over the number of stars."""
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.6), layout="constrained")
    for label in dict.fromkeys(_name(r) for r in rows):
        mine = [r for r in rows if _name(r) == label]
        stars = [r["stars"] for r in mine]
        for axis, key in zip(axes, ("stretch", "curvature"), strict=True):
            off = [100 * abs(r[key] / r[f"cell_{key}"] - 1) for r in mine]
            axis.plot(stars, off, "o-", label=label)
    for axis, key in zip(axes, ("stretch", "curvature"), strict=True):
        axis.set(xscale="log", yscale="log", xlabel="stars of the patch", ylabel=f"{key}: difference from the cell, %")
        axis.set_xticks([7, 19, 37, 61, 91], ["7", "19", "37", "61", "91"], minor=False)
        axis.minorticks_off()
        axis.grid(alpha=0.3)
    axes[0].legend()
    figure.savefig(PICTURE, dpi=120)
    plt.close(figure)


if __name__ == "__main__":
    main()
