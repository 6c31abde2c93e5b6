"""A fabric with a measured bending stiffness bends like the plate that has it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.discrete.energies.bending.fabric_bending import FABRIC_BENDING, BendingMesh
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.homogenize.errors import ForeignLaw
from asterism.homogenize.law.law_file import load_law
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.materials import Fabric
from tests.discrete.models import model_of

SHEET = {"stars": {"length_mm": 7.0}, "border": {"rings": 1}}
# of the default thickness and modulus
PLATE = 7.1875 * 0.8**3 / (12.0 * (1.0 - 0.3**2))


def model(**fabric: Any) -> DiscreteModel:
    data = SHEET | {"fabric": {"bending": "consistent", "modulus_mpa": 7.1875, **fabric}, "mesh": {"edge_mm": 4.0}}
    return model_of(data)


@pytest.mark.parametrize("bending", ["consistent", "plate"])
def test_its_energy_is_proportional_to_the_stiffness(bending: str) -> None:
    measured = (model(bending=bending, bending_stiffness_n_mm=each * PLATE) for each in (1.0, 3.0))
    models = model(), *measured
    x = models[0].mesh.points
    bent = np.column_stack([20.0 * np.sin(x[:, 0] / 20.0), x[:, 1], 20.0 * np.cos(x[:, 0] / 20.0)]).ravel()
    plate, same, thrice = (float(one.parts["plate"].energies(bent).sum()) for one in models)
    assert same == pytest.approx(plate, rel=1e-12)
    assert thrice == pytest.approx(3.0 * plate, rel=1e-12)
    membranes = [float(one.parts["membrane"].energies(bent).sum()) for one in models]
    assert membranes[2] == membranes[0]


@pytest.mark.parametrize(
    ("fabric", "field"),
    [
        ({"bending": "paper", "bending_stiffness_n_mm": 0.02}, "fabric.bending_stiffness_n_mm"),
        ({"bending": "consistent", "bending_stiffness_n_mm": 0.02}, "fabric.modulus_mpa"),
        ({"bending": "consistent", "modulus_mpa": 1, "bending_stiffness_n_mm": -1}, "fabric.bending_stiffness_n_mm"),
    ],
)
def test_what_it_needs_is_said(fabric: dict[str, Any], field: str) -> None:
    with pytest.raises(DesignError) as refused:
        Design.from_dict(SHEET | {"fabric": fabric})
    assert field in str(refused.value)


def test_the_law_of_another_stiffness_is_refused() -> None:
    stiff = {"bending": "consistent", "modulus_mpa": 7.1875, "bending_stiffness_n_mm": 3.0 * PLATE}
    with pytest.raises(ForeignLaw):
        load_law().check(Design.from_dict(SHEET | {"fabric": stiff}))


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
