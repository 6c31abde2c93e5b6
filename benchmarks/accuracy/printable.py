"""Designs at random that can be printed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout


def printable(draw: Callable[[], dict[str, Any]], stars: tuple[int, int]) -> Design:
    """The first design that can be printed and has a number of stars from `stars[0]` to `stars[1]`.

    Parameters
    ----------
    draw : draws the table of another design at each call.
    """
    while True:
        data = draw()
        try:
            design = Design.from_dict(data)
            if stars[0] <= len(layout(design).centres) <= stars[1]:
                return design
        except DesignError:
            continue
