"""Draws the figures of the explanations: `python docs/pictures/figures.py [NAME]`, where asterism is installed.

Meshes, law and shell are the product's own; the rest are diagrams.
"""

from __future__ import annotations

import sys
from io import StringIO
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from skfem import MeshTri

import asterism
from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.relax import relax
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import of_stretch
from asterism.fem.shell.shell import Shell
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout

FOLDER = Path(__file__).parent
INK, ARM, FABRIC, BLUE, ORANGE = "#333333", "#283593", "#f4e8d0", "#dfe4f5", "#fde3d3"


def figure(width: float, height: float, columns: int = 1, **options: Any) -> tuple[Figure, Any]:
    """A figure in inches, and its axes without frames."""
    sheet = Figure(figsize=(width, height), layout="constrained", facecolor="white")
    axes = np.atleast_1d(sheet.subplots(1, columns, **options))
    for each in axes:
        each.set_axis_off()
    return sheet, axes


def save(sheet: Figure, name: str) -> None:
    """NAME.svg, the same bytes every time."""
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": name, "font.family": "sans-serif"}):
        text = StringIO()
        FigureCanvasSVG(sheet).print_svg(text, metadata={"Date": None})
    # matplotlib writes a line for each corner
    (FOLDER / f"{name}.svg").write_text(" ".join(text.getvalue().split()) + "\n", encoding="utf-8")


def box(axes: Any, x: float, y: float, text: str, colour: str = BLUE, width: float = 2.3, height: float = 0.75) -> None:
    """A box around a text, its middle at x and y."""
    corner = (x - width / 2, y - height / 2)
    axes.add_patch(
        matplotlib.patches.FancyBboxPatch(corner, width, height, "round,pad=0.05", fc=colour, ec=INK, lw=0.8)
    )
    axes.text(x, y, text, ha="center", va="center", fontsize=8.5, color=INK)


def arrow(axes: Any, start: tuple[float, float], end: tuple[float, float]) -> None:
    """An arrow between two points."""
    axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 0.9, "shrinkA": 0, "shrinkB": 0})


def pipeline() -> None:
    """From a design file to a shape, by both models."""
    sheet, (axes,) = figure(8.4, 3.9)
    box(axes, 1.2, 3.0, "design file\n(TOML)", "white")
    box(axes, 4.2, 3.0, "Design\nprofiles and pins, checked")
    box(axes, 7.2, 3.0, "Layout\nplaces of stars, rods, pins")
    exact = ("Mesh\ntriangles along every arm", "energies\nfabric, rods, joints", "release\nin steps, finer meshes")
    preview = ("law\ncells of the pattern", "fields\nrest metric, rest curvature", "Shell\nand the bumps of stars")
    for x, above, below in zip((1.2, 4.2, 7.2), exact, preview, strict=True):
        box(axes, x, 1.6, above, FABRIC)
        box(axes, x, 0.2, below, ORANGE)
    box(axes, 10.2, 0.9, "Newton's method\nand certificate")
    box(axes, 10.2, 3.0, "Shape\na map into space")
    box(axes, 10.2, 4.3, "summary, pictures,\ncomparison, print files", "white")
    for y in (3.0, 1.6, 0.2):
        arrow(axes, (2.4, y), (3.0, y))
        arrow(axes, (5.4, y), (6.0, y))
    axes.plot([7.2, 7.2, 0.0 - 0.25, -0.25], [2.57, 2.3, 2.3, 0.2], color=INK, lw=0.9)
    arrow(axes, (-0.25, 1.6), (0.0, 1.6))
    arrow(axes, (-0.25, 0.2), (0.0, 0.2))
    arrow(axes, (8.4, 1.6), (9.0, 1.15))
    arrow(axes, (8.4, 0.2), (9.0, 0.65))
    arrow(axes, (10.2, 1.33), (10.2, 2.57))
    arrow(axes, (10.2, 3.43), (10.2, 3.87))
    axes.text(0.05, 2.04, "exact model", fontsize=8.5, color=INK, style="italic", va="bottom")
    axes.text(0.05, 0.64, "preview", fontsize=8.5, color=INK, style="italic", va="bottom")
    axes.set(xlim=(-0.4, 11.6), ylim=(-0.4, 4.85), aspect="equal")
    save(sheet, "pipeline")


