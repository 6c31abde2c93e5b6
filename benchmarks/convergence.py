"""How the exact model's answer depends on the mesh: tube and dome, paper's hinges, plate, plate on graded meshes.

python -m benchmarks.convergence [FILE]

Distances are those of star centres and of the surface (at the same printed points) to the finest mesh of the same
design, after a rigid motion, and up to the symmetries of the pattern: a tube may roll about any of three axes. FILE
keeps finished cases, one a line, and spares them the next time. Every case runs in a process of its own.
"""

from __future__ import annotations

import json
import subprocess
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from asterism.files import write_file
from asterism.mesh_error import MeshError, diameter, estimate, rms_distance
from asterism.shape import Shape
from asterism.simulation import simulate
from benchmarks.report import markdown, write_report
from pattern import gallery
from pattern.build import layout
from pattern.design import Design
from pattern.meshing import mesh_layout

PICTURE = Path(__file__).parent.parent / "docs" / "pictures" / "convergence.png"
SPACING = 17.3205
CUTS = (5, 7, 9, 12, 16, 20, 25, 36)
GRADED = (7, 9, 12, 16, 19, 26, 36)
RATIO = 2.2  # least, of vertices between two meshes of an estimate; the solver's levels have about 3
ASYMPTOTIC = 1.5  # mm: orders are fitted to edges up to this
KINDS = (("paper", False), ("consistent", False), ("consistent", True))
GROUPS = [(design, bending, graded) for design in ("tube", "dome") for bending, graded in KINDS]
HEADER = [
    "mesh", "vertices", "energy N mm", "radius mm", "height mm", "contraction", "stars, % of diameter",
    "surface, %", "estimate, %", "order", "iterations", "seconds",
]  # fmt: skip


def cases() -> list[dict[str, Any]]:
    """The aligned meshes, and Delaunay meshes of the tube; small ones first."""
    sizes = {"aligned": CUTS, "graded": GRADED}
    chosen: list[tuple[int, str, str, dict[str, Any]]] = [
        (k, design, bending, {"kind": "aligned"} | ({"graded": True} if graded else {}))
        for design, bending, graded in GROUPS
        for k in sizes["graded" if graded else "aligned"]
    ]
    for k, seed in ((9, 0), (9, 1), (16, 0)):
        chosen += [(k, "tube", bending, {"kind": "delaunay", "seed": seed}) for bending in ("paper", "consistent")]
    chosen += [(5, "tube", "consistent", {"kind": "delaunay", "seed": seed, "graded": True}) for seed in (0, 1)]
    return [
        {"design": design, "bending": bending, "mesh": {"edge_mm": SPACING / k} | mesh}
        for k, design, bending, mesh in sorted(chosen, key=lambda case: case[0])
    ]


def of_group(rows: list[dict[str, Any]], group: tuple[str, str, bool]) -> list[dict[str, Any]]:
    """Those of a design, a bending, and graded or not."""
    return [r for r in rows if (r["design"], r["bending"], r["mesh"].get("graded", False)) == group]


def run(case: dict[str, Any]) -> dict[str, Any]:
    """One case, here and now."""
    data = gallery.load(case["design"]).to_dict()
    data["mesh"] = data["mesh"] | case["mesh"]
    data["fabric"] = data["fabric"] | {"bending": case["bending"]}
    shape = simulate(Design.from_dict(data))
    stars, surface = (
        [shape.at(points @ turn.T).tolist() for turn in symmetries()] for points in probes(case["design"])
    )
    summary = {key: value for key, value in shape.summary.items() if key not in ("design", "levels")}
    radius = cylinder_radius(shape) if case["design"] == "tube" else None
    return summary | case | {"radius_mm": radius, "diameter_mm": diameter(shape.positions), "at": [stars, surface]}


def probes(design: str) -> tuple[np.ndarray, np.ndarray]:
    """Printed places that are compared: star centres, and the vertices of a coarse mesh drawn in by a thousandth."""
    plan = layout(gallery.load(design))
    return plan.centres, 0.999 * mesh_layout(plan, SPACING / 5, "aligned").points


def symmetries() -> list[np.ndarray]:
    """(2, 2) turns by 120 degrees and mirrors of the printed pattern, turns first."""
    c, s = -0.5, np.sqrt(0.75)
    turn, mirror = np.array([[c, -s], [s, c]]), np.diag([-1.0, 1.0])
    turns = [np.eye(2), turn, turn.T]
    return turns + [mirror @ t for t in turns]


