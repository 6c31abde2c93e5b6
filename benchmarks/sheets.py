"""Every design of the gallery exported for the paper's printer and read back; pictures of the sheets for the docs.

python -m benchmarks.sheets
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any

import pypdfium2
import trimesh

from asterism.draw.picture import small_png
from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.print.job import prepare
from asterism.print.printed_shape import shape_change
from asterism.print.profiles import load_plastic, load_printer
from asterism.print.rounded import without_rounding
from asterism.print.write import write_export
from asterism.results.files import write_file
from benchmarks.report import markdown, write_report

PICTURES = Path(__file__).parent.parent / "docs" / "pictures"
# name of the picture: design, page of its layout.pdf
SHOWN = {"sheet-layout": ("u-shape", 0), "sheet-needles": ("roof", 2)}
HEADER = [
    "design", "stars", "thickness mm", "stars rounded", "change of shape", "box mm", "pieces", "volume mm3",
    "watertight", "printed border", "needles", "minutes", "g", "seconds",
]  # fmt: skip


def main() -> None:
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in gallery.names():
            rows.append(exported(name, Path(folder) / name))
            print("  ".join(row(rows[-1])), flush=True)
        for picture, (name, page) in SHOWN.items():
            write_file(PICTURES / f"{picture}.png", rendered(Path(folder) / name / "layout.pdf", page))
    write_report("sheets", rows, markdown(HEADER, [row(r) for r in rows]))


def exported(name: str, folder: Path) -> dict[str, Any]:
    """Export one design, and read its stars back with another library."""
    design = gallery.load(name)
    printer, plastic = load_printer("ultimaker2"), load_plastic("tpu95a")
    start = time.perf_counter()
    job = prepare(design, printer, plastic)
    summary = write_export(job, folder)
    seconds = time.perf_counter() - start
    change = None
    if summary["rounding"]["thickness"]["stars_changed"] or summary["rounding"]["width"]["stars_changed"]:
        change = shape_change(
            exact_shape(without_rounding(design)), exact_shape(job.design), job.design, job.plan, "exact"
        )
    mesh = trimesh.load_mesh(folder / "stars.stl")
    return {
        "name": name,
        "stars": summary["stars"],
        "rounding": summary["rounding"],
        "shape_change": change and change.to_json(),
        "extents_mm": mesh.extents.tolist(),
        "pieces": int(mesh.body_count),
        "volume_mm3": float(mesh.volume),
        "watertight": bool(mesh.is_watertight),
        "printed_border": summary["printed_border"],
        "needles": summary["needles"],
        "estimate": summary["estimate"],
        "seconds": seconds,
    }


def row(r: dict[str, Any]) -> list[str]:
    """One line of the table."""
    thickness, change = r["rounding"]["thickness"], r["shape_change"]
    return [
        r["name"],
        str(r["stars"]),
        ", ".join(f"{value:g}" for value in thickness["values_mm"]),
        str(thickness["stars_changed"]),
        "-" if change is None else f"{change['star_distance_mm']:.2f} mm, {change['star_distance_percent']:.1f} %",
        " x ".join(f"{size:.2f}" for size in r["extents_mm"]),
        str(r["pieces"]),
        f"{r['volume_mm3']:.2f}",
        "yes" if r["watertight"] else "NO",
        "yes" if r["printed_border"] else "no",
        str(r["needles"]),
        f"{r['estimate']['minutes']:.1f}",
        f"{r['estimate']['mass_g']:.2f}",
        f"{r['seconds']:.1f}",
    ]


def rendered(pdf: Path, page: int) -> bytes:
    """A page as a picture, small enough for a page of the documentation."""
    document = pypdfium2.PdfDocument(pdf)
    image = document[page].render(scale=1.2).to_pil().convert("RGB")
    document.close()
    return small_png(image)


if __name__ == "__main__":
    main()
