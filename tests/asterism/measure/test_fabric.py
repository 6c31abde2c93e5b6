"""Stiffness from overhangs against the equation of a heavy strip; modulus of a weighed one against the exact model."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np
import pypdfium2
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar

from asterism.discrete.energies.membrane import Membrane
from asterism.measure.fabric import (
    LENGTH_AT_SLOPE,
    SLOPE_DEG,
    bending_stiffness,
    fabric_modulus_mpa,
    nominal_stress,
    read_overhangs,
    write_overhang_form,
)
from asterism.pattern.design.design import GRAVITY_M_S2
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.materials import Fabric
from asterism.results.csv_table import TableError
from asterism.results.files import OutputError
from tests.asterism.commands import Cli


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
    known = [bending_stiffness(table.tolist(), mass) for table in tables]
    inside = np.mean([low <= true <= high for _, low, high, _ in known])
    # 400 tables: standard deviation .011
    assert inside == pytest.approx(0.95, abs=0.033)


@pytest.fixture(scope="module")
def form(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of an empty form."""
    folder = tmp_path_factory.mktemp("form")
    write_overhang_form(folder)
    return folder


def filled(form: Path, folder: Path, overhangs: list[float]) -> Path:
    """The table of a form with these overhangs, row by row; the rest stays empty."""
    head, *rows = (form / "overhangs.csv").read_text().splitlines()
    texts = [f"{value:g}" for value in overhangs] + [""] * (len(rows) - len(overhangs))
    table = folder / "overhangs.csv"
    table.write_text("\n".join([head, *(row + text for row, text in zip(rows, texts, strict=True))]) + "\n")
    return table


def test_readings_of_one_strip_count_as_one(form: Path, tmp_path: Path) -> None:
    means = read_overhangs(filled(form, tmp_path, [50.0, 52.0, 54.0, 56.0, 60.0]))
    assert means == pytest.approx([float(np.prod([50.0, 52.0, 54.0, 56.0])) ** 0.25, 60.0])


def test_the_form_holds_the_slope_and_the_last_step_and_stays_once_it_was_filled_in(form: Path, tmp_path: Path) -> None:
    text = pypdfium2.PdfDocument(form / "overhangs.pdf")[0].get_textpage().get_text_bounded()
    assert "41.5 degrees at 1:1" in text and "asterism strips overhang overhangs.csv" in text
    table = filled(form, tmp_path, [50.0])
    before = table.read_bytes()
    with pytest.raises(OutputError, match="may have been filled in"):
        write_overhang_form(tmp_path)
    assert table.read_bytes() == before


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("strip,overhang_mm\n1,\n", "no overhang has been measured"),
        ("strip,overhang_mm\n1,5\n", "row 2, column overhang_mm: 5 must be from 10 to 500 mm"),
        ("strip,end,face,overhang_mm\n1,1,face,50\n1,1,face,51\n", "already in row 2"),
        ("strip\n1\n", "overhang_mm is missing"),
    ],
)
def test_wrong_tables_are_named(text: str, said: str, tmp_path: Path) -> None:
    table = tmp_path / "overhangs.csv"
    table.write_text(text)
    with pytest.raises(TableError, match=said):
        read_overhangs(table)


@pytest.mark.slow
def test_the_command_writes_the_form_and_reads_it(form: Path, tmp_path: Path, cli: Cli) -> None:
    assert "overhangs.csv, overhangs.pdf" in cli(["strips", "overhang", "--form", str(tmp_path / "hung")]).done.out
    table = filled(form, tmp_path, [52.0] * 4 + [50.0] * 4 + [55.0] * 4 + [51.0] * 4)
    for measured in ([str(table)], ["52", "50", "55", "51"]):
        printed = cli(["strips", "overhang", *measured, "--mass", "250"]).done.out
        assert "0.043 N mm (0.0354 to 0.0523 at 95 %)" in printed and "bending_stiffness_n_mm = 0.043" in printed


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
    assert f"{fabric_modulus_mpa(100.0, 40.0, 0.8, 1.2):.4g} MPa" in cli([*words, "--after", "120"]).done.out
    for after in ("100", "nan", "-5"):
        assert cli([*words, "--after", after]).refusal
