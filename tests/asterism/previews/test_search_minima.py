"""Sheets that curl tightly at their border are started from caps too."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.mean_fields import mean_fields, side_of
from asterism.fem.search.relax import follow, relax
from asterism.fem.shell.fields import Fields, of_stretch
from asterism.fem.shell.shell import Shell
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.previews import search_minima as search
from asterism.previews.search_minima import find_equilibrium, is_equilibrium_near_another, is_inverted, is_narrow
from asterism.previews.session import Preview
from tests.asterism.previews.designs import edited
from tests.fem.hexagons import FIELDS, RADIUS, density, hexagon, radius

FOLDS = of_stretch(density(100.0), 0.8, lambda p: -0.06 * radius(p) ** 2)
ROLLS = of_stretch(density(100.0), 0.8, lambda p: -0.012 - 0.001 * radius(p) ** 2)


@pytest.mark.parametrize("fields", [pytest.param(FOLDS, marks=pytest.mark.slow), ROLLS])
def test_caps_never_cost_energy(fields: Fields) -> None:
    shell = Shell(Argyris(hexagon(1)), fields)
    factor = shell.factor()
    plain = find_equilibrium(shell, factor, "auto")
    found = find_equilibrium(shell, factor, "auto", has_tight_curls=True)
    assert found.is_minimum
    assert found.energy <= plain.energy * (1.0 + 1e-9)
    assert "cap" in {trial.name for trial in found.trials}
    assert found.energy == pytest.approx(shell.energy(found.x))
    # the factor is left with the Hessian of what was found, its rigid motions held
    data = shell.hessian(found.x)
    low = shell.pattern.lower(data).toarray()
    push = (low + np.tril(low, -1).T) @ np.random.default_rng(0).normal(size=len(low))
    moved = factor.solve(push)
    assert np.allclose((low + np.tril(low, -1).T) @ moved, push, atol=1e-6 * np.abs(push).max())
    factor.close()


# its border is so narrow that it stays on either side
NARROW_DOME = edited("dome", pins=[{"where": "border", "scale": 0.7}])


@pytest.mark.slow
def test_a_form_on_the_side_that_is_asked_for_is_shown_though_it_is_dearer() -> None:
    """A held dome would rather go up from its border; both are minima."""
    preview = Preview(NARROW_DOME)
    down = preview.equilibrium
    factor = preview.shell.factor()
    up = find_equilibrium(preview.shell, factor, "up")
    assert (side_of(preview.shell, down.x), side_of(preview.shell, up.x)) == ("down", "up")
    assert up.is_minimum and up.energy > 1.2 * down.energy and len(up.soft_modes)
    factor.close()


def test_a_narrow_sheet_is_looked_at_for_other_buckles() -> None:
    """Both forms are stiff minima; a start as a round cap leads to the higher one."""

    def narrow(length_mm: float) -> Design:
        stars = {"length_mm": length_mm, "thickness_mm": 0.35}
        pins = [{"where": "border", "scale": 0.68}]
        return Design.from_dict({"stars": stars, "border": {"rings": 2}, "pins": pins})

    preview = Preview(narrow(6.97))
    shape = preview.shape()
    (other,) = shape.summary["other_forms"]
    assert shape.summary["is_minimum"] and other["energy_n_mm"] > 1.02 * shape.summary["energy_n_mm"]
    assert is_narrow(mean_fields(preview.shell))
    assert not is_equilibrium_near_another(preview.shell, preview.equilibrium, 60.0)
    *_, last = preview.edit(narrow(7.1))
    assert last.name == "equilibrium" and any("the edit kept" in line for line in preview.shape().summary["warnings"])
    assert not is_narrow(mean_fields(Preview(gallery.load("dome")).shell))


def test_a_narrow_sheet_with_soft_modes_is_looked_at_for_other_buckles_too() -> None:
    """An L on two held edges: neither side of its softest mode leads to the lowest form, a bent guess does."""
    corners = [[-60.0, -60.0], [60.0, -60.0], [60.0, -5.0], [-10.0, -5.0], [-10.0, 60.0], [-60.0, 60.0]]
    stars, pins = {"length_mm": 5.1, "thickness_mm": 0.3}, [{"edges": [k], "scale": 0.71} for k in (0, 3)]
    preview = Preview(Design.from_dict({"stars": stars, "border": {"polygon_mm": corners}, "pins": pins}))
    shell, shown = preview.shell, preview.equilibrium
    assert is_narrow(mean_fields(shell)) and "pushed" in {trial.name for trial in shown.trials}
    assert shown.is_minimum and shown.guess in ("arc", "bent", "cap")
    assert relax(shell).energy - shown.energy > 0.02 * shown.absolute_energy


@pytest.mark.slow
def test_sides_of_free_and_held_states() -> None:
    shell = Shell(Argyris(hexagon(1)), FIELDS["dome"])
    found = relax(shell)
    side = mean_fields(shell).side
    assert side_of(shell, found.x) == side and side_of(shell, shell.flat) == "auto"
    turned = found.x * [1.0, -1.0, -1.0]  # half a turn is no other side
    assert side_of(shell, turned) == side
    middle = Preview(edited("dome", pins=[{"points_mm": [[0.0, 0.0]]}]))
    assert middle.shape().extent_mm[2] > 20.0 and side_of(middle.shell, middle.equilibrium.x) == "down"


@pytest.mark.parametrize(("fields", "soft"), [(FOLDS, True), (FIELDS["dome"], False)])
def test_sheets_soft_in_two_ways_are_started_from_other_kinds(fields: Fields, soft: bool) -> None:
    shell = Shell(Argyris(hexagon(1)), fields)
    alone = relax(shell)
    assert is_equilibrium_near_another(shell, alone, 0.8 * 2.0 * RADIUS) == soft
    found = find_equilibrium(shell, shell.factor(), "auto")
    tried, before = ({trial.name for trial in each.trials} for each in (found, alone))
    assert tried > before if soft else tried == before
    assert found.is_minimum and found.energy < (0.98 if soft else 1.02) * alone.energy


@pytest.mark.slow
def test_a_held_sheet_that_is_soft_in_two_ways_is_pushed_to_a_lower_form() -> None:
    """The roof on three corners: its free ones hang down, where a cap alone leads to a dearer form."""
    preview = Preview(gallery.load("doubly-curved"))
    found = preview.equilibrium
    cap, *others = found.trials
    assert found.is_minimum and found.guess == "pushed" and cap.name == "cap"
    assert found.energy < 0.98 * cap.energy
    assert {trial.name for trial in others} == {"pushed", "cap"}  # it is narrow too, and bent guesses lie far higher
    corners = preview.at(0.999 * preview.sheet.layout.outline).smooth[:, 2]
    assert (corners[1::2] < corners[::2] - 10.0).all()


def test_what_gaussian_curvature_saves_is_a_part_of_the_energy() -> None:
    preview = Preview(gallery.load("dome"))
    found, shell = preview.equilibrium, preview.shell
    assert found.energies["gaussian"] < 0.0
    assert sum(found.energies.values()) == pytest.approx(shell.energy(found.x))
    assert found.absolute_energy == pytest.approx(found.energies["sheet"] - found.energies["gaussian"])


def test_a_tube_that_hardly_prefers_an_axis_settles_soon() -> None:
    """A soft motion with a negative stiffness on its way: without turning it round, 100 iterations and more."""
    found = Preview(edited("tube", stars={"thickness_mm": 0.405})).equilibrium
    assert found.is_minimum
    assert found.soft_modes[1] > 10.0 * found.soft_modes[0]
    assert found.fallbacks == 0
    assert found.iterations <= 60


@pytest.mark.slow
def test_a_held_sheet_on_the_wrong_side_is_tried_from_flat(monkeypatch: pytest.MonkeyPatch) -> None:
    """Guesses may turn over on the way; a dome that hangs below its border costs more."""
    preview = Preview(NARROW_DOME)
    shell, right = preview.shell, preview.equilibrium
    over = right.x * [1.0, 1.0, -1.0]
    assert is_inverted(shell, over, "down") and is_inverted(shell, right.x, "up")
    assert not is_inverted(shell, right.x, "down") and not is_inverted(shell, shell.constrain(shell.flat), "down")
    wrong = follow(shell, over, shell.factor(), "cap")
    assert wrong.is_minimum and wrong.energy > 1.1 * right.energy
    first = iter([wrong])
    real = search.relax
    monkeypatch.setattr(search, "relax", lambda *given, **more: next(first, None) or real(*given, **more))
    found = find_equilibrium(shell, shell.factor(), "auto")
    assert found.energy == pytest.approx(right.energy, rel=1e-6) and len(found.trials) >= 2
