"""Tables and the plot of the mesh study (`benchmarks.convergence`): distances, orders, estimates."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from asterism.pattern.geometry.rigid_fit import rms_distance
from asterism.results.files import write_file
from asterism.shape.mesh_error import MeshErrorEstimate, estimate
from benchmarks.orders import ASYMPTOTIC, observed, rates
from benchmarks.report import markdown, write_report

PICTURE = Path(__file__).parent.parent / "docs" / "pictures" / "convergence.png"
RATIO = 2.2  # least, of vertices between two meshes of an estimate; the solver's levels have about 3
KINDS = (("paper", False), ("consistent", False), ("consistent", True))
GROUPS = [(design, bending, graded) for design in ("tube", "dome") for bending, graded in KINDS]
HEADER = [
    "mesh", "vertices", "energy N mm", "radius mm", "height mm", "contraction", "stars, % of diameter",
    "surface, %", "change, %", "estimate, %", "order", "iterations", "seconds",
]  # fmt: skip


def of_group(rows: list[dict[str, Any]], group: tuple[str, str, bool]) -> list[dict[str, Any]]:
    """Those of a design, a bending, and graded or not."""
    return [r for r in rows if (r["design"], r["bending"], r["mesh"].get("graded", False)) == group]


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


def estimated(r: dict[str, Any], rows: list[dict[str, Any]]) -> MeshErrorEstimate:
    """What `mesh_error_percent` would be for a row, with two coarser ones of its kind (rows) as its levels.

    As if all meshes resolved their creases.
    """
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


def row(r: dict[str, Any], rows: list[dict[str, Any]]) -> list[str]:
    """One line of the table of rows."""
    error = estimated(r, rows) if r in rows else MeshErrorEstimate(None, None, None)
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
        *(["-", "-"] if error.change is None else [f"{error.change:.2f}", _estimate(error.percent)]),
        "-" if error.order is None else f"{error.order:.1f}",
        str(r["iterations"]),
        f"{r['wall_s']:.1f}",
    ]


def _estimate(percent: float | None) -> str:
    return "none" if percent is None else f"{percent:.2f}"


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
        axes.set_xticks([0.5, 0.7, 1.0, 1.5, 2.0, 3.0], labels=["0.5", "0.7", "1", "1.5", "2", "3"])
        axes.set_xticks([], minor=True)
        axes.grid(True, which="major", color="0.92")
        axes.legend(frameon=False, fontsize=9)
    figure.axes[0].set_ylabel("distance to the finest mesh, % of the diameter")
    out = BytesIO()
    figure.savefig(out, format="png", dpi=110)
    write_file(PICTURE, out.getvalue())


def title(design: str, bending: str, graded: bool) -> str:
    """Heading of a table."""
    return f"### {design}, {bending}{', graded' if graded else ''}"


def verdict(rows: list[dict[str, Any]], fit: dict[str, float]) -> str:
    """Orders, where the fit found any between its bounds, and the edges that are within one per cent."""
    names = {
        "energy_n_mm": "energy",
        "radius_mm": "radius",
        "height_mm": "height",
        "stars_percent": "star centres",
        "surface_percent": "surface",
    }
    orders = ", ".join(
        f"{names[key]} {fit[key]:.1f}" if observed(fit[key]) else f"{names[key]} none" for key in names if key in fit
    )
    out = f"Observed order for edges below {ASYMPTOTIC} mm: {orders}."
    limits = [
        f"{names[key]} {fit[key + '_limit']:.2f} {unit}"
        for key, unit in (("energy_n_mm", "N mm"), ("radius_mm", "mm"), ("height_mm", "mm"))
        if key in fit and observed(fit[key])
    ]
    out += f" Limits of these orders: {', '.join(limits)}." if limits else ""
    edges = []
    for r in sorted(rows, key=lambda r: r["mesh"]["edge_mm"]):
        if r["surface_percent"] > 1.0:
            break
        edges.append(r["mesh"]["edge_mm"])
    if len(edges) > 1:
        out += f" Surface within 1 % of the finest: edges up to {edges[-1]:.2f} mm."
    if observed(fit["surface_percent"]) and fit["surface_percent_edge_mm"] < ASYMPTOTIC:
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
