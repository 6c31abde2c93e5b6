"""Minima of a preview's energy that the smooth surface of an exact shape leads to."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.rigid_support import stiffen
from asterism.fem.search.evidence import ShellEquilibrium
from asterism.fem.search.relax import energies_by_part, follow
from asterism.fem.shell.shell import Shell
from asterism.shape.cell_mean import CellMean
from asterism.shape.shape import Shape

FIT_SPACINGS = (0.5, 1.3)  # width and reach of the weights of the quadratic fits, in spacings
# shares of the extent at which the tether takes up the energy at stake, one after the other
TETHERS = (0.003, 0.01, 0.03, 0.1, 0.3)


class Tether:
    """Potential `k/2 int |x - x0|^2 dA`, with the mass matrix (N, N) mm^2 and k in N/mm^3."""

    def __init__(self, mass: sp.csr_matrix, place: Floats, stiffness: float) -> None:
        self._place, self._stiffness = place, stiffness * mass
        self._hessian = sp.csr_matrix(sp.kron(self._stiffness, sp.eye(3)))

    def energy(self, positions: Floats) -> float:
        """N mm, at (N, 3)."""
        return 0.5 * float(((positions - self._place) * self.gradient(positions)).sum())

    def gradient(self, positions: Floats) -> Floats:
        """(N, 3) N."""
        return np.asarray(self._stiffness @ (positions - self._place))

    def hessian(self, positions: Floats) -> sp.csr_matrix:
        """(3N, 3N) N/mm."""
        return self._hessian


def minima_from(
    exact: Shape, mean: CellMean, spacing_mm: float, shell: Shell, factor: Factor
) -> list[ShellEquilibrium]:
    """The minima from the exact shape at once, and on a tether to it that is loosened; without those that fail."""
    start = _on_supports(shell, factor, shell.space.interpolate(_smooth(exact, mean, spacing_mm)))
    ends = [follow(shell, start, factor, "exact"), _tethered(shell, factor, start)]
    return [end for end in ends if end.is_minimum]


def _smooth(exact: Shape, mean: CellMean, spacing_mm: float) -> Callable[[Floats], Floats]:
    """Value and derivatives of weighted quadratic fits to the cell means, which count at their centroids."""
    centroids, values = mean(exact.printed), mean(exact.positions)
    tree = cKDTree(centroids)
    width, reach = (share * spacing_mm for share in FIT_SPACINGS)

    def jets(points: Floats) -> Floats:
        out = np.empty((len(points), 6, 3))
        for number, near in enumerate(tree.query_ball_point(points, reach)):
            away = centroids[near] - points[number]
            u, v = away.T
            weights = np.exp(-0.5 * (u * u + v * v) / width**2)[:, None]
            table = np.stack([np.ones_like(u), u, v, 0.5 * u * u, 0.5 * v * v, u * v], axis=1)
            out[number] = np.linalg.lstsq(weights * table, weights * values[near], rcond=None)[0]
        return out

    return jets


def _on_supports(shell: Shell, factor: Factor, x: Floats) -> Floats:
    """(N, 3) the state x with the supports met, deformed like the flat sheet."""
    supported = np.asarray(shell.constrain(x))
    if shell.is_free:
        return supported
    data = shell.flat_stiffness.copy()
    stiffen(shell.pattern, data, shell.support(shell.flat))
    if not factor.factorise(data):
        return supported
    return np.asarray(shell.move(supported, -factor.solve(shell.flat_forces(supported - x))))


def _tethered(shell: Shell, factor: Factor, start: Floats) -> ShellEquilibrium:
    mass = shell.assembly.mass
    area, energy = float(shell.assembly.weights.sum()), sum(map(abs, energies_by_part(shell, start).values()))
    x = start
    for share in TETHERS:
        held = copy(shell)
        stiffness = 2.0 * energy / (area * (share * shell.extent) ** 2)
        held.potentials = (*shell.potentials, Tether(mass, start, stiffness))
        end = follow(held, x, factor, "tether")
        x = end.x if np.isfinite(end.energy) else x
    return follow(shell, x, factor, "exact")
