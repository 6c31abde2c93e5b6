"""Drawn patterns against closed forms and stars: a turned ring, a motif."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from asterism.discrete.model.state import State
from asterism.discrete.model.system import System
from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from tests.discrete.models import model_of
from tests.validation.rods import Material, solve

RADIUS_MM, EDGE_MM = 40.0, 3.0
RODS = ("rod_bending", "rod_stretch", "rod_twist")


@pytest.mark.parametrize(("width", "thickness", "kappa"), [(1.2, 0.6, 0.02), (1.2, 0.4, 0.015), (1.6, 1.2, 0.01)])
def test_a_bilayer_ring_turns_its_section_by_the_angle_of_least_energy(
    width: float, thickness: float, kappa: float
) -> None:
    """The ring alone, whose circle stays. A turn by phi costs `B (sin phi/R - k0)^2 + C (cos phi - 1)^2/R^2`."""
    rods = {"draw": [{"name": "rim", "circle_mm": {"radius": RADIUS_MM}}], "thickness_mm": thickness, "width_mm": width}
    plastic = {"rest_curvature": "none", "kappa_bar_per_mm": kappa}
    model = model_of({"rods": rods, "border": {"rods": "rim"}, "plastic": plastic}, EDGE_MM)
    path = model.mesh.rods[0][:-1]
    n, third = model.n_vertices, len(path) // 3
    held = np.ones(model.n_dofs, dtype=bool)
    held[(3 * path[:, None] + np.arange(3)).ravel()] = False
    held[3 * n :] = False
    # six components that take out the rigid motions
    held[3 * path[0] + np.arange(3)] = True
    held[[3 * path[third] + 2, 3 * path[2 * third] + 2, 3 * path[len(path) // 2] + 1]] = True
    ring = System({name: model.parts[name] for name in RODS}, n, model.edges, held)

    of = Material(width, thickness)
    b, c = of.about_width, of.in_plane
    expected = minimize_scalar(
        lambda a: b * (np.sin(a) / RADIUS_MM - kappa) ** 2 + c * (np.cos(a) - 1.0) ** 2 / RADIUS_MM**2,
        bounds=(0.0, np.pi / 2),
        method="bounded",
        options={"xatol": 1e-10},
    ).x
    flat = model.printed_state()
    middle = flat.positions[model.edges].mean(axis=1)
    outwards = middle / np.linalg.norm(middle, axis=1, keepdims=True)
    turned = [
        State(flat.positions, np.cos(expected) * flat.directors + sign * np.sin(expected) * outwards, flat.frames)
        for sign in (1.0, -1.0)
    ]
    start = min(turned, key=lambda state: sum(ring.energies(state).values()))
    state = solve(ring, start, [np.zeros(3 * n)]).state
    angle = np.arccos(np.clip(state.directors[:, 2], -1.0, 1.0))
    assert np.ptp(angle) < 1e-3 * expected
    assert angle.mean() == pytest.approx(expected, rel=2e-3)


def test_stars_written_as_a_motif_are_stars() -> None:
    sheet = {"rectangle_mm": (45.0, 22.0), "star_margin_mm": 1.0}
    common: dict[str, Any] = {"mesh": {"edge_mm": 2.0, "kind": "delaunay"}}
    stars = Design.from_dict(common | {"stars": {"length_mm": 5.0, "thickness_mm": 0.4}, "border": sheet})
    arms = [{"line_mm": [(0.0, 0.0), tuple(5.0 * arm)]} for arm in stars.lattice.arm_directions]
    motif = Design.from_dict(
        common | {"rods": {"motif": arms, "thickness_mm": 0.4}, "border": {"rectangle_mm": (45.0, 22.0)}}
    )
    one, other = (layout(each) for each in (stars, motif))
    ends = one.arm_tip, np.array([rod.points[-1] for rod in other.graph.rods])
    np.testing.assert_allclose(*(np.array(sorted(map(tuple, tips.round(6)))) for tips in ends), atol=1e-6)
    first, second = (exact_shape(each).summary for each in (stars, motif))
    assert first.is_minimum and second.is_minimum
    assert second.contraction == pytest.approx(first.contraction, abs=1e-3)
    assert second.energy_n_mm == pytest.approx(first.energy_n_mm, rel=2e-3)
    assert second.height_mm == pytest.approx(first.height_mm, rel=1e-2)
