"""In which directions to bend a guess for a free sheet.

What a lattice prefers is known at once: the energy of a uniformly bent sheet, point by point. It has a hollow at every
axis of the lattice, all about as deep. Which of them suits the outline and the changes over the sheet, only the
equilibria tell; so all are offered, but for those that the sheet's own symmetry makes equal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fem.elements.tabulation import Floats
from fem.search.simple_shapes import SimpleShape
from fem.shell.shell import Shell

TIE = 1e-3  # energies that differ less, relatively, are equal
SYMMETRY_BREAKING_ANGLE = np.radians(8.0)
SAME = np.radians(1.0)


def energy_minima(shell: Shell, stretch: float, family: Sequence[SimpleShape]) -> list[SimpleShape]:
    """Shapes of lower energy than their neighbours, the lowest first; one off all axes if all are equal.

    Parameters
    ----------
    stretch : of the bent sheet, length over printed length.
    family : shapes that differ in their angle alone, which goes round evenly.
    """
    energies = np.array([_uniform(shell, stretch, shape) for shape in family])
    if np.ptp(energies) <= TIE * abs(energies.min()):
        # axes of symmetry of sheet and lattice may be saddles: from beside them there is a way down
        return [replace(family[int(energies.argmin())], angle=SYMMETRY_BREAKING_ANGLE)]
    low = (energies <= np.roll(energies, 1)) & (energies < np.roll(energies, -1))
    low[energies.argmin()] = True
    return [family[number] for number in np.argsort(energies) if low[number]]


def distinct_shapes(
    first: SimpleShape, others: Sequence[SimpleShape], symmetries: Sequence[Floats]
) -> list[SimpleShape]:
    """Those of the others that no turn carries into the first one or into an earlier other.

    `symmetries` (2, 2): rotations and mirrors of the print that map the sheet and all that it wants onto itself.
    """
    kept = [first]
    for shape in others:
        images = [_turned(shape.angle, turn) for turn in (np.eye(2), *symmetries)]
        if all(_between(image, known.angle) > SAME for image in images for known in kept):
            kept.append(shape)
    return kept[1:]


def _uniform(shell: Shell, stretch: float, shape: SimpleShape) -> float:
    """N mm of a sheet with the shape's curvatures everywhere."""
    c, s = np.cos(shape.angle), np.sin(shape.angle)
    k, m = shape.curvature, shape.across
    bend = np.array([k * c * c + m * s * s, k * s * s + m * c * c, 2.0 * (k - m) * c * s])
    strains = np.concatenate([[0.5, 0.5, 0.0], bend]) * stretch**2 - shell.rest
    return float((shell.assembly.weights * shell.density.energies(strains)).sum())


def _turned(angle: float, turn: Floats) -> float:
    x, y = turn @ np.array([np.cos(angle), np.sin(angle)])
    return float(np.arctan2(y, x))


def _between(one: float, other: float) -> float:
    """Angle between two lines."""
    return float(abs((one - other + 0.5 * np.pi) % np.pi - 0.5 * np.pi))
