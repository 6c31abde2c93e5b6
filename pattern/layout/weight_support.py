"""Sheets under gravity need supports that stop them from falling."""

from __future__ import annotations

import numpy as np

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.layout import Layout


def check_weight_is_supported(design: Design, layout: Layout) -> None:
    """Refuse a sheet that falls: its first pins must support it along every axis along which gravity acts.

    Raises
    ------
    DesignError
        Gravity is on, and the sheet is free along x, y or z. The message names the axes.
    """
    if not design.gravity.on:
        return
    if not layout.pins:
        raise DesignError("gravity.on", "needs [[pins]] to support the sheet: a free sheet falls", True)
    first = min(pins.step for pins in layout.pins)
    held = np.array([pins.fixed for pins in layout.pins if pins.step == first]).any(axis=0)
    falls = ~held & (np.abs(design.gravity.direction) > 1e-6 * np.linalg.norm(design.gravity.direction))
    if falls.any():
        along = " and ".join(axis for axis, free in zip("xyz", falls, strict=True) if free)
        problem = f"needs [[pins]] that do not slide along {along}, among the first: the sheet falls"
        raise DesignError("gravity.on", problem, True)
