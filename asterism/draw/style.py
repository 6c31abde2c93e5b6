"""Colours of text and lines in pictures, charts and drawings, and the common style of charts' axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# titles, numbers and lines
INK = "#26262b"
# labels and notes
PALE = "#7a7a82"
# curves and points; what stands out among them
BLUE = "#2a6f97"
RED = "#c8553d"


def style_axes(axes: Axes, title: str, below: str, size: int = 10, side: Literal["left", "right"] = "left") -> None:
    """Set title, label and colours, and hide the lines above and to the right."""
    axes.set_title(title, fontsize=size, color=INK, loc=side)
    axes.set_xlabel(below, fontsize=size - 1, color=PALE)
    axes.tick_params(labelsize=8, colors=PALE)
    for edge in ("top", "right"):
        axes.spines[edge].set_visible(False)


def add_grid(axes: Axes) -> None:
    """Draw pale grid lines behind the curves."""
    axes.grid(color="#e8e8ec", linewidth=0.6)
    axes.set_axisbelow(True)
