"""Sheets that pass through themselves: rolls of one curvature, closed and less than closed."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats, Ints
from asterism.shape.self_intersections import meets_itself, self_intersections


def strip(turns: float, lean: float) -> tuple[Floats, Floats, Ints]:
    """A print of 60 x 20 mm rolled by so many turns about an axis that leans from its short sides."""
    x, y = np.meshgrid(np.arange(0.0, 61.0), np.arange(0.0, 21.0), indexing="ij")
    number = np.arange(x.size).reshape(x.shape)
    a, b, c, d = number[:-1, :-1].ravel(), number[1:, :-1].ravel(), number[1:, 1:].ravel(), number[:-1, 1:].ravel()
    printed = np.column_stack([x.ravel(), y.ravel()])
    across, along = np.cos(lean) * printed[:, 0] + np.sin(lean) * printed[:, 1], printed @ [-np.sin(lean), np.cos(lean)]
    radius = 60.0 / (2 * np.pi * turns)
    # the second turn lies inside the first one up to half a turn, and outside from there
    angle = across / radius
    rolled = radius * (1.0 + 0.1 * np.cos(0.5 * angle))
    positions = np.column_stack([rolled * np.sin(angle), along, rolled * np.cos(angle)])
    return printed, positions, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


@pytest.mark.parametrize("lean", [0.0, 0.3])
@pytest.mark.parametrize(("turns", "meets"), [(0.5, False), (0.9, False), (1.7, True), (2.2, True)])
def test_rolls_meet_themselves_past_one_and_a_half_turns(turns: float, lean: float, meets: bool) -> None:
    printed, positions, triangles = strip(turns, lean)
    assert meets_itself(printed, positions, triangles) == meets
    assert (self_intersections(positions, triangles) > 0) == meets


def test_flat_sheets_do_not_meet_themselves() -> None:
    printed, _, triangles = strip(1.0, 0.0)
    flat = np.column_stack([printed, np.zeros(len(printed))])
    assert not meets_itself(printed, flat, triangles) and self_intersections(flat, triangles) == 0
