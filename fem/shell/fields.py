"""Fields of a shell over the printed domain: rest metric, rest curvature, energy density.

The rest metric a_r and the rest curvature b_r are the first and the second fundamental form at which the strains of
`fem.shell.koiter` vanish. They need not satisfy the equations of Gauss and Codazzi: then no stress-free state exists
(Efrati, Sharon and Kupferman 2009, "Elastic theory of unconstrained non-Euclidean plates").
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.density import Density

Field = ArrayLike | Callable[[Floats], ArrayLike]


class FieldError(ValueError):
    """A field that is not admissible at a point; the message names field, place and value."""

    def __init__(self, name: str, place: Floats, values: Floats, why: str) -> None:
        row = ", ".join(f"{value:.4g}" for value in values)
        super().__init__(f"{name} at ({place[0]:.4g}, {place[1]:.4g}) mm: ({row}) {why}")
        self.place = place  # (2,) printed mm


@dataclass(frozen=True)
class Fields:
    """Fields of a shell: each constant, an array over the quadrature points, or a function of points (T, Q, 2) mm."""

    density: Density | Callable[[Floats], Density]  # energy per printed area
    metric: Field = (1.0, 1.0, 0.0)  # (..., 3) rest metric `a_11, a_22, a_12`; the metric of the print by default
    # (..., 3) rest curvature `b_11, b_22, b_12` per mm. With the normal `x_1 x x_2` a positive one lifts the edges
    # towards +z. A contracted sheet of curvature kappa has `b = kappa a`.
    curvature: Field = (0.0, 0.0, 0.0)
    # (...,) N mm, modulus of Gaussian curvature: it adds `gaussian det b` to the energy per printed area. A negative
    # one favours caps over saddles. A uniform one acts only at the boundary (Gauss and Bonnet).
    gaussian: Field = 0.0

    def rest(self, points: Floats) -> Floats:
        """(T, Q, 6) of `(a/2, b)` at rest, in the components of the strains.

        Raises `FieldError` if a field is not finite, or the metric is not positive definite.
        """
        a = _at(self.metric, points, "rest metric")
        b = _at(self.curvature, points, "rest curvature")
        least = np.minimum(a[..., 0], a[..., 0] * a[..., 1] - a[..., 2] ** 2)
        if least.min() <= 0.0:
            where = np.unravel_index(least.argmin(), least.shape)
            raise FieldError("rest metric", points[where], a[where], "is not positive definite")
        return np.concatenate([0.5 * a[..., :2], a[..., 2:], b[..., :2], 2.0 * b[..., 2:]], axis=-1)

    def gaussian_modulus(self, points: Floats) -> Floats:
        """(T, Q) N mm, at these points; `FieldError` where it is not finite."""
        values = _scalar(self.gaussian, points)
        _check_finite(values[..., None], points, "modulus of Gaussian curvature")
        return values

    def densities(self, points: Floats) -> Density:
        """The density at these points, spelled out, with the energy of Gaussian curvature.

        Raises `FieldError` if a part is not finite, the stiffness not symmetric, or the saturation not positive.
        """
        density = self.density
        if callable(density) and not isinstance(density, Density):
            density = density(points)
        density = density.at(points.shape[:2])
        _check_density(density, points)
        modulus = self.gaussian_modulus(points)
        if not modulus.any():
            return density
        return density.with_gaussian(modulus, _at(self.curvature, points, "rest curvature"))


def of_stretch(density: Density | Callable[[Floats], Density], stretch: Field, curvature: Field = 0.0) -> Fields:
    """Isotropic fields: lengths become `stretch` times the printed ones, with the curvature `curvature` per mm.

    A stretch that is not positive gives a metric that is not positive definite: `FieldError`.
    """

    def metric(points: Floats) -> Floats:
        values = _scalar(stretch, points)
        square = np.sign(values) * values**2
        return np.stack([square, square, np.zeros_like(square)], axis=-1)

    def bend(points: Floats) -> Floats:
        return _scalar(curvature, points)[..., None] * metric(points)

    return Fields(density, metric, bend)


def _scalar(field: Field, points: Floats) -> Floats:
    values = field(points) if callable(field) else field
    return np.broadcast_to(np.asarray(values, dtype=float), points.shape[:-1])


def _at(field: Field, points: Floats, name: str) -> Floats:
    values = np.asarray(field(points) if callable(field) else field, dtype=float)
    values = np.broadcast_to(values, (*points.shape[:-1], 3))
    _check_finite(values, points, name)
    return values


def _check_finite(values: Floats, points: Floats, name: str) -> None:
    """Raise FieldError at the first of the points whose values (..., k) are not all finite."""
    invalid = ~np.isfinite(values).all(axis=-1)
    if invalid.any():
        where = np.unravel_index(invalid.argmax(), invalid.shape)
        raise FieldError(name, points[where], values[where], "is not finite")


def _check_density(density: Density, points: Floats) -> None:
    """Raise FieldError if a part of the density is not finite, not positive or not symmetric where it must be."""
    for name in ("stiffness", "prestress", "sixfold", "orientation", "constant"):
        values = np.reshape(getattr(density, name), (*points.shape[:2], -1))
        if not np.isfinite(values).all():
            where = tuple(np.argwhere(~np.isfinite(values))[0])
            raise FieldError(name, points[where[:2]], values[where][None], "is not finite")
    stiffness, saturation = np.asarray(density.stiffness), np.asarray(density.saturation)
    if not (saturation > 0.0).all():
        where = np.unravel_index((~(saturation > 0.0)).argmax(), saturation.shape)
        raise FieldError("saturation", points[where], saturation[where][None], "is not positive")
    skew = np.abs(stiffness - np.swapaxes(stiffness, -1, -2))
    if skew.max() > 1e-9 * np.abs(stiffness).max():
        t, q, i, k = np.unravel_index(skew.argmax(), skew.shape)
        values = stiffness[t, q, [i, k], [k, i]]
        raise FieldError("stiffness", points[t, q], values, f"of strains {i} and {k} is not symmetric")
