"""Where to start: simple shapes that suit the fields, the cheapest first.

A sheet whose rest metric has the Gaussian curvature `K = -lap(ln lambda)/lambda^2` keeps its lengths where its
principal curvatures have that product. Among those, plates of Poisson's ratio nu bend least where their sum is
`(1 + nu) kappa`: that gives arcs of curvature `kappa (1 + nu)` for K = 0, saddles and bent caps, and round caps where
the sum is too small for K. Thick sheets rather stretch than bend, so smaller K are tried too, and caps with the rest
curvature itself. The side is by the sign of kappa. Sheets too large for their frame start as a cap of their length too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from equilibrium.factor import Factor
from fem.directions import apart, hollows
from fem.shapes import Shape
from fem.shell import Shell
from fem.slide import Frame, Start
from fem.tabulation import Floats

Side = Literal["auto", "up", "down"]

DIRECTIONS = 12  # of arcs: the six axes of a lattice and those between them
FLAT = 1e-2  # Gaussian curvature times size squared that is none
HOPELESS = 20.0  # over what a flat sheet stores: a guess that is dearer than the best by so much is left out
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
    poisson = 2.0 * stiffness[3, 4] / (stiffness[3, 3] + stiffness[4, 4])
    return Trends(centre, stretch, gaussian, float(weights @ bend), float(poisson), _chord(shell))


def _chord(shell: Shell) -> float:
    held = shell.held_points
    if len(held) < 2:
        return np.inf
    printed, places = shell.flat[held], shell.reduction.offset(shell.progress).reshape(-1, 3)[held]
    before, after = (float(np.linalg.norm(p - p.mean(axis=0))) for p in (printed, places))
    return after / max(before, 1e-30)


def shapes(wants: Trends, size: float, side: Side = "auto") -> list[Shape]:
    """Guesses for a sheet of a printed size in mm."""
    length = size * wants.stretch
    sign = {"up": 1.0, "down": -1.0}.get(side, -1.0 if wants.curvature < 0.0 else 1.0)
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
        if half**2 < product:
            caps.append(np.sqrt(product))
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


def starts(
    shell: Shell,
    factor: Factor,
    side: Side = "auto",
    candidates: list[Shape] | None = None,
    turns: Sequence[Floats] = (),
) -> tuple[list[Start], list[Start]]:
    """The best guess of every kind, and the best one in other directions; all meet the conditions.

    Both with the lowest energy first. `turns`: see `fem.directions.apart`. Guesses that cost far more than the best one
    are not moved within themselves any further, or left out.
    """
    wants = trends(shell)
    size = float(np.ptp(shell.space.mesh.p, axis=1).max())
    frame = Frame(shell, factor, wants.centre, wants.stretch)
    families: dict[tuple[str, float, float], list[Shape]] = {}
    for shape in shapes(wants, size, side) if candidates is None else candidates:
        families.setdefault((shape.name, shape.curvature, shape.across), []).append(shape)
    offered: list[Start] = []
    others: dict[Shape, list[Shape]] = {}
    known: dict[int, int] = {}
    for family in families.values():
        shape, more = family[0], []
        if len(family) > 1 and shell.is_free:
            shape, *more = hollows(shell, wants.stretch, family)
        elif len(family) > 1:
            # families that differ in their curvatures alone have the same best direction
            if len(family) not in known:
                known[len(family)] = _best_held(frame, family)
            shape = family[known[len(family)]]
        offered.append(frame.bent(shape))
        others[shape] = more
    gain = shell.energies(shell.held(shell.flat))["sheet"]  # no shape can save more
    best: dict[str, Start] = {}
    least = np.inf
    for start in sorted(offered, key=_energy):
        if _energy(start) - least > HOPELESS * gain:
            break
        slid = frame.slid(start, least)
        least = min(least, _energy(slid))
        if slid.shape.name not in best or _energy(slid) < _energy(best[slid.shape.name]):
            best[slid.shape.name] = slid
    kinds = sorted(best.values(), key=_energy)
    first = kinds[0].shape
    turned = [frame.slid(frame.bent(shape)) for shape in apart(first, others[first], turns)]
    return kinds, sorted(turned, key=_energy)


def _energy(start: Start) -> float:
    return start.energy if np.isfinite(start.energy) else np.inf


def _best_held(frame: Frame, family: list[Shape]) -> int:
    """Of held shapes whose angles go round evenly: every other one is tried, then the neighbours of the best."""
    energies = {number: _energy(frame.bent(family[number])) for number in range(0, len(family), 2)}
    best = min(energies, key=energies.__getitem__)
    for number in ((best - 1) % len(family), (best + 1) % len(family)):
        energies[number] = _energy(frame.bent(family[number]))
    return min(energies, key=energies.__getitem__)
