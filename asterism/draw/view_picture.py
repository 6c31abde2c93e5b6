"""A picture of one view of a sheet, at a size and a scale that can be chosen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from PIL import Image

from asterism.draw.canvas import Canvas
from asterism.draw.drawable import Drawable
from asterism.draw.picture import (
    CAPTION_HEIGHT_PX,
    PICTURE_MARGIN_PX,
    caption,
    drawn_size,
    write_captions,
)
from asterism.draw.render import OBLIQUE, VIEWER_DISTANCE, VIEWS, Camera, camera, render, scene
from asterism.equilibrium.arrays import Floats

View = Literal["oblique", "above", "front", "side"]
# smallest and largest number of pixels of each side
SIDE_RANGE_PX = (100, 8000)
# room below a drawing for its scale bar
_BAR_HEIGHT_PX = 100


def view_image(
    shape: Drawable,
    view: View = "oblique",
    size_px: tuple[int, int] = (1600, 1000),
    pixels_per_mm: float | None = None,
    plain: bool = False,
    title: str = "",
) -> Image.Image:
    """Draw one view of a shape, in the middle of a white picture.

    Parameters
    ----------
    view : in perspective (`oblique`), or a drawing to scale `above`, from the `front` or from the `side`.
    size_px : width and height of the picture.
    pixels_per_mm : scale, in perspective that at the middle of the sheet; by default the largest at which the sheet
        fits. At a larger one the sheet is cut off.
    plain : without title, numbers and scale bar.
    title : first line of a picture that is not plain.

    Raises
    ------
    ValueError
        A size, the scale or the name of the view is not allowed.
    """
    check_picture(view, size_px, pixels_per_mm)
    shape = shape if shape.held else shape.aligned()
    canvas = Canvas(*size_px)
    scale = fitting_scale([shape], view, size_px, plain) if pixels_per_mm is None else pixels_per_mm
    thing, looking = scene(shape), _camera(shape, view)
    (left, low), (right, high) = _room(view, size_px, plain)
    canvas.paste(render(thing, looking, scale), (left + right) / 2, (low + high) / 2)
    if not plain:
        if view != "oblique":
            canvas.bar(size_px[0] / 2, PICTURE_MARGIN_PX / 2, scale, float(drawn_size(thing, looking)[0]))
        write_captions(canvas, title, caption(shape), PICTURE_MARGIN_PX)
    return canvas.image


def fitting_scale(
    shapes: Sequence[Drawable], view: View, size_px: tuple[int, int] = (1600, 1000), plain: bool = False
) -> float:
    """The largest scale, in pixels per mm, at which each of several shapes fits a picture of `view_image`."""
    room = np.subtract(*_room(view, size_px, plain)[::-1])
    scales = []
    for shape in shapes:
        placed = shape if shape.held else shape.aligned()
        scales.append(float((room / drawn_size(scene(placed), _camera(placed, view))).min()))
    return min(scales)


def check_picture(view: str, size_px: tuple[int, int], pixels_per_mm: float | None) -> None:
    """Raise ValueError, with the allowed values, if these do not describe a picture."""
    if view not in ("oblique", *VIEWS):
        raise ValueError(f"view must be oblique, {', '.join(VIEWS)}, not {view!r}")
    low, high = SIDE_RANGE_PX
    if len(size_px) != 2 or not all(low <= side <= high and side == round(side) for side in size_px):
        raise ValueError(f"size must be two whole numbers of pixels from {low} to {high}, not {size_px}")
    if pixels_per_mm is not None and not 0.01 <= pixels_per_mm <= 1000.0:
        raise ValueError(f"scale must be from 0.01 to 1000 pixels per mm, not {pixels_per_mm:g}")


def _camera(shape: Drawable, view: View) -> Camera:
    low, high = shape.positions.min(axis=0), shape.positions.max(axis=0)
    if view == "oblique":
        distance = VIEWER_DISTANCE * float(np.linalg.norm(high - low))
        return camera(*OBLIQUE, (low + high) / 2, distance)
    return camera(*VIEWS[view], (low + high) / 2)


def _room(view: View, size_px: tuple[int, int], plain: bool) -> tuple[Floats, Floats]:
    """Lower left and upper right corner of the room for the drawing, in pixels."""
    width, height = size_px
    margin = min(PICTURE_MARGIN_PX, 0.05 * min(size_px))
    top = 0.0 if plain else CAPTION_HEIGHT_PX
    bottom = 0.0 if plain or view == "oblique" else _BAR_HEIGHT_PX
    low, high = np.array([margin, margin + bottom]), np.array([width - margin, height - margin - top])
    return low, np.maximum(high, low + 1.0)
