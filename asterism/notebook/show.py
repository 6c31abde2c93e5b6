"""`asterism.show`: a shape or a preview in a notebook."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from asterism.equilibrium.errors import Error
from asterism.notebook.live_sheet import LiveSheet, shape_traits
from asterism.pattern.design.section import is_whole
from asterism.previews.session import Preview
from asterism.shape.shape import Shape

if TYPE_CHECKING:
    from asterism.notebook.widget import SheetWidget

HEIGHT_RANGE_PX = (120, 4000)


class NotebookError(Error):
    """The notebook lacks what a widget needs."""


def show(shown: Shape | Preview, sliders: Sequence[str] | None = None, height_px: int = 420) -> SheetWidget:
    """Show a sheet in a notebook: drag to turn it, click into it and use the wheel to zoom.

    A preview gets sliders. They change the preview in place, by `Preview.edit`: `preview.design` is the design that the
    page shows. While a slider moves, the newest value is computed, and values that it has passed are left out.

    Parameters
    ----------
    shown : a shape of either model, or a `Preview`.
    sliders : for a preview, some of the following; by default all that its design has. `length`, `thickness` and
        `width` multiply these sizes of all stars, within the range of the law. `stretch` chooses among the stretches of
        the law. `needle_scale` multiplies the distances of all pins from the origin, `needle_height` their heights.
    height_px : height of the picture, from 120 to 4000 pixels.

    Returns
    -------
    The widget. A notebook shows it if it is the last value of a cell.

    Raises
    ------
    NotebookError
        The package anywidget is missing; the extra `notebook` installs it.
    TypeError
        `shown` is neither a shape nor a preview.
    ValueError
        A slider or the height is not one of those above, the design lacks what a slider changes, or sliders are given
        for a shape.

    Examples
    --------
    >>> from asterism.pattern import gallery
    >>> widget = show(Preview(gallery.load("dome")), sliders=["thickness", "needle_scale"])
    >>> [slider["label"] for slider in widget.panel["sliders"]]
    ['Thickness', 'Distances of the needles']
    """
    if not isinstance(shown, Shape | Preview):
        raise TypeError(
            f"a Shape or a Preview is needed, not {type(shown).__name__}: preview, simulate and Preview make them"
        )
    if not (is_whole(height_px) and HEIGHT_RANGE_PX[0] <= height_px <= HEIGHT_RANGE_PX[1]):
        raise ValueError(
            f"height_px = {height_px!r}: must be a whole number from {HEIGHT_RANGE_PX[0]} to {HEIGHT_RANGE_PX[1]}"
        )
    if isinstance(sliders, str):
        raise ValueError(f"sliders = {sliders!r}: must be a list of names")
    if isinstance(shown, Shape) and sliders:
        raise ValueError("sliders belong to a Preview: a Shape does not change")
    try:
        from asterism.notebook.widget import SheetWidget
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] == "asterism":
            raise
        raise NotebookError(
            f"asterism.show needs the package {error.name}, which the extra notebook installs: pip install anywidget"
        ) from None
    if isinstance(shown, Shape):
        return SheetWidget(shape_traits(shown), height_px)
    live = LiveSheet(shown, sliders)
    return SheetWidget(live.opening(), height_px, live)