def packages() -> None:
    """The packages and their imports."""
    sheet, (axes,) = figure(6.4, 3.2)
    places = {"asterism": (3, 3), "homogenize": (3, 2), "fem": (6, 1), "discrete": (0, 1)}
    places |= {"equilibrium": (4.6, 0), "pattern": (1.4, 0)}
    imports = "asterism>homogenize asterism>fem asterism>discrete homogenize>discrete homogenize>equilibrium "
    imports += "homogenize>pattern fem>equilibrium discrete>equilibrium discrete>pattern"
    for pair in imports.split():
        (x, y), (to_x, to_y) = (np.array(places[name], float) for name in pair.split(">"))
        arrow(axes, (x + 0.2 * (to_x - x), y - 0.22), (to_x - 0.2 * (to_x - x), to_y + 0.24))
    for name, (x, y) in places.items():
        box(axes, x, y, name, FABRIC if name in ("equilibrium", "pattern") else BLUE, 1.6, 0.34)
    axes.set(xlim=(-1.1, 7.1), ylim=(-0.4, 3.4), aspect="equal")
    save(sheet, "packages")


def triangles(axes: Any, edge_mm: float, graded: bool, rings: int = 1) -> Any:
    """The mesh of a sheet of stars, with its arms."""
    design = asterism.Design.from_dict({"stars": {"length_mm": 10.0}, "border": {"rings": rings}})
    mesh = mesh_layout(layout(design), edge_mm, graded=graded)
    axes.triplot(*mesh.points.T, mesh.triangles, color="#b59b66", lw=0.5)
    axes.fill(*mesh.points[mesh.border_vertices].T, color=FABRIC, zorder=0)
    for rod in mesh.rods:
        axes.plot(*mesh.points[rod].T, color=ARM, lw=2.2, solid_capstyle="butt")
    axes.set_aspect("equal")
    return mesh


def meshes() -> None:
    """exact-model.svg and mesh.svg."""
    sheet, (whole, part) = figure(7.2, 3.5, 2)
    triangles(whole, 2.47, False)
    triangles(part, 2.47, False)
    part.set(xlim=(-12.5, 12.5), ylim=(-13.5, 10.5))
    whole.add_patch(matplotlib.patches.Rectangle((-12.5, -13.5), 25, 24, fill=False, ec=INK, lw=0.8))
    part.annotate(
        "rod: bends, twists, stretches", (0.0, -6.0), (1.6, -12.6), fontsize=8, arrowprops={"arrowstyle": "-"}
    )
    part.annotate("triangle: membrane", (-5.6, -4.3), (-12.3, -11.0), fontsize=8, arrowprops={"arrowstyle": "-"})
    part.annotate("edge: fabric bends", (3.1, 5.4), (-3.5, 9.3), fontsize=8, arrowprops={"arrowstyle": "-"})
    save(sheet, "exact-model")
    sheet, (even, graded) = figure(7.2, 3.5, 2)
    for axes, is_graded, title in ((even, False, "even"), (graded, True, "graded")):
        triangles(axes, 1.73, is_graded)
        axes.set(xlim=(-15, 15), ylim=(-15, 13))
        axes.set_title(title, fontsize=9)
    save(sheet, "mesh")


