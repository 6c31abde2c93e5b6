"""The certificate agrees with a dense eigenvalue solver: a state with a negative eigenvalue is not a minimum."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.release import continuation
from asterism.discrete.release.continuation import force_scale, solve_on_mesh
from asterism.discrete.release.release_start import ReleaseStart
from asterism.pattern.design.errors import DesignError, MeshError
from tests.discrete.models import model_of

PINS: list[list[dict]] = [
    [],
    [{"where": "border", "scale": 0.8}],
    [{"corners": [0, 2, 4], "scale": 0.9}],
    [{"corners": [0, 3], "slide": "z"}],
    [{"corners": [1]}],
]


def dense(m: DiscreteModel, state: State) -> np.ndarray:
    """Eigenvalues of the whole Hessian, with the rigid motions shifted above all others."""
    full = m.pattern.full(m.hessian(state, 0.0)).toarray()
    modes = m.rigid_modes(state)
    keep = np.eye(len(full)) - modes @ modes.T
    return np.linalg.eigvalsh(keep @ full @ keep + 1e3 * np.abs(full).max() * modes @ modes.T)


@pytest.mark.slow
@settings(max_examples=12, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(
    rings=st.integers(0, 1),
    length=st.floats(4.0, 10.0),
    thickness=st.floats(0.15, 0.8),
    stretch=st.floats(1.05, 1.6),
    arms=st.sampled_from([3, 4, 6]),
    curl=st.sampled_from(["paper", "timoshenko", "none"]),
    pins=st.sampled_from(PINS),
    bend=st.sampled_from(["none", "roll", "dome", "saddle"]),
    bumps=st.booleans(),
    releases=st.sampled_from([(1.0,), (0.3, 1.0)]),
    iterations=st.sampled_from([5, 20, 300]),
)
def test_random_designs(rings, length, thickness, stretch, arms, curl, pins, bend, bumps, releases, iterations):
    design = {
        "fabric": {"stretch": stretch},
        "plastic": {"rest_curvature": curl},
        "lattice": {"arms": arms},
        "stars": {"length_mm": length, "thickness_mm": thickness},
        "border": {"rings": rings},
        "pins": pins,
        "mesh": {"edge_mm": 6.0},
    }
    try:
        m = model_of(design)
    except (DesignError, MeshError):
        return
    start = ReleaseStart(bumps=bumps, bend=bend, axis_deg=35.0, sag_mm=8.0, releases=releases)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(continuation, "MAX_ITERATIONS", iterations)
        found = solve_on_mesh(m, start)
    values = dense(m, found.state)
    # at other than stationary states rigid motions are not null vectors, and the computed value is an upper bound
    assert found.smallest_eigenvalue >= values[0] - 1e-7 * force_scale(m)
    if found.converged:
        assert found.smallest_eigenvalue == pytest.approx(values[0], rel=1e-4, abs=1e-7 * force_scale(m))
    if found.is_minimum:
        assert np.linalg.norm(m.gradient(found.state)) <= found.tolerance
        assert values[0] > 0.0