def cylinder_radius(shape: Shape) -> float:
    """mm, of the circular cylinder closest to the star centres in the sense of least squares."""
    points = shape.positions[shape.star_vertices]
    points = points - points.mean(axis=0)

    def across(a: np.ndarray, axes: np.ndarray) -> np.ndarray:
        axis = axes[0] + a[0] * axes[1] + a[1] * axes[2]
        axis /= np.linalg.norm(axis)
        return np.linalg.norm(np.cross(points - a[2] * axes[1] - a[3] * axes[2], axis), axis=1)

    principal = np.linalg.svd(points)[2]
    fits = [
        least_squares(lambda a, axes=axes: across(a, axes) - a[4], [0.0, 0.0, *offset, 20.0])
        for axes in (np.roll(principal, -i, axis=0) for i in range(3))
        for offset in ((0.0, 0.0), (10.0, 0.0), (-10.0, 0.0), (0.0, 10.0), (0.0, -10.0))
    ]
    return float(abs(min(fits, key=lambda fit: fit.cost).x[4]))


def distances(rows: list[dict[str, Any]]) -> None:
    """Adds `stars_percent` and `surface_percent`: to the finest aligned mesh of the same design and bending.

    With the plate it is a graded one.
    """
    for design, bending in sorted({group[:2] for group in GROUPS}):
        mine = [r for r in rows if (r["design"], r["bending"]) == (design, bending)]
        best = of_group(mine, (design, bending, bending == "consistent"))
        finest = max((r for r in best if r["mesh"]["kind"] == "aligned"), key=lambda r: r["vertices"])
        for r in mine:
            for name, k in (("stars_percent", 0), ("surface_percent", 1)):
                here = np.array(r["at"][k][0])
                found = [
                    rms_distance(np.array(there), here, mirrored=i >= 3) for i, there in enumerate(finest["at"][k])
                ]
                r[name] = 100.0 * min(found) / finest["diameter_mm"] if r is not finest else 0.0


def estimated(r: dict[str, Any], rows: list[dict[str, Any]]) -> MeshError:
    """What `mesh_error_percent` would be for a row, with two coarser ones of its kind (rows) as its levels."""
    levels: list[dict[str, Any]] = []
    last = r["vertices"]
    for coarse in sorted((q for q in rows if q["vertices"] < last), key=lambda q: -q["vertices"]):
        if coarse["vertices"] * RATIO <= last and len(levels) < 2:
            levels.insert(0, coarse)
            last = coarse["vertices"]
    here = np.array(r["at"][1][0])
    apart = [
        min(rms_distance(np.array(there), here, mirrored=i >= 3) for i, there in enumerate(q["at"][1])) for q in levels
    ]
    edges = [q["mesh"]["edge_mm"] for q in (*levels, r)]
    return estimate(edges, [100.0 * one / r["diameter_mm"] for one in apart])


