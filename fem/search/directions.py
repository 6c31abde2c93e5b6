"""Directions in which the initial guesses of a free sheet bend.

The energy of a uniformly bent sheet depends on the direction. It has a local minimum at each axis of the lattice, and
these minima are about equally low. The equilibria alone decide which axis suits the outline and the variation of the
fields, so each axis gives a guess, except those that the symmetry of the sheet makes equal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.fem.shell.shell import Shell

ENERGY_TOLERANCE = 1e-3  # 1: relative difference below which energies count as equal
SYMMETRY_BREAKING_ANGLE = np.radians(8.0)  # rad, from an axis of symmetry, which may be a saddle
SAME_AXIS_ANGLE = np.radians(1.0)  # rad, difference below which two axes count as equal


def energy_minima(shell: Shell, stretch: float, family: Sequence[SimpleShape]) -> list[SimpleShape]:
    """Shapes at the local minima of the energy over the angle, the lowest first.

    If all energies are equal there is one shape, away from the axes of symmetry.

    Parameters
    ----------
    stretch : length of the bent sheet over its printed length.
    family : shapes that differ only in their angle; the angles are equally spaced over half a turn.
    """
    energies = np.array([_uniform_energy(shell, stretch, shape) for shape in family])
    if np.ptp(energies) <= ENERGY_TOLERANCE * abs(energies.min()):
        # an axis of symmetry may be a saddle, from which the search would have to depart
        return [replace(family[int(energies.argmin())], angle=SYMMETRY_BREAKING_ANGLE)]
    low = (energies <= np.roll(energies, 1)) & (energies < np.roll(energies, -1))
    low[energies.argmin()] = True
    return [family[number] for number in np.argsort(energies) if low[number]]


def distinct_shapes(
    first: SimpleShape, others: Sequence[SimpleShape], symmetries: Sequence[Floats]
) -> list[SimpleShape]:
    """The shapes in `others` that no symmetry maps onto `first` or onto an earlier one.

    `symmetries`: rotations and reflections (2, 2) of the print that leave outline, supports and fields unchanged.
    """
    kept = [first]
    for shape in others:
        images = [_image_angle(shape.angle, symmetry) for symmetry in (np.eye(2), *symmetries)]
        if all(_line_angle(image, shape_kept.angle) > SAME_AXIS_ANGLE for image in images for shape_kept in kept):
            kept.append(shape)
    return kept[1:]


def _uniform_energy(shell: Shell, stretch: float, shape: SimpleShape) -> float:
    """Energy in N mm of a sheet with the curvatures of the shape at every point."""
    c, s = np.cos(shape.angle), np.sin(shape.angle)
    k, m = shape.curvature, shape.across
    bend = np.array([k * c * c + m * s * s, k * s * s + m * c * c, 2.0 * (k - m) * c * s])
    strains = np.concatenate([[0.5, 0.5, 0.0], bend]) * stretch**2 - shell.rest
    return float((shell.assembly.weights * shell.density.energies(strains)).sum())


def _image_angle(angle: float, symmetry: Floats) -> float:
    """Angle of a direction after a rotation or reflection (2, 2)."""
    x, y = symmetry @ np.array([np.cos(angle), np.sin(angle)])
    return float(np.arctan2(y, x))


def _line_angle(first: float, second: float) -> float:
    """Angle between two lines, 0 to pi/2, from their directions."""
    return float(abs((first - second + 0.5 * np.pi) % np.pi - 0.5 * np.pi))
