"""Where to start: simple shapes that suit the fields.

A sheet whose rest metric has the Gaussian curvature `K = -lap(ln lambda)/lambda^2` keeps its lengths where its
principal curvatures have that product. Among those, plates of Poisson's ratio nu bend least where their sum is
`(1 + nu) kappa`: that gives arcs of curvature `kappa (1 + nu)` for K = 0, saddles and bent caps, and round caps, which
are best where the sum is too small for K. Thick sheets rather stretch than bend, so smaller K are tried too, and caps
with the rest curvature itself. The side is by the sign of kappa. Sheets too large for their frame start as a cap of
their length too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from fem.elements.tabulation import Floats
from fem.search.simple_shapes import Shape
from fem.shell.shell import Shell

Side = Literal["auto", "up", "down"]

DIRECTIONS = 12  # of arcs: the six axes of a lattice and those between them
FLAT = 1e-2  # Gaussian curvature times size squared that is none
TURN = 6.0  # radians from end to end: guesses that turn further would pass through themselves
TURN_ACROSS = 2.0


@dataclass(frozen=True)
class Trends:
    """What the fields want, averaged over the sheet.

    Attributes
    ----------
    centre : (2,) printed mm.
    stretch : rest length over printed length.
    gaussian : rest metric's own curvature, per mm^2.
    curvature : rest curvature, per mm; poisson : of the bending stiffness.
    chord : size of the frame that holds the sheet, over its printed size; inf where nothing does.
    """

    centre: Floats
    stretch: float
    gaussian: float
    curvature: float
    poisson: float
    chord: float

    @property
    def side(self) -> Side:
        """That the edges go to by themselves."""
        return "down" if self.curvature < 0.0 else "up"


def trends(shell: Shell) -> Trends:
    """Means over the sheet."""
    weights = shell.assembly.weights.ravel() / shell.assembly.weights.sum()
    points = shell.points.reshape(-1, 2)
    rest = shell.rest.reshape(-1, 6)
    a11, a22, a12 = 2.0 * rest[:, 0], 2.0 * rest[:, 1], rest[:, 2]
    area = a11 * a22 - a12**2
    log_stretch = 0.25 * np.log(area)
    bend = 0.5 * (a22 * rest[:, 3] + a11 * rest[:, 4] - a12 * rest[:, 5]) / area
    centre = weights @ points
    size = float(np.sqrt(weights @ ((points - centre) ** 2).sum(axis=1)))
    u, v = ((points - centre) / size).T
    table = np.stack([np.ones_like(u), u, v, u * u - v * v, u * v, u * u + v * v], axis=1)
    root = np.sqrt(weights)[:, None]
    fit = np.linalg.lstsq(root * table, root[:, 0] * log_stretch, rcond=None)[0]
    stretch = float(np.exp(weights @ log_stretch))
    gaussian = -4.0 * float(fit[5]) / (size * stretch) ** 2
    stiffness = np.asarray(shell.density.stiffness).reshape(-1, 6, 6).mean(axis=0)
    # shapes of the same Gaussian curvature are compared, for which its modulus does not matter
    poisson = 2.0 * (stiffness[3, 4] - shell.gaussian_modulus.mean()) / (stiffness[3, 3] + stiffness[4, 4])
    return Trends(centre, stretch, gaussian, float(weights @ bend), float(poisson), _chord(shell))


def _chord(shell: Shell) -> float:
    held = shell.held_points
    if len(held) < 2:
        return np.inf
    printed, places = shell.flat[held], shell.reduction.offset(shell.progress).reshape(-1, 3)[held]
    before, after = (float(np.linalg.norm(p - p.mean(axis=0))) for p in (printed, places))
    return after / max(before, 1e-30)


def check_side(side: str) -> None:
    """Raise ValueError for what is no side."""
    if side not in get_args(Side):
        raise ValueError(f"side = {side!r}: must be {', '.join(get_args(Side))}")


def shapes(wants: Trends, size: float, side: Side = "auto") -> list[Shape]:
    """Guesses for a sheet of a printed size in mm."""
    check_side(side)
    length = size * wants.stretch
    sign = 1.0 if (wants.side if side == "auto" else side) == "up" else -1.0
    bend = abs(wants.curvature)
    out = [Shape("flat")]
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
            out += [Shape(name, k, angle, 0.0 if name == "arc" else m) for angle in angles]
    out += [Shape("cap", sign * min(k, TURN_ACROSS / length)) for k in caps if k * length > 0.02]
    return list(dict.fromkeys(out))  # what turns too far is cut back to the same


def _arc_angle(ratio: float) -> float:
    """Half of the angle of an arc whose chord is `ratio` of its length."""
    low, high = 0.0, np.pi
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sinc(middle / np.pi) > ratio else (low, middle)
    return low
