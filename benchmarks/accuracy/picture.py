"""docs/pictures/verified.png: the exact shape of a design, its preview, and one in the other.

python -m benchmarks.accuracy.picture FOLDER [LAW.npz]
"""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

from asterism.draw.picture import small_png
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.pattern import gallery
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.run import preview
from asterism.reports.html import png
from asterism.reports.views import comparison_views
from asterism.results.files import write_file
from asterism.shape.comparison import compare_shapes
from benchmarks.accuracy.designs import EDGE_MM, meshed
from benchmarks.accuracy.exact import exact
from benchmarks.accuracy.report import DOCS

DESIGN = "dome"
GAP = 30  # pixels


def draw(folder: Path, law: Law) -> None:
    """Three views from the same place, from left to right."""
    design = meshed(gallery.load(DESIGN), EDGE_MM)
    plan = layout(design)
    comparison = compare_shapes(
        exact(design, folder), preview(design, law), plan, symmetries(design, plan), design.gravity.pull
    )
    seen = comparison_views(comparison)
    images = [Image.open(BytesIO(png(seen[name][0]))).convert("RGB") for name in ("exact", "preview", "overlaid")]
    width, height = sum(image.width + GAP for image in images), max(image.height for image in images)
    sheet = Image.fromarray(np.full((height, width - GAP, 3), 255, dtype=np.uint8))
    left = 0
    for image in images:
        sheet.paste(image, (left, height - image.height))
        left += image.width + GAP
    sheet.thumbnail((1400, 1400))
    write_file(DOCS / "pictures" / "verified.png", small_png(sheet))
    print(f"{DESIGN}: {comparison.rms_percent:.2f} % of the diameter")


if __name__ == "__main__":
    draw(Path(sys.argv[1]), load_law(sys.argv[2] if len(sys.argv) > 2 else None))
