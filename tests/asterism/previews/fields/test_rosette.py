"""The rest metric where stars change: known rosettes, and what symmetry demands."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.design.lattice import Lattice
from asterism.previews.fields.sheet_fields import arm_metric

THREE = Lattice().arm_directions


def tensor(components):
    a, b, c = components
    return np.array([[a, c], [c, b]])


@pytest.mark.parametrize("arms", range(3, 9))
@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_a_known_metric_is_found_from_its_stretches_along_the_arms(arms, turn):
    """Of any number of arms; four, along two lines, miss the shear between them."""
    angles = turn + 2.0 * np.pi * np.arange(arms) / arms
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    known = np.array([[0.70, 0.03], [0.03, 0.62]])
    if arms == 4:
        known = directions[:2].T @ np.diag([0.70, 0.62]) @ directions[:2]
    along = np.sqrt(np.einsum("ni,ij,nj->n", directions, known, directions))
    lam = float(np.exp(np.log(along).mean()))
    assert tensor(arm_metric(np.array(lam), along, directions)) == pytest.approx(known)


@pytest.mark.parametrize("arms", [4, 5, 6])
def test_a_gradient_leaves_other_stars_isotropic(arms):
    """To first order: only three arms have a tensor of third order."""
    directions = Lattice(arms=arms).arm_directions
    gradient = 1e-4 * np.array([0.3, -0.8])
    metric = arm_metric(np.array(0.8), 0.8 - directions @ gradient, directions)
    assert metric == pytest.approx([0.64, 0.64, 0.0], abs=1e-7)
    three = arm_metric(np.array(0.8), 0.8 - THREE @ gradient, THREE)
    assert np.abs(three - [0.64, 0.64, 0.0]).max() > 2e-5
