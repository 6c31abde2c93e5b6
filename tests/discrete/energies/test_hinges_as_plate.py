"""On equilateral triangles the paper's hinges bend like the energy `plate`: three plates, Poisson's ratio -1/3."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.discrete.energies.bending.fabric_bending import FABRIC_BENDING, BendingMesh
from asterism.pattern.design.materials import Fabric

EDGE, ROWS = 1.0, 8
FABRIC = Fabric(thickness_mm=0.8, modulus_mpa=7.0, poisson=0.3)
STIFFNESS = 7.0 * 0.8**3 / (12.0 * (1.0 - 0.3**2))
# small enough that fourth powers of the angles do not count
CURVATURE = 1e-5


def grid() -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) and triangles (m, 3) of an equilateral grid on a parallelogram."""
    number = np.arange(ROWS * ROWS).reshape(ROWS, ROWS)
    i, j = np.indices((ROWS, ROWS))
    points = EDGE * np.stack([i + 0.5 * j, 0.5 * np.sqrt(3.0) * j], axis=-1).reshape(-1, 2)
    a, b = number[:-1, :-1].ravel(), number[1:, :-1].ravel()
    c, d = number[:-1, 1:].ravel(), number[1:, 1:].ravel()
    return points, np.concatenate([np.column_stack([a, b, c]), np.column_stack([b, d, c])])


def densities(curvatures: tuple[float, float], turn: float) -> tuple[float, float]:
    """Energies of hinges and plate for each mm^2 of a surface with these principal curvatures."""
    points, triangles = grid()
    cos, sin = np.cos(turn), np.sin(turn)
    along, across = points @ [cos, sin], points @ [-sin, cos]
    height = 0.5 * (curvatures[0] * along**2 + curvatures[1] * across**2)
    mesh = BendingMesh(triangles, points)
    positions = np.column_stack([points, height]).ravel()
    hinges, plate = (
        FABRIC_BENDING[name].build(mesh, FABRIC.model_copy(update={"bending": name}).bending_tensor)[part]
        for name, part in (("paper", "hinges"), ("plate", "plate"))
    )
    energy = hinges.energies(positions)
    edges = np.subtract(*points[mesh.hinges[:, :2]].transpose(1, 0, 2))
    direction = np.round(np.arctan2(edges[:, 1], edges[:, 0]) % np.pi * 3.0 / np.pi).astype(int) % 3
    # a vertex has one hinge of each direction
    one_each = sum(float(energy[direction == k].mean()) for k in range(3))
    return one_each / (0.5 * np.sqrt(3.0) * EDGE**2), plate.energies(positions).mean() / (0.25 * np.sqrt(3.0) * EDGE**2)


@pytest.mark.parametrize("turn", [0.0, 0.2, np.pi / 6])
@pytest.mark.parametrize(
    ("curvatures", "plates"),
    # of one plate: D k^2/2 for a cylinder, D (1 + nu) k^2 for a sphere, D (1 - nu) k^2 for a saddle
    [((1.0, 0.0), 0.5), ((1.0, 1.0), 1.0 - 1.0 / 3.0), ((1.0, -1.0), 1.0 + 1.0 / 3.0)],
)
def test_stiffness(curvatures: tuple[float, float], plates: float, turn: float) -> None:
    hinges, plate = densities((CURVATURE * curvatures[0], CURVATURE * curvatures[1]), turn)
    assert hinges == pytest.approx(3.0 * STIFFNESS * plates * CURVATURE**2, rel=1e-4)
    assert plate == pytest.approx(hinges, rel=1e-4)
