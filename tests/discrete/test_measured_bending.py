"""A fabric with a measured bending stiffness bends like the plate that has it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.homogenize.errors import ForeignLaw
from asterism.homogenize.law.law_file import load_law
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
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
