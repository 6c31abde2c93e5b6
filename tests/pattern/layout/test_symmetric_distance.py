"""Distances of two shapes of one design, free and as held."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.free_motions import free_motions
from asterism.pattern.layout.symmetries import symmetric_distances, symmetries

SCALE = 0.7


def _on_needles() -> Design:
    stars = {"length_mm": 8.0, "thickness_mm": 0.4}
    return Design.from_dict({"stars": stars, "border": {"rings": 2}, "pins": [{"where": "corners", "scale": SCALE}]})


def _tilted_bowl(points: np.ndarray) -> np.ndarray:
    """(n, 3) mm."""
    x, y = SCALE * points.T
    return np.column_stack([x, y, 0.01 * (x**2 + y**2) + 0.1 * x])


def test_a_swing_on_needles_counts_and_that_of_a_free_sheet_does_not() -> None:
    design = _on_needles()
    plan = layout(design)
    supports, identity = plan.support_samples, symmetries(design, plan)[:1]
    first = _tilted_bowl(plan.centres)
    swung = first @ Rotation.from_rotvec([0.0, 0.2, 0.0]).as_matrix().T
    held = free_motions(supports, _tilted_bowl(supports.printed))
    assert held.count == 0
    gap = np.sqrt(((first - swung) ** 2).sum(axis=1).mean())
    assert symmetric_distances(first, swung, identity, held)[0] == pytest.approx(gap)
    assert gap > 1.0
    assert symmetric_distances(first, swung, identity)[0] == pytest.approx(0.0, abs=1e-9)


def test_symmetric_images_on_the_same_needles_are_one_shape() -> None:
    design = _on_needles()
    plan = layout(design)
    supports, same = plan.support_samples, symmetries(design, plan)
    held = free_motions(supports, _tilted_bowl(supports.printed))
    first = _tilted_bowl(plan.centres)
    assert len(same) == 6
    for symmetry in same:
        image = symmetry.in_space(_tilted_bowl(plan.centres @ symmetry.turn.T + symmetry.shift))
        apart = symmetric_distances(first, image, same, held)
        assert apart.min() == pytest.approx(0.0, abs=1e-9)
        assert apart.max() > 0.5
