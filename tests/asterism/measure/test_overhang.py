"""The stiffness from overhangs, against the equation of a heavy elastic strip."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from asterism.measure.overhang import LENGTH_AT_SLOPE, SLOPE_DEG, bending_stiffness
from asterism.pattern.design.design import GRAVITY_M_S2
from asterism.pattern.design.errors import DesignError
from tests.asterism.commands import command


def fall_deg(load: float) -> float:
    """Slope from the edge to the tip of a strip of length 1 with `w L^3/D = load`: `phi'' = -load (1 - s) cos(phi)`."""

    def end(moment: float) -> np.ndarray:
        def rates(s: float, y: np.ndarray) -> list[float]:
            return [y[1], -load * (1.0 - s) * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])]

        return np.asarray(solve_ivp(rates, (0.0, 1.0), [0.0, moment, 0.0, 0.0], rtol=1e-9, atol=1e-11).y[:, -1])

    moment = brentq(lambda moment: end(moment)[1], 0.0, load + 1.0)  # none at the tip
    _, _, along, down = end(moment)
    return float(np.degrees(np.arctan2(down, along)))


def test_a_heavy_strip_touches_the_slope_at_twice_its_bending_length() -> None:
    load = brentq(lambda load: fall_deg(load) - SLOPE_DEG, 4.0, 12.0)
    assert np.cbrt(load) == pytest.approx(LENGTH_AT_SLOPE, rel=5e-4)
    stiffness, mass = 0.05, 300.0
    overhang = np.cbrt(load * stiffness / (1e-9 * mass * GRAVITY_M_S2))
    assert bending_stiffness([overhang], mass).n_mm == pytest.approx(stiffness, rel=2e-3)


def test_intervals_hold_the_true_stiffness_as_often_as_they_say() -> None:
    rng = np.random.default_rng(0)
    mass, length = 200.0, 50.0
    true = bending_stiffness([length], mass).n_mm
    tables = length * np.exp(0.05 * rng.standard_normal((400, 8)))
    known = [bending_stiffness(table.tolist(), mass, 0.9) for table in tables]
    inside = np.mean([low <= true <= high for _, low, high, _ in known])
    # 400 tables: standard deviation .015
    assert inside == pytest.approx(0.9, abs=0.045)


@pytest.mark.parametrize(
    ("values", "said"),
    [(([], 200.0), "one overhang"), (([50.0, 5.0], 200.0), "reading 2"), (([50.0], float("nan")), "mass_g_m2")],
)
def test_values_out_of_range(values: tuple[list[float], float], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        bending_stiffness(*values)


def test_the_command_prints_what_the_design_needs(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    done = command(["strips", "overhang", "52", "50", "55", "51", "--mass", "250"], capsys, monkeypatch)
    assert done.status == 0
    assert "0.043 N mm (0.0354 to 0.0523 at 95 %)" in done.out and "bending_stiffness_n_mm = 0.043" in done.out
    refused = command(["strips", "overhang", "5", "--mass", "250"], capsys, monkeypatch)
    assert refused.status == 2 and "reading 1 = 5.0: must be from 10 to 500 mm" in refused.err
    refused = command(["strips", "overhang", "50", "--mass", "0"], capsys, monkeypatch)
    assert refused.status == 2 and "--mass = 0.0: must be from 10 to 5000 g for a square metre" in refused.err
