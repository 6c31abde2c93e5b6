"""Sheets that roll up further than round, with and without contact: numbers, seconds, and a picture.

python -m benchmarks.contact
"""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from PIL import Image

from asterism.draw.picture import small_png
from asterism.draw.render import camera, render, scene
from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.results.files import write_file
from asterism.shape.shape import Shape
from benchmarks.gallery import PICTURES
from benchmarks.report import markdown, write_report

# the tube of the gallery stays open; with thinner arms, which curl more, it rolls up further than round
THICKNESSES = {"tube": 0.4, "tube, arms 0.3 mm thick": 0.3}
HEADER = [
    "design", "contact", "vertices", "pairs of triangles through each other", "least distance mm", "extent mm",
    "energy N mm", "smallest eigenvalue N/mm", "iterations", "factorisations", "seconds",
]  # fmt: skip


def main() -> None:
    rows: list[dict[str, Any]] = []
    shapes: list[Shape] = []
    for name, thickness in THICKNESSES.items():
        for contact in (False, True):
            data = gallery.load("tube").to_dict()
            data["stars"]["thickness_mm"] = thickness
            data["solver"]["contact"] = contact
            shapes.append(exact_shape(Design.from_dict(data)))
            summary = {key: value for key, value in shapes[-1].summary.items() if key != "design"}
            rows.append(summary | {"name": name, "with_contact": contact})
            print("  ".join(row(rows[-1])), flush=True)
    write_report("contact", rows, markdown(HEADER, [row(r) for r in rows]))
    picture(shapes[-2:])


def row(r: dict[str, Any]) -> list[str]:
    """One line of the table."""
    least = (r["self_contact"] or {}).get("least_distance_mm")
    return [
        r["name"],
        "yes" if r["with_contact"] else "no",
        str(r["vertices"]),
        str(r["self_intersections"]),
        "-" if least is None else f"{least:.2f}",
        " x ".join(f"{size:.1f}" for size in r["extent_mm"]),
        f"{r['energy_n_mm']:.2f}",
        f"{r['smallest_eigenvalue']:.1e}" if r["is_minimum"] else "no minimum",
        str(r["iterations"]),
        str(r["factorisations"]),
        f"{r['wall_s']:.1f}",
    ]


def picture(shapes: list[Shape]) -> None:
    """docs/pictures/contact.png: the last design without and with contact; below, cut across its axis."""
    figure = Figure(figsize=(10.0, 8.6), dpi=100, facecolor="white")
    FigureCanvasAgg(figure)
    views = figure.subplots(2, 2, gridspec_kw={"height_ratios": [1.0, 1.15]})
    cuts = [section(shape.aligned()) for shape in shapes]
    reach = 1.05 * max(float(np.abs(cut).max()) for cut in cuts)
    for column, shape, cut, title in zip(views.T, shapes, cuts, ("without contact", "with contact"), strict=True):
        turned = shape.aligned()
        middle = (turned.positions.min(axis=0) + turned.positions.max(axis=0)) / 2
        eye = camera(-28.0, 22.0, middle, 300.0)
        column[0].imshow(render(scene(turned), eye, 6.0), origin="lower")
        column[0].set_title(title, fontsize=14)
        lower = column[1]
        lower.set_xlim(-reach, reach)
        lower.set_ylim(-reach, reach)
        lower.set_aspect("equal")
        points_per_mm = 72.0 * lower.get_window_extent().height / figure.dpi / (2.0 * reach)
        thick = shape.summary["design"]["fabric"]["thickness_mm"] * points_per_mm
        lower.add_collection(LineCollection(list(cut), linewidths=thick, colors="#9d4b36", capstyle="round"))
        lower.set_title("cut across the axis, fabric as thick as it is", fontsize=10, color="#7a7a82")
        for axes in column:
            axes.set_axis_off()
    figure.tight_layout()
    large = BytesIO()
    figure.savefig(large, format="png")
    write_file(PICTURES / "contact.png", small_png(Image.open(large)))


def section(shape: Shape) -> np.ndarray:
    """(n, 2, 2) mm, pieces of the line where the sheet meets the plane x = 0, about their middle."""
    corner = shape.positions[shape.triangles]
    pieces = []
    for triangle in corner[(corner[:, :, 0].min(axis=1) < 0.0) & (corner[:, :, 0].max(axis=1) > 0.0)]:
        ends = []
        for a, b in ((0, 1), (1, 2), (2, 0)):
            p, q = triangle[a], triangle[b]
            if p[0] * q[0] < 0.0:
                ends.append((p + p[0] / (p[0] - q[0]) * (q - p))[1:])
        if len(ends) == 2:
            pieces.append(ends)
    lines = np.array(pieces)
    return lines - (lines.min(axis=(0, 1)) + lines.max(axis=(0, 1))) / 2


if __name__ == "__main__":
    main()
