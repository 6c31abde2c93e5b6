"""The corrugation of a sheet: the heights of its stars over the mean surface, as a sum of a few waves of the lattice.

A wave is the mean of `cos(G . X)` or `sin(G . X)` over the rotations that map star and lattice onto themselves. X is
the print coordinate from the star's centre, and G a reciprocal lattice vector. So a corrugation repeats from star to
star, has mean zero and is smooth. In a sheet whose stars vary, only the amplitudes vary: there are no jumps between
cells. A rotation of the star alone, such as that of five arms, maps G to a vector that is not reciprocal: such waves do
not repeat, and amplitudes that fit one cell are wrong in the next.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from asterism.equilibrium.arrays import Floats, Ints
from asterism.homogenize.cell.point_group import point_group
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.geometry.planar import cross_2d

# relative rounding of reciprocal vectors
WAVE_TOLERANCE = 1e-9


@dataclass(frozen=True)
class CorrugationWaves:
    """The waves of a lattice and its stars.

    >>> waves = CorrugationWaves.of(Lattice())
    >>> len(waves), waves(np.zeros((1, 2)))[0, :2]  # at a star's centre
    (12, array([1., 0.]))
    """

    reciprocal: Floats  # (W, n, 2) 1/mm, reciprocal vectors G that each wave is the mean of
    odd: NDArray[np.bool_]  # (W,) True for sines

    @classmethod
    def of(cls, lattice: Lattice) -> CorrugationWaves:
        """The waves of a lattice, by growing |G|. The same lattice gives the same waves in the same order."""
        basis = 2.0 * np.pi * np.linalg.inv(np.asarray(lattice.vectors)).T
        span = np.arange(-6, 7)
        every = np.stack(np.meshgrid(span, span, indexing="ij"), axis=-1).reshape(-1, 2) @ basis
        size = np.linalg.norm(every, axis=1)
        shortest = size[size > WAVE_TOLERANCE].min()
        # length of the longest reciprocal vector, over the shortest
        every = every[(size > WAVE_TOLERANCE) & (size < 3.0 * shortest * (1.0 + WAVE_TOLERANCE))]
        group = point_group(lattice)
        rotations = group[np.linalg.det(group) > 0.0]
        first = np.asarray(lattice.arm_directions)[0]
        seen: set[tuple[float, float]] = set()
        waves: list[tuple[Floats, bool]] = []
        for vector in sorted(every, key=lambda g: _order(g, first, shortest)):
            orbit = rotations @ vector
            names = {_name(g / shortest) for g in orbit}
            if names & seen:
                continue
            opposite = {_name(-g / shortest) for g in orbit}
            seen |= names | opposite
            waves.append((orbit, False))
            if not names & opposite:  # otherwise its sines cancel
                waves.append((orbit, True))
        return cls(np.array([orbit for orbit, _ in waves]), np.array([odd for _, odd in waves]))

    def __len__(self) -> int:
        return len(self.odd)

    def __call__(self, offsets: Floats) -> Floats:
        """(N, W) values of the waves at printed offsets (N, 2), mm, from a star's centre."""
        # products of powers of two waves are much faster than sines and cosines
        basis, steps = self._steps
        top = int(np.abs(steps).max())
        powers = []
        for wave in np.exp(1j * (basis @ np.asarray(offsets, dtype=float).T)):
            ladder = [np.ones_like(wave)]
            for _ in range(top):
                ladder.append(ladder[-1] * wave)
            powers.append([*ladder, *(one.conj() for one in ladder[:0:-1])])  # negative powers, counted from the end
        waves = np.empty((len(offsets), len(steps)))
        known: dict[bytes, Floats] = {}  # a cosine and its sine
        for kind, (orbit, odd) in enumerate(zip(steps, self.odd, strict=True)):
            name = orbit.tobytes()
            if name not in known:
                known[name] = np.sum([powers[0][i] * powers[1][j] for i, j in orbit.tolist()], axis=0) / len(orbit)
            waves[:, kind] = known[name].imag if odd else known[name].real
        return waves

    @cached_property
    def _steps(self) -> tuple[Floats, Ints]:
        """The two shortest vectors (2, 2) that are not parallel, and the multiples (W, n, 2) of them that give all."""
        every = self.reciprocal.reshape(-1, 2)
        across = np.abs(cross_2d(every[0], every)) > WAVE_TOLERANCE * (every[0] @ every[0])
        basis = np.array([every[0], every[across.argmax()]])
        return basis, np.rint(self.reciprocal @ np.linalg.inv(basis)).astype(np.int64)

    def amplitudes(self, offsets: Floats, heights: Floats, weights: Floats) -> Floats:
        """(W,) amplitudes of the least-squares fit to heights, in the unit of the heights.

        Parameters
        ----------
        offsets : (N, 2) mm from the star's centre.
        heights, weights : (N,).
        """
        root = np.sqrt(weights)
        mean = float(weights @ heights / weights.sum())
        return np.asarray(np.linalg.lstsq(root[:, None] * self(offsets), root * (heights - mean), rcond=None)[0])


def _order(vector: Floats, first: Floats, shortest: float) -> tuple[float, float]:
    """Sort key: length, then angle from the first arm."""
    angle = np.arctan2(first[0] * vector[1] - first[1] * vector[0], first @ vector)
    return round(float(np.linalg.norm(vector)) / shortest, 6), round(float(angle) % (2.0 * np.pi), 6)


def _name(vector: Floats) -> tuple[float, float]:
    x, y = (round(float(value), 6) + 0.0 for value in vector)
    return x, y
