"""How the exact model depends on its mesh: even meshes with the paper's hinges or a plate, and graded ones."""

from __future__ import annotations

from io import BytesIO

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from scipy.optimize import least_squares

from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.results.files import write_file
from asterism.shape.comparison import compare_shapes
from asterism.shape.shape import Shape
from benchmarks.report import PICTURES, markdown, number, write_report

SPACING_MM = 17.3205
DESIGNS = ("tube", "dome")
DIVISIONS, GRADED = (5, 7, 9, 12, 16, 20, 25, 36), (7, 9, 12, 16, 19, 26, 36)  # edges between two stars
MESHES = {
    "hinges": ("paper", False, DIVISIONS), "plate": ("consistent", False, DIVISIONS),
    "graded plate": ("consistent", True, GRADED),
}  # fmt: skip
HEADER = [
    "sheet", "bending", "edge mm", "vertices", "energy N mm", "radius mm", "height mm", "contraction",
    "to the finest mesh, %", "seconds",
]  # fmt: skip


def convergence(*names: str) -> None:
    """convergence.png and its table; with names of designs the table of these only.

    Distances are those of the surfaces after a rigid motion, to the finest mesh with hinges, or graded with the plate.
    """
    figure = Figure(figsize=(9.0, 3.8), layout="constrained")
    FigureCanvasAgg(figure)
    lines = []
    for axes, name in zip(figure.subplots(1, 2, sharey=True), DESIGNS, strict=True):
        if names and name not in names:
            continue
        shapes = {kind: [_shape(name, kind, count) for count in MESHES[kind][2]] for kind in MESHES}
        plan, same = layout(gallery.load(name)), symmetries(gallery.load(name), layout(gallery.load(name)))
        for kind, colour in zip(MESHES, ("tab:red", "tab:blue", "tab:green"), strict=True):
            finest, points = shapes["hinges" if kind == "hinges" else "graded plate"][-1], []
            for count, shape in zip(MESHES[kind][2], shapes[kind], strict=True):
                comparison, s = compare_shapes(finest, shape, plan, same), shape.summary
                percent = 0.0 if shape is finest else comparison.rms_after_motion_percent
                points += [(SPACING_MM / count, percent)] if percent else []
                radius = _radius_mm(shape) if name == "tube" else None
                lines.append(
                    [
                        name, kind, f"{SPACING_MM / count:.2f}", str(s["vertices"]), f"{s['energy_n_mm']:.2f}",
                        number(radius), f"{s['height_mm']:.2f}", f"{s['contraction']:.4f}", f"{percent:.2f}",
                        f"{s['wall_s']:.1f}",
                    ]
                )  # fmt: skip
            axes.loglog(*zip(*points, strict=True), "o-", color=colour, label=kind, markersize=5)
        axes.axhline(1.0, color="0.7", linewidth=1.0, zorder=0)
        axes.set(title=name, xlabel="edge, mm")
        axes.set_xticks([0.5, 0.7, 1.0, 1.5, 2.0, 3.0], labels=["0.5", "0.7", "1", "1.5", "2", "3"])
        axes.set_xticks([], minor=True)
        axes.grid(True, which="major", color="0.92")
        axes.legend(frameon=False, fontsize=9)
    print(markdown(HEADER, lines))
    if not names:
        write_report("convergence", markdown(HEADER, lines), "python -m benchmarks.pictures convergence")
        figure.axes[0].set_ylabel("distance to the finest mesh, % of the diameter")
        out = BytesIO()
        figure.savefig(out, format="png", dpi=110)
        write_file(PICTURES / "convergence.png", out.getvalue())


def _shape(name: str, kind: str, count: int) -> Shape:
    bending, is_graded, _ = MESHES[kind]
    data = gallery.load(name).to_dict()
    data["mesh"] |= {"edge_mm": SPACING_MM / count, "kind": "aligned", "graded": is_graded}
    data["fabric"] |= {"bending": bending}
    shape = exact_shape(Design.from_dict(data))
    print(name, kind, f"{SPACING_MM / count:.2f} mm: {shape.summary['wall_s']:.1f} s", flush=True)
    return shape


def _radius_mm(shape: Shape) -> float:
    """Of the circular cylinder that is closest to the star centres."""
    points = shape.positions[shape.star_vertices]
    points = points - points.mean(axis=0)
    axes = np.linalg.svd(points)[2]

    def apart(a: np.ndarray, axis: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        along = axis + a[0] * u + a[1] * v
        return np.linalg.norm(np.cross(points - a[2] * u - a[3] * v, along / np.linalg.norm(along)), axis=1) - a[4]

    starts = [
        (np.roll(axes, -i, axis=0), at) for i in range(3) for at in ((0, 0), (10, 0), (-10, 0), (0, 10), (0, -10))
    ]
    fits = [least_squares(apart, [0.0, 0.0, *at, 20.0], args=tuple(turned)) for turned, at in starts]
    return float(abs(min(fits, key=lambda fit: fit.cost).x[4]))
