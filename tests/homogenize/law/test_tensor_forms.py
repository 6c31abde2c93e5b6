"""Stored forms of tensors: the way back, and turns of the axes."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.motif_law import MotifTable, tensor_errors
from asterism.homogenize.law.plan import LawPlan, Size
from asterism.homogenize.law.tensor_forms import SheetTensors, stored_tensors, tensors_of_stored
from tests.homogenize.law.test_anisotropy import turned as turned_voigt
from tests.homogenize.motifs import motif_design, parallel


def random_tensors(count: int, seed: int = 3) -> SheetTensors:
    rng = np.random.default_rng(seed)

    def positive(k: int) -> Floats:
        root = rng.normal(size=(count, k, k))
        return np.asarray(root @ np.swapaxes(root, 1, 2) + 0.1 * np.eye(k))

    metric, stiffness = positive(2), np.zeros((count, 6, 6))
    stiffness[:, :3, :3], stiffness[:, 3:, 3:] = 100.0 * positive(3), 5.0 * positive(3)
    return SheetTensors(
        np.stack([metric[:, 0, 0], metric[:, 1, 1], metric[:, 0, 1]], axis=-1),
        stiffness,
        0.02 * rng.normal(size=(count, 3)),
    )


def turned(tensors: SheetTensors, angle: float) -> SheetTensors:
    """The tensors of the same sheet after a turn by an angle (rad)."""
    c, s = np.cos(angle), np.sin(angle)
    plain = np.array([[c * c, s * s, -2 * c * s], [s * s, c * c, 2 * c * s], [c * s, -c * s, c * c - s * s]])
    both = np.kron(np.eye(2), turned_voigt(angle))
    return SheetTensors(tensors.metric @ plain.T, both.T @ tensors.stiffness @ both, tensors.curvature @ plain.T)


def difference(one: SheetTensors, other: SheetTensors) -> float:
    pairs = ((one.metric, other.metric), (one.stiffness, other.stiffness), (one.curvature, other.curvature))
    return max(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in pairs)


def test_there_and_back() -> None:
    tensors = random_tensors(20)
    assert difference(tensors_of_stored(stored_tensors(tensors)), tensors) < 1e-11


def test_the_table_of_a_turned_motif_is_the_turned_table() -> None:
    nodes = Size("thickness_mm", (0.3, 0.35, 0.45, 0.6), (0,)), Size("width_mm", (0.8, 1.2, 1.6), (0,))
    plan = LawPlan(motif_design(parallel()), nodes, (1.35,), 2.0)
    cells, angle = random_tensors(12), 0.7
    sizes = np.column_stack([np.linspace(0.31, 0.59, 9), np.linspace(1.5, 0.9, 9)])
    solved = np.ones((4, 3), dtype=bool)

    def at(tensors: SheetTensors) -> SheetTensors:
        return MotifTable(plan, 1.35, stored_tensors(tensors).reshape(4, 3, -1), solved)(sizes)

    plain, other = at(cells), at(turned(cells, angle))
    assert difference(other, turned(plain, angle)) < 1e-10
    # and the errors do not depend on the axes
    elsewhere = random_tensors(9, seed=8)
    np.testing.assert_allclose(
        tensor_errors(turned(plain, angle), turned(elsewhere, angle)), tensor_errors(plain, elsewhere), rtol=1e-8
    )
