"""Where to start: simple shapes that suit the fields.

A sheet whose rest metric has the Gaussian curvature `K = -lap(ln lambda)/lambda^2` keeps its lengths where its
principal curvatures have that product. Among those, plates of Poisson's ratio nu bend least where their sum is
`(1 + nu) kappa`: that gives arcs of curvature `kappa (1 + nu)` for K = 0, saddles and bent caps, and round caps, which
are best where the sum is too small for K. Thick sheets rather stretch than bend, so smaller K are tried too, and caps
with the rest curvature itself. The side is by the sign of kappa. Sheets too large for their frame start as a cap of
their length too.
"""

from __future__ import annotations

import numpy as np

from fem.search.mean_fields import MeanFields
from fem.search.sides import Side, check_side
from fem.search.simple_shapes import SimpleShape

DIRECTIONS = 12  # of arcs: the six axes of a lattice and those between them
FLAT = 1e-2  # Gaussian curvature times size squared that is none
TURN = 6.0  # radians from end to end: guesses that turn further would pass through themselves
TURN_ACROSS = 2.0


def candidate_shapes(wants: MeanFields, size: float, side: Side = "auto") -> list[SimpleShape]:
    """Guesses for a sheet of a printed size in mm."""
    check_side(side)
    length = size * wants.stretch
    sign = 1.0 if (wants.side if side == "auto" else side) == "up" else -1.0
    bend = abs(wants.curvature)
    out = [SimpleShape("flat")]
    caps = [0.5 * bend, bend]
    if wants.chord < wants.stretch:
        angle = 2.0 * _arc_angle(wants.chord / wants.stretch)
        caps += [angle / length, 0.5 * angle / length]
    plain = abs(wants.gaussian) * length**2 < FLAT
    for share in (0.0,) if plain else (1.0, 0.5, 0.0):
        product = share * wants.gaussian
        half = 0.5 * (1.0 + wants.poisson) * bend
        if product > 0.0 and (share == 1.0 or half**2 < product):
            caps.append(np.sqrt(product))
        if half**2 < product:
            continue
        root = np.sqrt(half**2 - product)
        most, least = half + root, half - root
        name = "saddle" if least * length < -0.02 else "bent" if least * length > 0.02 else "arc"
        if most * length > 0.02:
            k, m = (
                sign * min(most, TURN / length),
                sign * float(np.clip(least, *(np.array([-1.0, 1.0]) * TURN_ACROSS / length))),
            )
            angles = np.pi * np.arange(DIRECTIONS) / DIRECTIONS
            out += [SimpleShape(name, k, angle, 0.0 if name == "arc" else m) for angle in angles]
    out += [SimpleShape("cap", sign * min(k, TURN_ACROSS / length)) for k in caps if k * length > 0.02]
    return list(dict.fromkeys(out))  # what turns too far is cut back to the same


def _arc_angle(ratio: float) -> float:
    """Half of the angle of an arc whose chord is `ratio` of its length."""
    low, high = 0.0, np.pi
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sinc(middle / np.pi) > ratio else (low, middle)
    return low
