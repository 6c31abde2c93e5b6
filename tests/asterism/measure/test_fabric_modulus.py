"""The modulus of a weighed strip, against the membrane of the exact model."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from asterism.discrete.energies.membrane import Membrane
from asterism.measure.fabric import fabric_modulus_mpa, nominal_stress
from asterism.pattern.design.design import GRAVITY_M_S2
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.materials import Fabric
from tests.asterism.commands import Cli


def stress_of_the_model(stretch: float, fabric: Fabric) -> float:
    """Derivative by the stretch of the energy per volume of a unit square that is free across."""
    rest = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    square = Membrane(np.array([[0, 1, 2], [0, 2, 3]]), rest, fabric)

    def energy(along: float) -> float:
        def of(across: float) -> float:
            return float(square.energies(np.column_stack([rest * [along, across], np.zeros(4)]).ravel()).sum())

        return float(minimize_scalar(of, bounds=(0.3, 1.1), method="bounded", options={"xatol": 1e-10}).fun)

    step = 1e-4
    return (energy(stretch + step) - energy(stretch - step)) / (2.0 * step)


@pytest.mark.parametrize("model", ["neo-hookean", "incompressible"])
@pytest.mark.parametrize(("stretch", "poisson"), [(1.05, 0.3), (1.35, 0.3), (1.75, 0.0), (1.35, 0.45)])
def test_the_strip_has_the_energy_of_the_model(
    model: Literal["neo-hookean", "incompressible"], stretch: float, poisson: float
) -> None:
    expected = stress_of_the_model(stretch, Fabric(thickness_mm=1.0, modulus_mpa=1.0, poisson=poisson, model=model))
    assert nominal_stress(stretch, poisson, model) == pytest.approx(expected, rel=1e-5)
    mass = 0.25 * expected * 40.0 * 0.8 / (1e-3 * GRAVITY_M_S2)
    assert fabric_modulus_mpa(mass, 40.0, 0.8, stretch, poisson, model) == pytest.approx(0.25, rel=1e-5)


@pytest.mark.parametrize(
    ("values", "said"),
    [((0.0, 40.0, 0.8, 1.2), "mass_g"), ((9.0, 40.0, 0.8, 1.0), "stretch"), ((9.0, 40.0, 80.0, 1.2), "thickness")],
)
def test_values_out_of_range(values: tuple[float, float, float, float], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        fabric_modulus_mpa(*values)


def test_the_command(cli: Cli) -> None:
    words = ["strips", "weigh", "--mass", "100", "--width", "40", "--thickness", "0.8", "--before", "100"]
    done = cli([*words, "--after", "120"])
    assert done.status == 0 and f"{fabric_modulus_mpa(100.0, 40.0, 0.8, 1.2):.4g} MPa" in done.out
    for after in ("100", "nan", "-5"):
        assert cli([*words, "--after", after]).status == 2
