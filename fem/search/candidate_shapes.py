"""Simple shapes that suit the mean fields: candidates for initial guesses.

A rest metric `lambda^2 I` has the Gaussian curvature `K = -lap(ln lambda)/lambda^2`. A sheet keeps its rest lengths if
the product of its principal curvatures is K (Gauss). Among these shapes a plate with Poisson's ratio nu and rest
curvature kappa has the least bending energy if their sum is `(1 + nu) kappa`:

- K = 0 gives an arc of curvature `(1 + nu) kappa`;
- other K give a saddle or a shape bent both ways, as long as real principal curvatures exist;
- otherwise the best shape is a round cap of curvature `sqrt(K)`.

Thick sheets stretch rather than bend. Therefore smaller K are candidates too, and caps of the rest curvature itself. A
sheet that is longer than the frame of its supports has caps of its own length as further candidates. The sign of kappa
gives the side.
"""

from __future__ import annotations

import numpy as np

from asterism.fem.search.mean_fields import MeanFields, Side, check_side
from asterism.fem.search.simple_shapes import SimpleShape

ARC_DIRECTIONS = 12  # the six axes of a hexagonal lattice and the directions halfway between them
FLAT_METRIC = 1e-2  # 1: Gaussian curvature times size squared, below which a rest metric counts as flat
MIN_TURN = 0.02  # rad from end to end, below which a shape counts as flat
MAX_TURN = 6.0  # rad from end to end; a larger angle may lead to self-intersection
MAX_TURN_ACROSS = 2.0  # rad from end to end, for caps and for the second principal direction


def candidate_shapes(fields: MeanFields, size: float, side: Side = "auto") -> list[SimpleShape]:
    """Candidates for a sheet whose printed size is `size` mm, on a side of the printed plane.

    Raises
    ------
    ValueError
        The side is none of `auto`, `up`, `down`.

    Examples
    --------
    >>> import numpy as np
    >>> fields = MeanFields(np.zeros(2), stretch=0.8, gaussian=0.0, curvature=0.01, poisson=0.3, chord=np.inf)
    >>> sorted({shape.name for shape in candidate_shapes(fields, size=60.0)})
    ['arc', 'cap', 'flat']
    """
    check_side(side)
    length = size * fields.stretch
    sign = 1.0 if (fields.side if side == "auto" else side) == "up" else -1.0
    bend = abs(fields.curvature)
    out = [SimpleShape("flat")]
    caps = [0.5 * bend, bend]
    if fields.chord < fields.stretch:
        angle = 2.0 * _arc_angle(fields.chord / fields.stretch)
        caps += [angle / length, 0.5 * angle / length]
    is_flat = abs(fields.gaussian) * length**2 < FLAT_METRIC
    for share in (0.0,) if is_flat else (1.0, 0.5, 0.0):
        product = share * fields.gaussian
        half = 0.5 * (1.0 + fields.poisson) * bend
        if product > 0.0 and (share == 1.0 or half**2 < product):
            caps.append(np.sqrt(product))
        if half**2 < product:
            continue
        root = np.sqrt(half**2 - product)
        larger, smaller = half + root, half - root
        name = "saddle" if smaller * length < -MIN_TURN else "bent" if smaller * length > MIN_TURN else "arc"
        if larger * length > MIN_TURN:
            k, m = (
                sign * min(larger, MAX_TURN / length),
                sign * float(np.clip(smaller, *(np.array([-1.0, 1.0]) * MAX_TURN_ACROSS / length))),
            )
            angles = np.pi * np.arange(ARC_DIRECTIONS) / ARC_DIRECTIONS
            out += [SimpleShape(name, k, angle, 0.0 if name == "arc" else m) for angle in angles]
    out += [SimpleShape("cap", sign * min(k, MAX_TURN_ACROSS / length)) for k in caps if k * length > MIN_TURN]
    return list(dict.fromkeys(out))  # the limits may make shapes equal


def _arc_angle(ratio: float) -> float:
    """Half of the angle of an arc whose chord is `ratio` times its length."""
    low, high = 0.0, np.pi
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sinc(middle / np.pi) > ratio else (low, middle)
    return low