def joints() -> None:
    """Kinds of nodes."""
    sheet, (axes,) = figure(7.2, 2.0)
    lines = {
        "free end": [[(0, 0), (1.2, 0)]],
        "corner": [[(0, -0.4), (0.6, 0.4), (1.2, -0.4)]],
        "crossing": [[(0, -0.4), (1.2, 0.4)], [(0, 0.4), (1.2, -0.4)]],
        "branch": [[(0, 0), (1.2, 0)], [(0.6, 0), (0.95, 0.6)]],
        "centre of a star": [[(0.6, 0), (0.6 + 0.6 * np.cos(a), 0.6 * np.sin(a))] for a in np.radians([-90, 30, 150])],
    }
    nodes = {"free end": (1.2, 0), "corner": (0.6, 0.4), "crossing": (0.6, 0), "branch": (0.6, 0)}
    for column, (name, paths) in enumerate(lines.items()):
        shift = 2.0 * column
        for path in paths:
            axes.plot(shift + np.array(path)[:, 0], np.array(path)[:, 1], color=ARM, lw=4, solid_capstyle="butt")
        x, y = nodes.get(name, (0.6, 0))
        axes.plot(x + shift, y, "o", mfc="white", mec="#e64a19", mew=1.5, ms=9)
        axes.text(shift + 0.6, -1.0, name, ha="center", fontsize=9, color=INK)
    axes.set(xlim=(-0.3, 9.7), ylim=(-1.2, 0.8), aspect="equal")
    save(sheet, "joints")


def law() -> None:
    """Contraction and natural curvature of the included law."""
    sheet, axes = figure(7.2, 2.9, 2)
    table, lengths = asterism.load_law().at(1.35), np.linspace(0.0, 13.0, 105)
    for thickness, colour in ((0.3, "#e64a19"), (0.4, ARM), (0.5, "#00897b")):
        values = table(lengths, np.full_like(lengths, thickness), np.full_like(lengths, 1.2)).value
        for each, key in zip(axes, ("lam_n", "kappa"), strict=True):
            each.plot(lengths, values[key], color=colour, lw=1.6, label=f"{thickness} mm thick")
    for each, name in zip(axes, ("contraction", "natural curvature, 1/mm"), strict=True):
        each.set_axis_on()
        each.set_xlabel("length of the arms, mm", fontsize=9)
        each.set_title(name, fontsize=9)
        each.tick_params(labelsize=8)
        each.grid(lw=0.3)
    axes[0].legend(fontsize=8, frameon=False)
    save(sheet, "law")


def shell() -> None:
    """Guesses for a square with an isotropic rest curvature, and its minimum."""
    mesh = MeshTri.init_sqsymmetric().refined()
    mesh = MeshTri(100.0 * mesh.p - 50.0, mesh.t)
    fields = of_stretch(Density(isotropic(membrane=20.0, bending=10.0, poisson=0.3)), stretch=1.0, curvature=-0.02)
    solved = Shell(Argyris(mesh), fields)
    found = relax(solved)
    assert found.is_minimum
    side = np.linspace(-49.9, 49.9, 13)
    x, y = np.meshgrid(side, side)
    points = np.column_stack([x.ravel(), y.ravel()])
    tube = solved.space.locate(points).value @ found.x
    tube = (tube - tube.mean(axis=0)) @ np.linalg.svd(tube - tube.mean(axis=0), full_matrices=False)[2].T
    surfaces = {
        "an arc": np.dstack([x, y, -0.008 * x**2]),
        "a cap": np.dstack([x, y, -0.005 * (x**2 + y**2)]),
        "a saddle": np.dstack([x, y, 0.005 * (y**2 - x**2)]),
        "the minimum": tube.reshape(*x.shape, 3),
    }
    sheet, axes = figure(8.0, 2.3, 4, subplot_kw={"projection": "3d"})
    for each, (name, places) in zip(axes, surfaces.items(), strict=True):
        colour = FABRIC if name == "the minimum" else BLUE
        each.plot_surface(*np.moveaxis(places, 2, 0), color=colour, edgecolor="#888888", lw=0.25, shade=True)
        each.set_aspect("equal")
        each.set_title(name, fontsize=9)
    save(sheet, "shell")


if __name__ == "__main__":
    for draw in (pipeline, packages, meshes, joints, law, shell):
        if draw.__name__ in sys.argv[1:] or len(sys.argv) == 1:
            draw()
