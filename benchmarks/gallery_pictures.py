"""The small pictures of the gallery and the drawn patterns that the studio shows on its first page.

python -m benchmarks.gallery_pictures [NAME ...]    (with names: these only)

Each picture is the preview of a design in perspective, on a transparent ground, so that it stands on light and dark
pages. A design without a preview, such as a drawing, is computed with the exact model.
"""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

from asterism.draw.render import OBLIQUE, camera, render, scene
from asterism.equilibrium.arrays import Floats
from asterism.exact.simulation import exact_shape
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law_file import load_law
from asterism.pattern import gallery
from asterism.pattern.design.errors import DesignError
from asterism.previews.run import preview
from asterism.results.files import write_file
from asterism.shape.shape import Shape

PICTURES = Path(__file__).parent.parent / "asterism" / "studio" / "gallery"
# size of a picture: twice the size at which the page shows it, for fine screens
GALLERY_PICTURE_WIDTH_PX = 440
GALLERY_PICTURE_HEIGHT_PX = 300
GALLERY_PICTURE_COLOURS = 255


def main(names: list[str]) -> None:
    law = load_law()
    for name in names or [*gallery.names(), *gallery.pattern_names()]:
        design = gallery.load(name)
        try:
            shape = preview(design, law)
        except (LawError, DesignError):
            shape = exact_shape(design)
        content = small_picture(shape)
        write_file(PICTURES / f"{name}.png", content)
        print(f"{name}: {len(content) / 1000:.1f} kB", flush=True)


def small_picture(shape: Shape) -> bytes:
    """PNG of a shape in perspective: a supported sheet as it stands, a free one along its principal axes."""
    shape = shape if shape.held else shape.aligned()
    low, high = shape.positions.min(axis=0), shape.positions.max(axis=0)
    view = camera(*OBLIQUE, (low + high) / 2, distance_mm=2.6 * float(np.linalg.norm(high - low)))
    thing = scene(shape)
    size = np.maximum(np.ptp(view.project(thing.points)[:, :2], axis=0), 1e-3)
    room = np.array([GALLERY_PICTURE_WIDTH_PX, GALLERY_PICTURE_HEIGHT_PX])
    return _png(_centred(render(thing, view, float(((room - 8) / size).min()))))


def _centred(image: Floats) -> Floats:
    """(height, width, 4) with the image in its middle; row 0 the highest."""
    out = np.zeros((GALLERY_PICTURE_HEIGHT_PX, GALLERY_PICTURE_WIDTH_PX, 4))
    height, width = image.shape[:2]
    row, column = (GALLERY_PICTURE_HEIGHT_PX - height) // 2, (GALLERY_PICTURE_WIDTH_PX - width) // 2
    out[row : row + height, column : column + width] = image
    return out[::-1]


def _png(image: Floats) -> bytes:
    picture = Image.fromarray(np.rint(255 * np.clip(image, 0, 1)).astype(np.uint8), "RGBA")
    out = BytesIO()
    # the octree is the only one of these choices that keeps opacity
    picture.quantize(GALLERY_PICTURE_COLOURS, Image.Quantize.FASTOCTREE, kmeans=1).save(out, "PNG", optimize=True)
    return out.getvalue()


if __name__ == "__main__":
    main(sys.argv[1:])
