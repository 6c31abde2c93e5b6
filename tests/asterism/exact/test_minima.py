"""simulate with many starts: what the summary says, and the files of the other minima."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release import forms
from asterism.discrete.release.equilibrium import Equilibrium
from asterism.discrete.release.release_start import ReleaseStart
from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.reports.write_results import write_results
from asterism.shape.shape import Shape
from asterism.shape.vtu import read_shape

STARTS = 9


def small(**sections: object) -> Design:
    stars = {"length_mm": 10.0, "thickness_mm": 0.3}
    return Design.from_dict({"stars": stars, "border": {"rings": 1}, "mesh": {"edge_mm": 4.0}} | sections)


@pytest.fixture(scope="module")
def shape() -> Shape:
    return exact_shape(small(), starts=STARTS)


@pytest.mark.slow
def test_minima_of_the_summary(shape: Shape) -> None:
    s = shape.summary
    minima = s["minima"]
    assert s["starts"] == STARTS and s["result_is"] == "lowest energy"
    assert sum(m["starts"] for m in minima) + s["starts_lost"] == STARTS
    energies = [m["energy_n_mm"] for m in minima]
    assert energies == sorted(energies) and s["energy_n_mm"] == energies[0]
    assert len(minima) >= 2 and len(shape.others) == len(minima) - 1
    assert [other.summary["energy_n_mm"] for other in shape.others] == energies[1:]
    assert s["next_minimum_n_mm"] == pytest.approx(energies[1] - energies[0])
    assert sum(m["default"] for m in minima) == 1
    apart = np.array(s["minima_distance_percent"])
    np.testing.assert_allclose(apart, apart.T, atol=1e-9)
    np.testing.assert_allclose(apart[0], [m["distance_percent"] for m in minima])
    assert s["symmetries"] == 6
    assert all(m["is_minimum"] and m["stars_up"] <= 7 for m in minima)


def test_one_start_is_the_first_of_many(shape: Shape) -> None:
    s = exact_shape(small()).summary
    default = next(m for m in shape.summary["minima"] if m["default"])
    assert s["starts"] == 1 and s["minima_seen"] == 1 and s["next_minimum_percent"] is None
    assert s["energy_n_mm"] == pytest.approx(default["energy_n_mm"], rel=1e-9)
    assert [step["release"] for step in s["path"]] == sorted(step["release"] for step in s["path"])
    assert set(s["path"][0]) >= {"step", "release", "energy_n_mm", "iterations", "kicks"}
    assert s["instabilities_passed"] == sum(step["kicks"] for step in s["path"])


@pytest.mark.usefixtures("blank_pictures")
def test_every_minimum_has_its_files(shape: Shape, tmp_path) -> None:  # type: ignore[no-untyped-def]
    files = write_results(replace(shape, others=shape.others[:1]), tmp_path / "out")
    for m in shape.summary["minima"][:2]:
        assert {f"{m['file']}.vtu", f"{m['file']}.png"} <= set(files)
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["minima"]
    first, second = (read_shape(tmp_path / "out" / name) for name in ("shape.vtu", "minimum-2.vtu"))
    assert first.summary["energy_n_mm"] == shape.summary["energy_n_mm"]
    assert second.summary["energy_n_mm"] == shape.others[0].summary["energy_n_mm"]
    assert second.summary["design"] == shape.summary["design"] and "height_mm" not in second.summary
    again = write_results(replace(shape, others=()), tmp_path / "out")
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == again


@pytest.mark.slow
def test_stars_that_snap_back_are_named() -> None:
    """Stiff stars cannot stay down next to others."""
    override = [{"star": 2, "branch": "down"}]
    s = exact_shape(small(stars={"length_mm": 10.0, "thickness_mm": 0.8, "override": override})).summary
    assert s["stars_up"] == 7 and s["stars_off_branch"] == [2]
    kept = exact_shape(small(stars={"length_mm": 10.0, "thickness_mm": 0.3, "override": override})).summary
    assert kept["stars_down"] == [2] and kept["stars_off_branch"] == []
    down = {"length_mm": 10.0, "thickness_mm": 0.4, "branch": "down"}
    assert exact_shape(small(solver={"start": "flat"}, stars=down)).summary["stars_off_branch"] == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "sections",
    [
        {"fabric": {"bending": "consistent"}},
        {"solver": {"contact": True}},
        {
            "fabric": {"modulus_mpa": 0.5},
            "gravity": {"on": True},
            "pins": [{"where": "corners", "scale": 0.8, "step": 1}],
        },
    ],
    ids=["consistent", "contact", "weight and late pins"],
)
def test_many_starts_with_other_options(sections: dict[str, object]) -> None:
    if "solver" in sections:
        pytest.importorskip("ipctk")
    s = exact_shape(small(**sections), starts=4).summary
    assert s["is_minimum"] and all(m["is_minimum"] for m in s["minima"])
    assert sum(m["starts"] for m in s["minima"]) + s["starts_lost"] == 4 and s["starts_lost"] <= 1
    assert sum(m["default"] for m in s["minima"]) == 1
    assert s["minima"][0]["stars_off_branch"] == 0


@pytest.mark.slow
def test_where_the_pins_stand_makes_no_difference_to_the_starts_and_to_the_next_minimum() -> None:
    """Starts from bent sheets are taken along with their pins, and the work of weight counts from there."""
    weight = {"gravity": {"on": True}, "fabric": {"modulus_mpa": 1.0, "density_kg_m3": 2000.0}}
    held = {"corners": [0, 2, 4], "scale": 0.8}
    here, *others = (
        exact_shape(small(**weight, pins=[held | {"offset_mm": at}]), starts=8).summary
        for at in ([0.0, 0.0, 0.0], [300.0, 0.0, 0.0], [0.0, 0.0, -900.0])
    )
    for there in others:
        assert here["starts_lost"] == there["starts_lost"] == 0
        assert there["minima_seen"] == here["minima_seen"] > 1
        assert there["energy_n_mm"] == pytest.approx(here["energy_n_mm"], rel=1e-8)
        for name in ("next_minimum_percent", "next_minimum_n_mm"):
            assert there[name] == pytest.approx(here[name], rel=1e-4)


def test_a_start_that_cannot_go_on_is_lost_and_not_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    solve_on_mesh = forms.solve_on_mesh

    def failing(model: DiscreteModel, start: ReleaseStart, *rest: Any) -> Equilibrium:
        if start.bend != "none":
            raise DesignError("solver.contact", "the pins push the sheet through itself; it cannot follow them")
        return solve_on_mesh(model, start, *rest)

    monkeypatch.setattr(forms, "solve_on_mesh", failing)
    summary = exact_shape(small(), starts=3).summary
    assert summary["is_minimum"] and summary["starts_lost"] == 2
