"""A printed ring round tense fabric: the tension at which it turns from flat into a saddle.

The sheet z = e cos 2t r^2/R^2 is harmonic and gains the area pi e^2; an inextensible ring loses 2 pi e^2 of the area it
spans. Bending about the width (B) and twist (T) of the ring, with the turn of its section condensed, cost
18 pi B T e^2/((B + 4 T) R^3). Hence the flat sheet is stable up to `N = 18 B T/((B + 4 T) R^3)`.
"""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse.linalg as spla
from scipy.optimize import brentq

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from tests.discrete.models import model_of
from tests.validation.rods import Material

RADIUS_MM, EDGE_MM = 40.0, 1.5


def ring(width: float, thickness: float) -> DiscreteModel:
    """The ring without bilayer, and fabric without bending."""
    data = {
        "fabric": {"bending": "none"},
        "plastic": {"rest_curvature": "none"},
        "rods": {
            "thickness_mm": thickness,
            "width_mm": width,
            "draw": [{"name": "rim", "circle_mm": {"radius": RADIUS_MM}}],
        },
        "border": {"rods": "rim"},
        "mesh": {"edge_mm": EDGE_MM},
    }
    return model_of(data)


def flat(model: DiscreteModel, size: float) -> State:
    """The print, as large as `size` times printed."""
    state = model.printed_state()
    return State(size * state.positions, state.directors, state.frames)


def in_balance(model: DiscreteModel) -> tuple[State, float]:
    """The flat equilibrium at the present release, and its tension in N/mm."""

    def slope(part: str, size: float) -> float:
        ahead, behind = (model.energies(flat(model, size + step))[part] for step in (1e-6, -1e-6))
        return (ahead - behind) / 2e-6

    size = brentq(lambda c: slope("membrane", c) + slope("rod_stretch", c), 0.99, 1.001, xtol=1e-12)
    corners = model.mesh.points[model.mesh.border_vertices]
    x, y = corners.T
    area = 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
    return flat(model, size), slope("membrane", size) / (2.0 * size * area)


def softest(model: DiscreteModel, state: State) -> float:
    """Smallest eigenvalue for motions out of the plane, N/mm; three supports take out the rigid ones."""
    vertices, border = model.n_vertices, model.mesh.border_vertices
    held = border[[0, len(border) // 3, 2 * len(border) // 3]]
    moving = np.concatenate([3 * np.setdiff1d(np.arange(vertices), held) + 2, np.arange(3 * vertices, model.n_dofs)])
    stiffness = model.pattern.full(model.hessian(state, 0.0)).tocsc()[moving][:, moving]
    return float(spla.eigsh(stiffness, k=1, sigma=0.0, v0=np.ones(len(moving)), return_eigenvectors=False)[0])


@pytest.mark.parametrize(("width", "thickness"), [(1.2, 0.6), (1.0, 1.0)])
def test_ring_turns_into_a_saddle_at_the_tension_of_theory(width, thickness):
    plastic, model = Material(width, thickness), ring(width, thickness)
    b, t = plastic.about_width, plastic.torsion
    expected = 18.0 * b * t / ((b + 4.0 * t) * RADIUS_MM**3)
    assert model.design.fabric.modulus_mpa * model.design.plastic.modulus_ratio == pytest.approx(plastic.modulus)

    def stability(release: float) -> float:
        model.set_release(release)
        return softest(model, in_balance(model)[0])

    def tension(release: float) -> float:
        model.set_release(release)
        return in_balance(model)[1]

    low, high = (brentq(lambda r, n=n: tension(r) - n * expected, 1e-6, 0.9) for n in (0.99, 1.01))
    assert stability(low) > 0.0 > stability(high)
    critical = brentq(stability, low, high, xtol=1e-7)
    assert tension(critical) == pytest.approx(expected, rel=3e-3)
