"""Rods alone, for the benchmarks: a system without fabric, clamped and loaded as elasticas are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.rods.network import (
    RodNetwork,
    bend_params,
    rod_network,
    stencil_inputs,
    stretch_params,
    torsion_constant,
    twist_params,
)
from asterism.discrete.energies.rods.rod import RodBend, RodStretch, RodTwist
from asterism.discrete.model.state import State, moved_state
from asterism.discrete.model.system import System
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.newton.certificate import smallest_eigenvalue
from asterism.equilibrium.newton.minimise import Minimum, minimise


@dataclass(frozen=True)
class Material:
    """A strip of plastic: mm and MPa."""

    width: float
    thickness: float
    modulus: float = 23000.0
    poisson: float = 0.3

    @property
    def about_width(self) -> float:
        """EI of bending out of the sheet, N mm^2."""
        return self.modulus * self.width * self.thickness**3 / 12.0

    @property
    def in_plane(self) -> float:
        """EI of bending in the sheet, N mm^2."""
        return self.modulus * self.thickness * self.width**3 / 12.0

    @property
    def torsion(self) -> float:
        """GJ, N mm^2."""
        constant = torsion_constant(np.array(self.width), np.array(self.thickness))
        return float(self.modulus / (2.0 * (1.0 + self.poisson)) * constant)


def rod_energies(network: RodNetwork, printed: Array, rods: Sequence[Material], kappa: float) -> dict[str, Elements]:
    """Of rods of one plastic; printed (V, 2) mm, rest curvature kappa (1/mm)."""
    w, h = (np.array([getattr(rods[r], key) for r in network.rod]) for key in ("width", "thickness"))
    e, poisson = rods[0].modulus, rods[0].poisson
    inputs, dofs = stencil_inputs(network, len(printed))
    edge_dofs = (3 * network.edges[:, :, None] + np.arange(3)).reshape(-1, 6)
    return {
        "rod_bending": RodBend(inputs, dofs, bend_params(network, printed, e, w, h, np.full(len(w), kappa))),
        "rod_stretch": RodStretch(edge_dofs, edge_dofs, stretch_params(network, printed, e, w, h)),
        "rod_twist": RodTwist(inputs, dofs, twist_params(network, printed, e, poisson, w, h)),
    }


def rod_system(
    network: RodNetwork, printed: Array, material: Material, held: Array, load: Array | None = None, kappa: float = 0.0
) -> System:
    """The three energies of rods; printed (V, 2) mm, held (3 V + R,), load (3 V,) N, rest curvature kappa (1/mm)."""
    parts = rod_energies(network, printed, [material] * (1 + int(network.rod.max())), kappa)
    return System(parts, len(printed), network.edges, held, load)


def crumpled(system: System, state: State) -> State:
    """Bent, twisted and turned at random, far from flat."""
    rng = np.random.default_rng(0)
    for _ in range(4):
        move, turn = 0.25 * rng.normal(size=state.positions.shape), 0.2 * rng.normal(size=len(system.edges))
        spin = 0.2 * rng.normal(size=(len(state.frames), 3))
        state = moved_state(state, system.edges, state.positions + move, turn, spin)
    return state


def flat(system: System, printed: Array) -> State:
    """As printed, plastic up."""
    directors = np.tile([0.0, 0.0, 1.0], (len(system.edges), 1))
    return State(np.column_stack([printed, np.zeros(len(printed))]), directors)


@dataclass(frozen=True)
class Cantilever:
    """A straight rod along x, clamped at x = 0 in the middle of its first edge, free at x = length.

    The curvature of a vertex stands for the halves of its two edges. So the edge that the clamp holds is elastic up to
    its middle only, and a clamp anywhere else would be an error of first order.
    """

    system: System
    printed: Array
    length: float
    material: Material

    @property
    def tributary(self) -> Array:
        """(V,) mm of rod beyond the clamp that hang on every vertex."""
        edge = self.printed[1, 0] - self.printed[0, 0]
        out = np.full(len(self.printed), edge)
        out[0], out[-1] = 0.0, 0.5 * edge
        return out

    def place(self, state: State) -> Array:
        """(3,) tip over the length."""
        return state.positions[-1] / self.length

    def slope(self, state: State) -> Array:
        """(3,) tangent of the tip; it changes by O(edge^2) over the last edge, whose end has no moment."""
        last = state.positions[-1] - state.positions[-2]
        return last / np.linalg.norm(last)


def cantilever(edges: int, length: float, material: Material, kappa: float = 0.0) -> Cantilever:
    """A rod of some edges; the first half edge is behind the clamp."""
    edge = length / (edges - 0.5)
    printed = np.column_stack([edge * (np.arange(edges + 1) - 0.5), np.zeros(edges + 1)])
    network = rod_network((np.arange(edges + 1),), np.array([-1]), printed)
    held = np.zeros(3 * (edges + 1) + edges, dtype=bool)
    held[:6] = True
    held[3 * (edges + 1)] = True
    return Cantilever(rod_system(network, printed, material, held, kappa=kappa), printed, length, material)


def solve(system: System, state: State, loads: Sequence[Array]) -> Minimum:
    """The equilibrium under the last of some dead loads (V, 3), N, reached through the others."""
    factor = make_factor(system.pattern, "superlu")  # quickest to set up, for some hundred dofs
    stiffest = max(float(part.params[:, 0].max()) for part in system.parts.values())
    for load in loads:
        system.load = np.asarray(load, dtype=float).ravel()
        result = minimise(system, state, factor, 1e-11 * stiffest, 400)
        assert result.converged, result.history[-1]
        state = result.state
    return result


def lowest(system: System, state: State, modes: Array | None = None) -> float:
    """Smallest eigenvalue of the Hessian over the free dofs, some orthonormal modes (free, k) left out."""
    factor = make_factor(system.pattern, "superlu")
    left_out = np.zeros((len(system.free), 0)) if modes is None else modes
    pair = smallest_eigenvalue(system.pattern, system.hessian(state, 0.0), factor, left_out)
    assert pair.error < 1e-3 * abs(pair.value) + 1e-8
    return pair.value


def critical(eigenvalue: Callable[[float], float], low: float, high: float) -> float:
    """Where the smallest eigenvalue falls through zero, to 1e-6 of itself."""
    return float(brentq(eigenvalue, low, high, rtol=1e-6, xtol=1e-9))


def observed_order(sizes: Sequence[float], values: Sequence[float]) -> float:
    """p of `value = limit + c size^p` through three resolutions."""
    (h0, h1, h2), (v0, v1, v2) = sizes, values
    ratio = (v0 - v1) / (v1 - v2)
    return float(brentq(lambda p: (h0**p - h1**p) / (h1**p - h2**p) - ratio, 0.2, 6.0))


def limit(sizes: Sequence[float], values: Sequence[float]) -> float:
    """Value at size zero from the two finest resolutions, second order taken for granted."""
    (h1, h2), (v1, v2) = sizes[-2:], values[-2:]
    return (v2 * h1**2 - v1 * h2**2) / (h1**2 - h2**2)


def assert_second_order(
    sizes: Sequence[float], values: Sequence[float], published: float, tolerance: float, finest: float
) -> None:
    """Converges with the square of the edges to the published value.

    tolerance : of the extrapolated value, relative (or absolute below 1); finest : of the finest one.
    """
    order = observed_order(sizes, values)
    assert 1.8 < order < 2.3, (order, values)
    scale = max(abs(published), 1.0)
    assert abs(limit(sizes, values) - published) < tolerance * scale, (limit(sizes, values), published)
    assert abs(values[-1] - published) < finest * scale, (values[-1], published)
