"""V5-V10: elasticas, columns and rings against closed forms and published values.

All of them are discretised with clamps in the middle of an edge (see `rods.cantilever`) and converge with the square of
the edge length. Two statements a value: at 40 or 80 edges it is within the stated error, and extrapolated it is the
published number to its printed digits (rounding of the numbers included).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.special import ellipe, ellipk

from asterism.discrete.energies.rods.network import RodNetwork
from asterism.discrete.energies.rods.rod import RodStretch
from asterism.discrete.model.state import State, edge_tangents, moved_state
from asterism.discrete.model.system import System
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.newton.minimise import Minimum
from tests.validation.rods import (
    Cantilever,
    Material,
    assert_second_order,
    cantilever,
    critical,
    flat,
    lowest,
    rod_system,
    solve,
)

# An arm of the paper's cross-section, long enough to be inextensible: strains stay below 1e-4.
ARM = Material(width=1.2, thickness=0.3)
LENGTH = 100.0
UNIT = ARM.about_width / LENGTH**2  # N


def at_tip(rod: Cantilever, force: Array) -> Array:
    load = np.zeros((len(rod.printed), 3))
    load[-1] = force
    return load


def weight(rod: Cantilever, force: Array) -> Array:
    """Total force, spread evenly over the length."""
    return np.outer(rod.tributary / rod.length, force)


def angle(rod: Cantilever, state: State) -> float:
    """Degrees of the tip's tangent in the x-z plane."""
    t = rod.slope(state)
    return float(np.degrees(np.arctan2(t[2], t[0])))


def assert_converges(
    counts: tuple[int, ...],
    numbers: Callable[[Cantilever], tuple[float, ...]],
    *expected: tuple[float, float, float],
    rod: Callable[[int], Cantilever] = lambda n: cantilever(n, LENGTH, ARM),
) -> None:
    """Each of the numbers of a rod converges to a published value, within two tolerances of `assert_second_order`."""
    found = np.array([numbers(rod(n)) for n in counts]).T
    for values, of in zip(found, expected, strict=True):
        assert_second_order([1.0 / (n - 0.5) for n in counts], values, *of)


# V5


@pytest.mark.parametrize(
    ("load", "w", "u", "slope"),
    [
        (1.0, 0.30172, 0.05643, 26.434),
        (10.0, 0.81061, 0.55500, 81.949),
    ],
)
def test_tip_loaded_cantilever(load, w, u, slope):
    def tip(rod: Cantilever) -> tuple[float, ...]:
        steps = np.linspace(0.0, load, 2 + int(load / 2.0))[1:]
        loads = [at_tip(rod, [0.0, 0.0, p * UNIT]) for p in steps]
        state = solve(rod.system, flat(rod.system, rod.printed), loads).state
        assert np.abs(state.positions[:, 1]).max() < 1e-9
        x, _, z = rod.place(state)
        return z, 1.0 - x, angle(rod, state)

    # 6e-6: rounding of the fifth digit; the inextensible limit is reached to 1e-5 u
    assert_converges((20, 40, 80), tip, (w, 8e-6, 2e-4), (u, 1.2e-5, 2e-4), (slope, 1e-4, 2e-4))


# V6


@pytest.mark.parametrize(
    ("gravity", "reach", "drop"),
    [
        (1.0, 0.991246, 0.123471),
        (100.0, 0.159223, 0.937524),
    ],
)
def test_heavy_cantilever(gravity, reach, drop):
    """Romero et al. 2021."""

    def tip(rod: Cantilever) -> tuple[float, ...]:
        steps = np.geomspace(1.0, gravity, 1 + int(np.log2(gravity)))
        loads = [weight(rod, [0.0, 0.0, -g * UNIT]) for g in steps]
        x, _, z = rod.place(solve(rod.system, flat(rod.system, rod.printed), loads).state)
        return x, -z

    assert_converges((40, 80, 160), tip, (reach, 2e-5, 2e-4), (drop, 4e-5, 2e-4))


# V7


def curled(rod: Cantilever, steps: int) -> Minimum:
    """The rod without load, its rest curvature brought up in steps."""
    rest, state = rod.system.parts["rod_bending"].params, flat(rod.system, rod.printed)
    full = rest[:, 2].copy()
    for step in range(steps):
        rest[:, 2] = (step + 1) / steps * full
        found = solve(rod.system, state, [weight(rod, np.zeros(3))])
        state = found.state
    return found


