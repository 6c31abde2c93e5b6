"""Where to start: simple shapes that suit the fields, the cheapest first.

A dome or a saddle by the sign of the rest metric's Gaussian curvature, `-lap(ln lambda)/lambda^2`; arcs in several
directions where the rest curvature rolls the sheet, each with the curvature `kappa (1 + nu)` of a free cylinder; the
side by the sign of kappa. Pinned sheets that are too large for their frame start as a cap of their length.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from equilibrium.factor import Factor
from equilibrium.newton import STOP
from fem.shapes import Shape
from fem.shell import Shell
from fem.tabulation import Floats

Side = Literal["auto", "up", "down"]

SLIDES = 3  # in-plane corrections of a guess
SLIGHT = 0.05  # of its energy: corrections that gain less are the last
TIE = 1e-3  # energies of arcs that differ less are equal
ASKEW = np.radians(8.0)
DIRECTIONS = 12  # of arcs: the six axes of a lattice and those between them


@dataclass(frozen=True)
class Trends:
    """What the fields want, averaged over the sheet.

    Attributes
    ----------
    centre : (2,) printed mm.
    stretch : rest length over printed length.
    gaussian : rest metric's own curvature, per mm^2.
    curvature : rest curvature, per mm; poisson : of the bending stiffness.
    chord : largest printed length's place between what holds it, over its printed length; inf where nothing does.
    """

    centre: Floats
    stretch: float
    gaussian: float
    curvature: float
    poisson: float
    chord: float


@dataclass(frozen=True)
class Start:
    """A state to start from: its name, the shape it was made of, and its energy in N mm."""

    shape: Shape
    x: Floats
    energy: float


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
    return Trends(centre, stretch, float(gaussian), float(weights @ bend), float(poisson), _chord(shell))


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
    bend = sign * abs(wants.curvature)
    least = 0.02 / length
    out = [Shape("flat")]
    curvatures = [bend]
    if wants.gaussian > 0.0:
        curvatures.append(sign * np.sqrt(wants.gaussian))
    if wants.chord < wants.stretch:
        curvatures.append(sign * 2.0 * _arc_angle(wants.chord / wants.stretch) / length)
    for k in curvatures:
        out += [Shape("cap", share * k) for share in (0.5, 1.0) if abs(share * k) > least]
    if wants.gaussian < -(least**2):
        k = sign * np.sqrt(-wants.gaussian)
        out += [Shape("saddle", k, angle) for angle in np.radians([0.0, 15.0, 30.0, 45.0, 60.0, 75.0])]
    if abs(bend) > least:
        k = bend * (1.0 + wants.poisson)
        out += [Shape("arc", k, np.pi * i / DIRECTIONS) for i in range(DIRECTIONS)]
    return [_rolled_once(shape, length) for shape in out]


def _rolled_once(shape: Shape, length: float) -> Shape:
    """A shape whose ends do not meet: beyond that a guess would pass through itself."""
    most = (2.0 if shape.name == "cap" else 6.0) / length
    return replace(shape, curvature=float(np.clip(shape.curvature, -most, most)))


def _arc_angle(ratio: float) -> float:
    """Half of the angle of an arc whose chord is `ratio` of its length."""
    low, high = 0.0, np.pi
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sinc(middle / np.pi) > ratio else (low, middle)
    return low


def starts(shell: Shell, factor: Factor, side: Side = "auto", candidates: list[Shape] | None = None) -> list[Start]:
    """The best guess of every kind, all meeting the conditions, the lowest energy first."""
    wants = trends(shell)
    size = float(np.ptp(shell.space.mesh.p, axis=1).max())
    fit = _Fit(shell, factor)
    kinds: dict[str, list[Shape]] = {}
    for shape in shapes(wants, size, side) if candidates is None else candidates:
        kinds.setdefault(shape.name, []).append(shape)
    if "arc" in kinds and shell.is_free:
        kinds["arc"] = [_best_arc(shell, wants.stretch, kinds["arc"])]
    best, gain = [], 0.0
    for name, group in kinds.items():
        guesses = []
        for shape in group:
            x = fit.held(shape.positions(shell.space, wants.centre, wants.stretch))
            guesses.append(Start(shape, x, shell.energy(x)) if name == "arc" else fit.slid(shape, x))
        lowest = min(guesses, key=_energy)
        if name == "flat":
            gain = fit.gain
        if name == "arc":  # to its membrane an arc is a flat sheet: it too would gain by sliding
            lowest = replace(lowest, energy=lowest.energy - gain)
        best.append(lowest)
    return sorted(best, key=_energy)


def _energy(start: Start) -> float:
    return start.energy if np.isfinite(start.energy) else np.inf


def _best_arc(shell: Shell, stretch: float, arcs: list[Shape]) -> Shape:
    """Of free cylinders, whose strains are known everywhere."""
    square = stretch**2
    energies = []
    for arc in arcs:
        c, s = np.cos(arc.angle), np.sin(arc.angle)
        bend = arc.curvature * square * np.array([c * c, s * s, 2.0 * c * s])
        strains = np.concatenate([[0.5 * square, 0.5 * square, 0.0], bend]) - shell.rest
        energies.append(float((shell.assembly.weights * shell.density(strains)[0]).sum()))
    best = arcs[int(np.argmin(energies))]
    if len(arcs) > 1 and max(energies) - min(energies) <= TIE * abs(min(energies)):
        # no axis is better: start off the axes of symmetry of sheet and lattice, from where there is a way down
        return replace(best, angle=ASKEW)
    return best


class _Fit:
    """Takes free shapes into their frame, and slides them along themselves, with the flat sheet's stiffness."""

    def __init__(self, shell: Shell, factor: Factor) -> None:
        self._shell, self._factor = shell, factor
        data = shell.flat_stiffness.copy()
        diagonal = shell.pattern.diagonal
        data[diagonal[shell.support(shell.flat)]] += STOP * data[diagonal].max()
        self._ready = factor.factorise(data)
        self.gain = 0.0  # what the last guess gained by sliding, N mm

    def held(self, x: Floats) -> Floats:
        """(N, 3) x moved to what holds it, and bent there as the flat sheet would be."""
        shell = self._shell
        held = shell.held_points
        if len(held):
            places = shell.reduction.offset(shell.progress).reshape(-1, 3)
            x = shell.shifted(x, places[held].mean(axis=0) - x[held].mean(axis=0))
        stepped = shell.held(x)
        if not self._ready or np.array_equal(stepped, x):
            return stepped
        stress = shell.linear_stress(shell.assembly.strain_changes(shell.flat, stepped - x))
        return shell.move(stepped, -self._factor.solve(shell.restricted(shell.assembly.forces(shell.flat, stress))))

    def slid(self, shape: Shape, x: Floats) -> Start:
        """x slid along the printed plane as its membrane stresses ask for, as long as that lowers the energy."""
        energy = first = self._shell.energy(x)
        for _ in range(SLIDES if self._ready else 0):
            trial = self._slide(x)
            reached = self._shell.energy(trial)
            if not reached < energy:
                break
            enough = energy - reached < SLIGHT * energy
            x, energy = trial, reached
            if enough:
                break
        self.gain = first - energy
        return Start(shape, x, energy)

    def _slide(self, x: Floats) -> Floats:
        shell = self._shell
        strains = shell.strains(x)
        strains[..., 3:] = 0.0
        stress = shell.linear_stress(strains)
        stress[..., 3:] = 0.0
        return shell.move(x, -self._factor.solve(shell.restricted(shell.assembly.forces(shell.flat, stress))))
