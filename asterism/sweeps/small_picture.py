"""A small picture of a shape for pages with many of them."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass
from io import BytesIO

import numpy as np
from PIL import Image

from asterism.draw.render import OBLIQUE, VIEWER_DISTANCE, camera, render, scene
from asterism.shape.shape import Shape

# largest size of a picture
SMALL_WIDTH_PX = 320
SMALL_HEIGHT_PX = 240
WEBP_QUALITY = 85


@dataclass(frozen=True)
class SmallPicture:
    """A picture as WEBP with a transparent background.

    Attributes
    ----------
    webp : text in base 64.
    width_px, height_px : size.
    px_per_mm : scale in the plane through the middle of the sheet.
    """

    webp: str
    width_px: int
    height_px: int
    px_per_mm: float


def small_picture(shape: Shape) -> SmallPicture:
    """The perspective view of a shape, as large as the limits allow."""
    shape = shape if shape.held else shape.aligned()
    thing = scene(shape)
    low, high = shape.positions.min(axis=0), shape.positions.max(axis=0)
    view = camera(*OBLIQUE, (low + high) / 2, VIEWER_DISTANCE * float(np.linalg.norm(high - low)))
    size = np.maximum(np.ptp(view.project(thing.points)[:, :2], axis=0), 1e-3)
    scale = float((np.array([SMALL_WIDTH_PX, SMALL_HEIGHT_PX]) / size).min())
    pixels = np.clip(np.flipud(render(thing, view, scale)), 0.0, 1.0)
    image = Image.fromarray(np.rint(255.0 * pixels).astype(np.uint8))
    out = BytesIO()
    image.save(out, "WEBP", quality=WEBP_QUALITY)
    return SmallPicture(b64encode(out.getvalue()).decode(), image.width, image.height, scale)
