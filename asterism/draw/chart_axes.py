"""Common style of the axes of all charts."""

from __future__ import annotations

from typing import Literal

from matplotlib.axes import Axes

from asterism.draw.colours import INK, PALE


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
