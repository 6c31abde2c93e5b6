"""What a preview states of its shape: its error by the kind of sheet, overstretched stars, and places of warnings."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import asterism
from asterism.equilibrium.arrays import Floats
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric
from asterism.pattern.layout.build import layout
from asterism.previews.session import Preview
from asterism.previews.shown_shape import (
    expected_error,
    mean_square_limit,
    mean_square_stretch,
    overstretched_stars,
    support_ratio,
)
from asterism.results.words import PlacedWarning
from asterism.shape.shape import Shape
from tests.asterism.previews.designs import edited
from tests.asterism.previews.laws import plain_law
from tests.asterism.verification.printed import shape as placed

FEW = {"stars": {"length_mm": 8.0, "thickness_mm": 0.3}, "border": {"rings": 1}}
CORNERS = {"where": "corners", "scale": 0.8}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sections", "expected"),
    [
        ({}, (4.0, 3.3)),
        ({"pins": [{"where": "corners", "slide": "plane"}]}, (4.0, 3.3)),  # as free as one without supports
        ({"pins": [CORNERS]}, (5.0, 3.0)),
        ({"pins": [CORNERS], "border": {"rings": 3}}, (1.3, 2.1)),
        ({"pins": [CORNERS], "gravity": {"on": True}, "fabric": {"modulus_mpa": 7.1875}}, (5.0, 6.0)),
        ({"stars": FEW["stars"] | {"thickness_mm": 0.9}}, None),
    ],
)
def test_the_kind_of_a_sheet_gives_its_error(sections: dict[str, Any], expected: tuple[float, float] | None) -> None:
    preview = Preview(Design.from_dict(FEW | sections), plain_law())
    assert expected_error(preview.state) == expected
    shape = preview.shape()
    if expected is None:
        assert shape.summary["expected_rms_percent"] is None and shape.summary["expected_height_percent"] is None
    else:
        assert shape.summary["expected_rms_percent"] == expected[0]
        height = 0.01 * shape.summary["expected_height_percent"] * shape.height_mm
        assert height == pytest.approx(0.01 * expected[1] * shape.summary["diameter_mm"])


def printed(design: Design, scale: float = 1.0, spike_mm: float = 0.0) -> Shape:
    """The print, scaled, with a spike at the outermost star."""
    plan = layout(design)
    outermost = plan.centres[np.argmax(plan.centres[:, 0])]

    def place(points: Floats) -> Floats:
        from_tip = np.linalg.norm(points - outermost, axis=1)
        return np.column_stack([scale * points, spike_mm * np.maximum(1.0 - from_tip / 5.0, 0.0)])

    return replace(placed(design, place, 4.0), held=bool(plan.pins), plan=plan)


def small(**sections: Any) -> Design:
    return Design.from_dict({"stars": {"length_mm": 8.0, "thickness_mm": 0.4}, "border": {"rings": 1}} | sections)


def test_a_spike_and_a_sheet_beyond_its_print_are_too_long() -> None:
    design, plan = small(), layout(small())
    assert mean_square_stretch(printed(design, 0.8), plan) == pytest.approx(0.64)
    assert overstretched_stars(printed(design, 0.99), design, plan).tolist() == []
    assert overstretched_stars(printed(design, 1.01), design, plan).tolist() == plan.star_number.tolist()
    (star,) = overstretched_stars(printed(design, 0.85, spike_mm=15.0), design, plan).tolist()
    assert star == plan.star_number[np.argmax(plan.centres[:, 0])]


def test_supports_that_pull_allow_as_much_and_weight_is_not_judged() -> None:
    wide = small(border={"rings": 2}, pins=[{"where": "corners", "scale": 1.2}])
    assert support_ratio(layout(wide)) == pytest.approx(1.2)
    assert support_ratio(layout(small())) == 0.0
    shape = printed(wide, 1.15)
    assert not len(overstretched_stars(shape, wide, layout(wide)))
    narrow = small(border={"rings": 2}, pins=[{"where": "corners", "scale": 0.9}])
    over = overstretched_stars(shape, narrow, layout(narrow))
    far = layout(narrow).distance_to_supports(layout(narrow).centres) > narrow.lattice.spacing_mm
    assert len(over) == far.sum() > 0
    heavy = Design.from_dict(narrow.to_dict() | {"gravity": {"on": True}})
    assert not len(overstretched_stars(shape, heavy, layout(heavy)))


@pytest.mark.parametrize(("stretch", "poisson"), [(1.35, 0.3), (2.2, 0.49)])
def test_no_state_of_the_fabric_beyond_the_limit_has_less_energy_than_the_print(stretch: float, poisson: float) -> None:
    """Over all principal stretches of two halves of a cell."""
    mu, lam = 1.0, 2.0 * poisson / (1.0 - poisson)

    def energy(one: Any, two: Any) -> Any:
        log = np.log(one * two)
        return 0.5 * mu * (one**2 + two**2 - 2.0) - mu * log + 0.5 * lam * log**2

    of_print, limit = energy(stretch, stretch), mean_square_limit(Fabric(stretch=stretch, poisson=poisson))
    one, two, three, four = np.meshgrid(*4 * [np.linspace(0.4, 6.0, 25)])
    square = 0.25 * (one**2 + two**2 + three**2 + four**2) / stretch**2
    stored = 0.5 * (energy(one, two) + energy(three, four))
    assert square[stored <= of_print].max() <= limit + 1e-12
    assert limit < 1.05 * square[stored <= of_print].max() + 0.05  # and hardly more than is needed


def test_a_preview_that_is_too_long_is_no_minimum(monkeypatch: pytest.MonkeyPatch) -> None:
    preview = Preview(gallery.load("star"))
    shape = preview.shape()
    assert shape.summary["is_minimum"] and shape.summary["stars_overstretched"] == []
    monkeypatch.setattr("asterism.previews.shown_shape.overstretched_stars", lambda *_: np.array([0]))
    long = preview.shape().summary
    assert not long["is_minimum"] and long["converged"] and long["stars_overstretched"] == [0]
    assert long["warnings"][-1].startswith("not a shape of this sheet: around 1 of 1 stars it is longer than")


def dome_with(override: list[dict[str, Any]]) -> Design:
    return edited("dome", mesh={"edge_mm": 4.0}, stars={"override": override})


def test_sites_off_the_sheet_are_named() -> None:
    summary = asterism.preview(
        dome_with([{"site": [0, 9], "remove": True}, {"site": [8, 1], "length_mm": 5.0}])
    ).summary
    (warning,) = [line for line in summary["warnings"] if "outside of the sheet" in line]
    assert warning == "2 entries of stars.override are for sites outside of the sheet, and ignored: [0, 9], [8, 1]"
    assert not any("outside of the sheet" in line for line in asterism.preview(dome_with([])).summary["warnings"])


@pytest.mark.slow
def test_arms_that_are_bonded_where_they_meet_are_named() -> None:
    meeting = asterism.Design.from_dict({"stars": {"length_fraction": 1.0}, "border": {"rings": 1}})
    (warning,) = [line for line in asterism.preview(meeting, plain_law()).summary["warnings"] if "print as one" in line]
    assert isinstance(warning, PlacedWarning) and set(warning.stars) == set(range(7))
    assert not any("print as one" in line for line in asterism.preview(dome_with([])).summary["warnings"])
