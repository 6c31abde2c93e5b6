"""The axis about which the exact model's sheet is rolled."""

from __future__ import annotations

import numpy as np

from discrete.model import Model
from discrete.state import State
from pattern.likeness import rolled_about


def roll_axis_deg(model: Model, state: State) -> float | None:
    """Axis of a rolled sheet in print coordinates, 0 to 180 deg from the x axis; None for other shapes."""
    normal = np.zeros((len(model.layout.centres), 3))
    np.add.at(normal, model.layout.arm_star[model.network.rod], state.directors)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    return rolled_about(model.layout, normal)
