"""Sensitivities of an exact shape against exact shapes of changed stars."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.exact.simulation import exact_shape
from asterism.exact.star_sensitivity import StarResponse
from asterism.pattern.design.design import Design
from asterism.pattern.design.stars import MIN_ARM_MM, THICKNESS_RANGE_MM
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.painted_stars import SIZE_KEYS, SizeName, with_painted_stars
from asterism.shape.shape import Shape

EDGE_MM = 3.0
HELD = {"corners": [0, 2, 4], "scale": 0.8}
# changes of the sizes for the differences, and how near the derivatives come to them: a length moves the mesh at the
# tips, another length has another mesh there
CHANGES: dict[SizeName, tuple[float, float]] = {
    "length_mm": (0.1, 0.08), "thickness_mm": (0.01, 0.005), "width_mm": (0.03, 0.005),
}  # fmt: skip


@pytest.mark.parametrize("pins", [[HELD], []], ids=["held", "free"])
def test_the_derivative_is_that_of_changed_stars(pins: list[dict[str, Any]]) -> None:
    """Rigid motions of a free sheet are left out."""
    stars = {"length_mm": 7.0, "thickness_mm": 0.4, "width_mm": 1.2}
    design = Design.from_dict({"stars": stars, "border": {"rings": 1}, "pins": pins, "mesh": {"edge_mm": EDGE_MM}})
    shape = exact_shape(design)
    assert shape.plan is not None
    centres, start, star = shape.plan.centres, shape.at(shape.plan.centres), 3

    def at_stars(other: Shape) -> Floats:
        places = other.at(centres)
        rotation, shift = (np.eye(3), np.zeros(3)) if pins else rigid_fit(places, start)
        return np.asarray(places @ rotation.T + shift - start)

    changes = np.diag([step for step, _ in CHANGES.values()]).repeat(len(centres), axis=0)
    changes[np.arange(len(changes)) % len(centres) != star] = 0.0
    responses = StarResponse(shape, *CHANGES)(changes)
    for number, (size, (step, nearness)) in enumerate(CHANGES.items()):
        expected, given = np.zeros((2, *start.shape))
        for sign in (0.5, -0.5):
            sizes = [[stars[size] + 2.0 * sign * step if key == size else np.nan for key in SIZE_KEYS]]
            changed = with_painted_stars(design, shape.plan.sites[[star]], sizes)
            expected += sign * at_stars(exact_shape(changed, near=shape, edge_mm=EDGE_MM))
            moved = shape.positions + 2.0 * sign * responses[..., number]
            given += sign * at_stars(replace(shape, positions=moved))
        assert np.linalg.norm(given - expected) < nearness * np.linalg.norm(expected), size


@pytest.mark.slow
def test_stars_of_one_colour_give_the_same_as_stars_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    shape = exact_shape(Design.from_dict({"stars": {"length_mm": 7.5}, "border": {"rings": 2}, "pins": [HELD]}))
    assert shape.plan is not None
    changes = np.eye(len(shape.plan.centres))
    together = StarResponse(shape, "length_mm")(changes)
    monkeypatch.setattr("asterism.exact.star_sensitivity.COLOUR_STEPS", (1000,) * 3)
    alone = StarResponse(shape, "length_mm")(changes)
    assert np.abs(together - alone).max() < 1e-6 * np.abs(alone).max()


def test_stars_at_both_ends_of_what_can_be_printed_have_derivatives() -> None:
    """Arms that nearly reach the next star, the thickest ones, and the shortest and thinnest."""
    lattice = {"kind": "square", "spacing_mm": 18.0, "arms": 4}
    pins = [{"corners": [0, 1, 2, 3], "scale": 0.8}]
    border = {"polygon_mm": [[-27.0, -27.0], [27.0, -27.0], [27.0, 27.0], [-27.0, 27.0]]}
    for length, thickness in ((8.0, THICKNESS_RANGE_MM[1]), (MIN_ARM_MM, THICKNESS_RANGE_MM[0])):
        stars = {"length_mm": length, "thickness_mm": thickness, "width_mm": 2.0}
        design = Design.from_dict({"stars": stars, "lattice": lattice, "border": border, "pins": pins})
        shape = exact_shape(design, edge_mm=EDGE_MM)
        response = StarResponse(shape, "length_mm", "thickness_mm")
        assert shape.plan is not None and np.isfinite(response(np.eye(2 * len(shape.plan.centres)))).all()


def test_a_thickness_that_is_rounded_has_no_response_even_between_two_layers() -> None:
    rounding = {"first_layer_mm": 0.3, "layer_mm": 0.2, "line_mm": 0.4}
    stars = {"length_mm": 7.0, "thickness_mm": 0.4, "rounding": rounding}
    design = Design.from_dict({"stars": stars, "border": {"rings": 1}, "pins": [HELD]})
    moves = StarResponse(exact_shape(design, edge_mm=EDGE_MM), "length_mm", "thickness_mm")(np.eye(14))
    assert np.abs(moves[..., :7]).max() > 0.1 and not moves[..., 7:].any()