def rates(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Order p and limit of `value = limit + c edge^p` for the energy, and % of the surface error at edge 1 mm.

    The distance to the finest mesh is fitted by `c (edge^p - finest^p)`, which is what an error `c edge^p` leaves.
    """
    rows = [r for r in rows if r["mesh"]["edge_mm"] < ASYMPTOTIC]
    edge = np.array([r["mesh"]["edge_mm"] for r in rows])
    out: dict[str, float] = {}
    for name in ("stars_percent", "surface_percent"):
        value = np.array([r[name] for r in rows])

        def residual(a: np.ndarray, value: np.ndarray = value) -> np.ndarray:
            return np.exp(a[0]) * (edge ** a[1] - edge.min() ** a[1]) - value

        c, p = least_squares(residual, [0.0, 1.0], bounds=([-9.0, 0.2], [5.0, 4.0])).x
        out[name], out[name + "_at_1mm"] = float(p), float(np.exp(c))
        out[name + "_edge_mm"] = float((1.0 / np.exp(c)) ** (1.0 / p))
    energy = np.array([r["energy_n_mm"] for r in rows])
    scale = energy.mean()
    fit = least_squares(
        lambda a: (a[0] - 1.0) + a[1] * edge ** a[2] - (energy / scale - 1.0),
        [1.0, 0.01, 1.0],
        bounds=([0.0, -1.0, 0.2], [2.0, 1.0, 4.0]),
    )
    out["energy"], out["energy_limit_n_mm"] = float(fit.x[2]), float(fit.x[0] * scale)
    return out


def row(r: dict[str, Any], rows: list[dict[str, Any]]) -> list[str]:
    """One line of the table of rows."""
    error = estimated(r, rows) if r in rows else MeshError(None, None, None)
    name = f"{r['mesh']['kind']} {r['mesh']['edge_mm']:.2f} mm"
    if "seed" in r["mesh"]:
        name += f", seed {r['mesh']['seed']}"
    return [
        name + ("" if r["is_minimum"] else " (no minimum)"),
        str(r["vertices"]),
        f"{r['energy_n_mm']:.2f}",
        "-" if r["radius_mm"] is None else f"{r['radius_mm']:.2f}",
        f"{r['height_mm']:.2f}",
        f"{r['contraction']:.4f}",
        f"{r['stars_percent']:.2f}",
        f"{r['surface_percent']:.2f}",
        "-" if error.percent is None else f"{error.percent:.2f}",
        ("none" if error.asymptotic is False else "-") if not error.asymptotic else f"{error.order:.1f}",
        str(r["iterations"]),
        f"{r['wall_s']:.1f}",
    ]


def plot(rows: list[dict[str, Any]]) -> None:
    """docs/pictures/convergence.png: distance of the surface to the finest mesh over the edge length."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 3.8), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, design in zip(figure.subplots(1, 2, sharey=True), ("tube", "dome"), strict=True):
        for (bending, graded), colour in zip(KINDS, ("tab:red", "tab:blue", "tab:green"), strict=True):
            mine = of_group(rows, (design, bending, graded))
            for kind, style in (("aligned", "o-"), ("delaunay", "x")):
                some = [r for r in mine if r["mesh"]["kind"] == kind and r["surface_percent"] > 0.0]
                some.sort(key=lambda r: r["mesh"]["edge_mm"])
                label = f"{bending}, {'graded ' if graded else ''}{kind}"
                if some:
                    edge, distance = zip(*((r["mesh"]["edge_mm"], r["surface_percent"]) for r in some), strict=True)
                    axes.loglog(edge, distance, style, color=colour, label=label, markersize=5)
        axes.axhline(1.0, color="0.7", linewidth=1.0, zorder=0)
        axes.set(title=design, xlabel="edge, mm")
        axes.set_xticks([0.7, 1.0, 1.5, 2.0, 3.0], labels=["0.7", "1", "1.5", "2", "3"])
        axes.set_xticks([], minor=True)
        axes.grid(True, which="major", color="0.92")
        axes.legend(frameon=False, fontsize=9)
    figure.axes[0].set_ylabel("distance to the finest mesh, % of the diameter")
    out = BytesIO()
    figure.savefig(out, format="png", dpi=110)
    write_file(PICTURE, out.getvalue())


def main(words: list[str]) -> None:
    if words[:1] == ["--case"]:
        print(json.dumps(run(json.loads(words[1]))))
        return
    kept = Path(words[0]) if words else None
    rows = [json.loads(line) for line in kept.read_text().splitlines()] if kept and kept.exists() else []
    for case in cases():
        if any(all(r[key] == value for key, value in case.items()) for r in rows):
            continue
        command = [sys.executable, "-m", "benchmarks.convergence", "--case", json.dumps(case)]
        line = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[-1]
        rows.append(json.loads(line))
        if kept:
            with kept.open("a") as file:
                file.write(line + "\n")
        r = rows[-1]
        print(r["design"], r["bending"], r["mesh"], r["vertices"], r["energy_n_mm"], f"{r['wall_s']:.1f} s", flush=True)
    report(rows)


def title(design: str, bending: str, graded: bool) -> str:
    """Heading of a table."""
    return f"### {design}, {bending}{', graded' if graded else ''}"


def verdict(rows: list[dict[str, Any]], fit: dict[str, float]) -> str:
    """Orders, where the fit found any between its bounds, and the edges that are within one per cent."""
    names = {"energy": "energy", "stars_percent": "star centres", "surface_percent": "surface"}
    orders = ", ".join(
        f"{name} {fit[key]:.1f}" if 0.21 < fit[key] < 3.9 else f"{name} none" for key, name in names.items()
    )
    out = f"Observed order for edges below {ASYMPTOTIC} mm: {orders}."
    edges = []
    for r in sorted(rows, key=lambda r: r["mesh"]["edge_mm"]):
        if r["surface_percent"] > 1.0:
            break
        edges.append(r["mesh"]["edge_mm"])
    if len(edges) > 1:
        out += f" Surface within 1 % of the finest: edges up to {edges[-1]:.2f} mm."
    if 0.21 < fit["surface_percent"] < 3.9 and fit["surface_percent_edge_mm"] < ASYMPTOTIC:
        out += f" Within 1 % of the limit of that order: up to {fit['surface_percent_edge_mm']:.2f} mm."
    return out


def report(rows: list[dict[str, Any]]) -> None:
    """Distances, tables, plot."""
    distances(rows)
    tables = []
    for design, bending, graded in GROUPS:
        mine = of_group(rows, (design, bending, graded))
        aligned = sorted((r for r in mine if r["mesh"]["kind"] == "aligned"), key=lambda r: r["vertices"])
        fit = rates(aligned)
        others = [r for r in mine if r["mesh"]["kind"] != "aligned"]
        tables.append(
            f"{title(design, bending, graded)}\n\n{markdown(HEADER, [row(r, aligned) for r in aligned + others])}"
        )
        tables[-1] += f"\n\n{verdict(aligned, fit)}"
        print(tables[-1])
    plot(rows)
    write_report("convergence", [{k: v for k, v in r.items() if k != "at"} for r in rows], "\n\n".join(tables))


if __name__ == "__main__":
    main(sys.argv[1:])