@pytest.mark.parametrize(
    ("phi", "gravity", "aside", "drop"),
    [
        (2.0, 1.0, 0.679391, 0.525291),
        (np.pi, 10.0, 0.601297, 0.563872),
    ],
)
def test_naturally_curved_hanging_rod(phi, gravity, aside, drop):
    """Clamped with its tangent down (x is down here); the rest curvature bends it away from the plastic side (-z)."""

    def tip(rod: Cantilever) -> tuple[float, ...]:
        state = curled(rod, 2).state
        steps = np.linspace(0.0, gravity, 2 + int(gravity / 3.0))[1:]
        x, _, z = rod.place(solve(rod.system, state, [weight(rod, [g * UNIT, 0.0, 0.0]) for g in steps]).state)
        return -z, x

    expected = [(value, 2e-5, 3e-4) for value in (aside, drop)]
    assert_converges((20, 40, 80), tip, *expected, rod=lambda n: cantilever(n, LENGTH, ARM, kappa=phi / LENGTH))


def test_curved_rod_without_load_is_a_circle():
    """Zero energy; the polygon's corners turn by 2 atan(phi/(2 n)), as the integrated curvature says."""
    n, phi = 40, 2.0 * np.pi
    rod = cantilever(n, LENGTH, ARM, kappa=phi / LENGTH)
    result = curled(rod, 4)
    state = result.state
    assert result.energy < 1e-18 * ARM.about_width / LENGTH
    t = edge_tangents(state.positions, rod.system.edges)
    corner = np.arccos(np.clip((t[1:] * t[:-1]).sum(axis=1), -1.0, 1.0))
    np.testing.assert_allclose(corner, 2.0 * np.arctan(0.5 * phi / (n - 0.5)), rtol=1e-7)
    assert (np.diff(t[:, 2])[: n // 4] < 0.0).all()


# V8


def first_buckling(rod: Cantilever, load, low: float, high: float) -> tuple[float]:
    """Load factor at which the equilibrium that starts straight loses its stability."""
    start = flat(rod.system, rod.printed)

    def eigenvalue(factor: float) -> float:
        return lowest(rod.system, solve(rod.system, start, [load(rod, factor)]).state)

    return (critical(eigenvalue, low, high),)


def test_euler_column():
    euler = np.pi**2 / 4.0 * UNIT

    def load(rod: Cantilever, factor: float) -> Array:
        return at_tip(rod, [-factor * euler, 0.0, 0.0])

    assert_converges((10, 20, 40), lambda rod: first_buckling(rod, load, 0.9, 1.1), (1.0, 1e-5, 2e-4))


def test_column_under_its_own_weight():
    """Greenhill 1881."""

    def load(rod: Cantilever, factor: float) -> Array:
        return weight(rod, [-factor * UNIT, 0.0, 0.0])

    assert_converges((10, 20, 40), lambda rod: first_buckling(rod, load, 7.5, 8.1), (7.83735, 2e-5, 4e-4))


@pytest.mark.parametrize(
    ("degrees", "load", "x", "y"),
    [
        (20.0, 1.0154, 0.9697, 0.2194),
        (120.0, 1.8848, 0.1232, 0.8032),
    ],
)
def test_buckled_column(degrees, load, x, y):
    """The printed digits leave P/P_cr - 1 too rough at 20 degrees; elliptic integrals give all of them."""
    k = np.sin(np.radians(degrees) / 2.0)
    complete, second = ellipk(k * k), ellipe(k * k)
    exact = (2.0 * complete / np.pi) ** 2, 2.0 * second / complete - 1.0, 2.0 * k / complete
    np.testing.assert_allclose(exact, (load, x, y), atol=6e-5)

    def tip(rod: Cantilever) -> tuple[float, ...]:
        push, side = complete**2 * UNIT, 2.0 * k * UNIT
        # pushed over by a side load that goes away while the column is loaded
        loads = [at_tip(rod, [0.0, 0.0, side])]
        loads += [at_tip(rod, [-q * push, 0.0, (1.0 - q) * side]) for q in (0.25, 0.5, 0.75, 1.0)]
        state = solve(rod.system, flat(rod.system, rod.printed), loads).state
        assert lowest(rod.system, state) > 0.0
        place = rod.place(state)
        return place[0], place[2], angle(rod, state)

    assert_converges((20, 40, 80), tip, (exact[1], 4e-5, 6e-4), (exact[2], 4e-5, 3e-4), (degrees, 2e-4, 1e-3))


# V9


@pytest.mark.parametrize(
    ("load", "published", "low", "high"), [(at_tip, 4.01260, 3.8, 4.3), (weight, 12.85376, 12.4, 13.4)]
)
def test_lateral_torsional_buckling(load, published, low, high):
    """A narrow strip on edge, loaded in its plane: sensitive to bending and torsion alike.

    The classic value neglects the deflection before buckling. For a strip of ratio r = thickness/width that is a factor
    1 + (EI_w + GJ)/(2 EI_n), here 1.00013 (Hodges and Peters 1975).
    """
    strip, length = Material(width=30.0, thickness=0.3), 3000.0
    unit = np.sqrt(strip.about_width * strip.torsion) / length**2
    corrected = published * (1.0 + 0.5 * (strip.about_width + strip.torsion) / strip.in_plane)
    assert_converges(
        (10, 20, 40),
        lambda rod: first_buckling(rod, lambda rod, f: load(rod, [0.0, -f * unit, 0.0]), low, high),
        (corrected, 5e-5, 1e-3),
        rod=lambda n: cantilever(n, length, strip),
    )


# V10


def ring(n: int, radius: float, material: Material) -> tuple[System, Array]:
    """A naturally straight rod bent into a ring; its first edge is there twice, with two directors.

    The rod is cut in the middle of that edge: its two ends coincide, and the angle between their directors, which
    nothing can change because both are held, is the total twist (modulo full turns, which the stencils keep).
    """
    turn = 2.0 * np.pi * np.arange(n) / n
    printed = radius * np.column_stack([np.cos(turn), np.sin(turn)])
    i = np.arange(n)
    around = np.column_stack([i, (i + 1) % n, (i + 2) % n])
    edges = np.vstack([around[:, :2], around[:1, :2]])
    network = RodNetwork(
        edges,
        np.zeros(n + 1, dtype=int),
        np.arange(n + 1) / n,
        around,
        np.column_stack([i, i + 1]),
        np.ones((n, 2)),
        np.ones(n),
    )
    held = np.zeros(4 * n + 1, dtype=bool)
    held[[3 * n, 4 * n]] = True
    parts = rod_system(network, printed, material, held).parts
    parts["rod_bending"].params[:, 2:4] = 0.0
    stretch = parts["rod_stretch"]
    parts["rod_stretch"] = RodStretch(stretch.inputs[:n], stretch.dofs[:n], stretch.params[:n])
    return System(parts, n, edges, held), printed


def ring_motions(system: System, state: State) -> Array:
    """(free, 6) rigid motions, with all directors turned back so that the held ones do not turn.

    An isotropic rod does not feel that turning back, which is the same about every edge's tangent.
    """
    x = state.positions - state.positions.mean(axis=0)
    n, t = len(x), edge_tangents(state.positions, system.edges)
    modes = np.zeros((system.n_dofs, 6))
    for i, axis in enumerate(np.eye(3)):
        modes[: 3 * n, i] = np.tile(axis, n)
        modes[: 3 * n, 3 + i] = np.cross(axis, x).ravel()
        modes[3 * n :, 3 + i] = (t - t[0]) @ axis
    return np.linalg.qr(modes[system.free])[0]


def test_michells_ring():
    """Twist of 2 pi sqrt(3) EI/GJ buckles an isotropic ring, naturally straight, out of its plane."""
    square = Material(width=0.6, thickness=0.6)
    assert square.about_width == pytest.approx(square.in_plane)
    published = 2.0 * np.pi * np.sqrt(3.0) * square.about_width / square.torsion
    counts = (40, 80, 160)
    found = []
    for n in counts:
        system, printed = ring(n, 30.0, square)
        start = flat(system, printed)

        def eigenvalue(factor: float, system: System = system, start: State = start, n: int = n) -> float:
            turn = factor * published * np.arange(n + 1) / n
            twisted = moved_state(start, system.edges, start.positions, turn)
            state = solve(system, twisted, [np.zeros((n, 3))]).state
            modes = ring_motions(system, state)
            image = system.pattern.product(system.hessian(state, 0.0), modes)
            assert np.abs(image).max() < 1e-7 * square.about_width
            return lowest(system, state, modes)

        found.append(critical(eigenvalue, 0.9, 1.1))
    assert_second_order([1.0 / n for n in counts], found, 1.0, 2e-4, 2e-3)


def test_twist_alone_is_even_along_a_straight_rod():
    """One end turned by two full turns: the energy of a uniform twist, GJ m^2/(2 L), the turns are not forgotten."""
    n, turns, steps = 40, 4.0 * np.pi, 16
    rod = cantilever(n, LENGTH, ARM)
    held = rod.system.held.copy()
    held[3 * n - 3 : 3 * n + 3] = True
    held[-1] = True
    system, state = System(rod.system.parts, n + 1, rod.system.edges, held), flat(rod.system, rod.printed)
    for _ in range(steps):
        turn = np.zeros(n)
        turn[-1] = turns / steps
        state = moved_state(state, system.edges, state.positions, turn)
        state = solve(system, state, [np.zeros((n + 1, 3))]).state
    length = rod.printed[-2, 0] - rod.printed[0, 0]  # from the middle of the first edge to the middle of the last
    assert system.energies(state)["rod_twist"] == pytest.approx(0.5 * ARM.torsion * turns**2 / length, rel=1e-9)
    # from +z towards -y: right-handed about +x
    angles = np.arctan2(-state.directors[:, 1], state.directors[:, 2])
    np.testing.assert_allclose(np.mod(np.diff(angles), 2.0 * np.pi), turns / (n - 1), rtol=1e-7)
