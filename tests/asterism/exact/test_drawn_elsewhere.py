"""A design that is drawn elsewhere, or turned with its lattice, takes the same shape, in a simulation and a preview."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import asterism
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.build import layout

CORNERS = np.array([[-30.0, -28.0], [33.0, -30.0], [30.0, 26.0], [5.0, 34.0], [-28.0, 25.0]])
HELD = np.array([[-28.0, -26.0], [30.0, -27.0], [27.0, 23.0]])
MODELS = {"exact": asterism.simulate, "preview": asterism.preview}


def turned(degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s], [s, c]])


@cache
def drawn(shift: tuple[float, float] = (0.0, 0.0), turn_deg: float = 0.0) -> Design:
    """Unequal stars on five corners, held at three points, with their weight; turned, then shifted."""
    turn, at = turned(turn_deg), list(shift)
    vectors = float(DEFAULT_SPACING_MM) * np.array([[np.sqrt(0.75), 0.5], [0.0, 1.0]]) @ turn.T
    places = np.column_stack([0.8 * HELD @ turn.T + shift, np.zeros(len(HELD))])
    data = {
        "fabric": {"modulus_mpa": 2.0},
        "lattice": {"kind": "custom", "vectors_mm": vectors.tolist(), "origin_mm": at, "orientation_deg": turn_deg},
        "stars": {"length_mm": {"profile": "radial", "from": 9.0, "to": 6.0, "over_mm": 30.0, "centre_mm": at}},
        "border": {"polygon_mm": (CORNERS @ turn.T + shift).tolist(), "star_margin_mm": 4.0},
        "pins": [{"points_mm": (HELD @ turn.T + shift).tolist(), "target_mm": places.tolist()}],
        "gravity": {"on": True},
        "mesh": {"edge_mm": 3.0},
    }
    return Design.from_dict(data)


@cache
def here(model: str) -> asterism.Shape:
    return MODELS[model](drawn())


# turned, the lattice's lines are numbered otherwise, and with them what is added to a mesh along the border
@pytest.mark.slow
@pytest.mark.parametrize("shift, turn_deg, apart", [((4000.0, -3000.0), 0.0, 1e-5), ((700.0, 200.0), 60.0, 2e-3)])
@pytest.mark.parametrize("model", MODELS)
def test_it_takes_the_same_shape(model: str, shift: tuple[float, float], turn_deg: float, apart: float) -> None:
    """With the same energy, wherever its pins stand."""
    one, other = here(model), MODELS[model](drawn(shift, turn_deg))
    stars = layout(drawn()).centres
    before, after = one.at(stars), other.at(stars @ turned(turn_deg).T + shift)
    rotation, moved = rigid_fit(before, after)
    off = np.linalg.norm(before @ rotation.T + moved - after, axis=1)
    assert off.max() < apart * float(np.ptp(before, axis=0).max())
    assert other.summary["energy_n_mm"] == pytest.approx(one.summary["energy_n_mm"], rel=5.0 * apart)
    assert other.summary["height_mm"] == pytest.approx(one.summary["height_mm"], rel=5.0 * apart)
    assert len(other.summary["warnings"]) == len(one.summary["warnings"])
