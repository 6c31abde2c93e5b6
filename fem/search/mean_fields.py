"""Means over the sheet of the fields that choose its initial guesses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.shell import Shell

Side = Literal["auto", "up", "down"]
FLAT_SAG_MM = 1e-6  # mm, area integral of the curvatures, below which a sheet counts as flat


def check_side(side: str) -> None:
    """Raise ValueError if the side is none of `auto`, `up`, `down`."""
    if side not in get_args(Side):
        raise ValueError(f"side = {side!r}: must be {', '.join(get_args(Side))}")


def side_of(shell: Shell, x: Floats) -> Side:
    """Side of the edges of a state x (N, 3), from its mean curvature: `down`, `up`, or `auto` if it is flat."""
    weights, forms = shell.assembly.weights, shell.strains(x) + shell.rest
    # mm; b = n . hess x is negative if the edges are below the centre
    sag = float((weights[..., None] * forms[..., 3:5]).sum())
    return "auto" if abs(sag) < FLAT_SAG_MM else "down" if sag < 0.0 else "up"


@dataclass(frozen=True)
class MeanFields:
    """Rest metric, rest curvature and Poisson's ratio, averaged over the printed sheet."""

    centre: Floats  # (2,) printed mm
    stretch: float  # rest length over printed length
    gaussian: float  # Gaussian curvature of the rest metric, per mm^2
    curvature: float  # rest curvature, per mm; positive lifts the edges towards +z
    poisson: float  # Poisson's ratio of the bending stiffness
    chord: float  # target size of the set of fixed points over its printed size; inf without two fixed points

    @property
    def side(self) -> Side:
        """Side of the edges by the sign of the rest curvature."""
        return "down" if self.curvature < 0.0 else "up"


def mean_fields(shell: Shell) -> MeanFields:
    """Area means of the shell's fields; the Gaussian curvature is that of a quadratic fit to `ln lambda`."""
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
    # the shapes that are compared have the same Gaussian curvature, so its modulus drops out
    poisson = 2.0 * (stiffness[3, 4] - shell.gaussian_modulus.mean()) / (stiffness[3, 3] + stiffness[4, 4])
    return MeanFields(centre, stretch, gaussian, float(weights @ bend), float(poisson), _chord(shell))


def _chord(shell: Shell) -> float:
    """Size of the set of fixed points at their targets over its printed size; inf without two fixed points."""
    fixed = shell.fixed_points
    if len(fixed) < 2:
        return np.inf
    printed, places = shell.flat[fixed], shell.reduction.offset(shell.progress).reshape(-1, 3)[fixed]
    before, after = (float(np.linalg.norm(p - p.mean(axis=0))) for p in (printed, places))
    return after / max(before, 1e-30)
