"""Energy of the sheet per printed area, as a function of the strains `e = (E11, E22, 2 E12, K11, K22, 2 K12)`.

    W(e) = e . A e / 2 + c3 Re[z^3 exp(-6 i phi)] / (1 + |z|^2/z_s^2) + w(e),    z = (K11 - K22)/2 + i K12

A is any symmetric 6 x 6 matrix (membrane, bending and their coupling). The second term lets a sheet with a lattice at
the angle phi prefer some of its axes to roll about: z turns by twice the angle of the sheet, z^3 by six times. A pure
cubic has no lowest energy, so it is cut off at z_s, beyond which it grows like |z| only: with a positive definite A the
energy is bounded below whatever c3 is. w is any further law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.tabulation import Floats

Law = Callable[[Floats], tuple[Floats, Floats, Floats]]


@dataclass(frozen=True)
class Density:
    """Energy per area at the quadrature points (T, Q); what does not change over the sheet may be given once.

    Attributes
    ----------
    stiffness : (T, Q, 6, 6) or (6, 6), symmetric; N/mm, N and N mm for its parts.
    sixfold : (T, Q) or a number, c3 in N mm^2.
    orientation : phi in radians, that of a lattice line; a cylinder whose curvature lies along it has the energy
        `+ c3 (kappa/2)^3` as long as kappa is far below 2 z_s.
    saturation : z_s per mm, (T, Q) or a number; the term has half of its cubic's value at |z| = z_s.
    law : takes e (P, 6) of all points, P = T Q, to w (P,), its gradient (P, 6) and its Hessian (P, 6, 6).
    """

    stiffness: Floats
    sixfold: Floats | float = 0.0
    orientation: Floats | float = 0.0
    saturation: Floats | float = np.inf
    law: Law | None = None

    def __call__(self, e: Floats) -> tuple[Floats, Floats, Floats]:
        """Energies (T, Q), stresses (T, Q, 6) and stiffnesses (T, Q, 6, 6) at strains e (T, Q, 6)."""
        stress = np.matmul(self.stiffness, e[..., None])[..., 0]
        energy = 0.5 * np.einsum("tqa,tqa->tq", stress, e)
        tangent = np.broadcast_to(self.stiffness, (*e.shape, 6))
        if np.any(self.sixfold):
            tangent = tangent.copy()
            for total, part in zip((energy, stress, tangent), self._roll(e), strict=True):
                total += part
        if self.law is not None:
            parts = self.law(e.reshape(-1, 6))
            energy, stress, tangent = (
                total + part.reshape(total.shape) for total, part in zip((energy, stress, tangent), parts, strict=True)
            )
        return energy, stress, np.ascontiguousarray(tangent)

    @property
    def quadratic(self) -> bool:
        """The stiffness is the same for all strains."""
        return self.law is None and not np.any(self.sixfold)

    def _roll(self, e: Floats) -> tuple[Floats, Floats, Floats]:
        """The sixfold term with its derivatives."""
        z = 0.5 * (e[..., 3] - e[..., 4] + 1j * e[..., 5])
        turned = np.asarray(self.sixfold) * np.exp(-6j * np.asarray(self.orientation))
        least = np.square(1.0 / np.asarray(self.saturation))
        cut = 1.0 / (1.0 + least * (z.real**2 + z.imag**2))
        cube = (turned * z**3).real
        # over the real and imaginary parts of z: the gradient of the cubic and of what cuts it off
        first = 3.0 * turned * z**2
        up = np.stack([first.real, -first.imag], axis=-1)
        down = (-2.0 * least * cut**2)[..., None] * np.stack([z.real, z.imag], axis=-1)
        gradient = up * cut[..., None] + cube[..., None] * down
        second = 6.0 * turned * z
        curved = np.stack([second.real, -second.imag, -second.imag, -second.real], axis=-1).reshape(*z.shape, 2, 2)
        mixed = up[..., :, None] * down[..., None, :]
        hessian = curved * cut[..., None, None] + mixed + np.swapaxes(mixed, -1, -2)
        hessian += (cube * 2.0 / cut)[..., None, None] * down[..., :, None] * down[..., None, :]
        hessian -= (cube * 2.0 * least * cut**2)[..., None, None] * np.eye(2)
        parts = np.array([[0.0, 0.0, 0.0, 0.5, -0.5, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 0.5]])
        return cube * cut, gradient @ parts, np.einsum("...ab,ai,bj->...ij", hessian, parts, parts)


def isotropic(
    membrane: Floats | float,
    bending: Floats | float,
    poisson: Floats | float,
    bending_poisson: Floats | float | None = None,
) -> Floats:
    """(..., 6, 6) stiffness of an isotropic sheet on the Euclidean metric of the print.

    `membrane` is Young's modulus times thickness over `1 - nu^2` (N/mm), `bending` the plate stiffness D (N mm), both
    per printed area and for strains in printed coordinates.
    """
    second = poisson if bending_poisson is None else bending_poisson
    parts = np.broadcast_arrays(membrane, poisson, bending, second)
    out = np.zeros((*parts[0].shape, 6, 6))
    for start, modulus, nu in ((0, parts[0], parts[1]), (3, parts[2], parts[3])):
        out[..., start, start] = out[..., start + 1, start + 1] = modulus
        out[..., start, start + 1] = out[..., start + 1, start] = nu * modulus
        out[..., start + 2, start + 2] = 0.5 * (1.0 - nu) * modulus
    return out


def on_metric(stiffness: Floats, metric: Floats) -> Floats:
    """(..., 6, 6) the same material where the print has a metric of its own, per area of the coordinates.

    `stiffness` is per area and unit vectors of the rest metric (..., 3) = (a11, a22, a12): the strains are taken to an
    orthonormal frame of it, whose first vector is along the first coordinate, and the area grows by sqrt(det a).
    """
    a11, a22, a12 = np.moveaxis(np.asarray(metric, dtype=float), -1, 0)
    area = np.sqrt(a11 * a22 - a12**2)
    zero = np.zeros_like(a11)
    # columns: the orthonormal vectors in coordinates
    one = (1.0 / np.sqrt(a11), zero)
    two = (-a12 / (np.sqrt(a11) * area), np.sqrt(a11) / area)
    half = np.stack(
        [
            np.stack([one[0] ** 2, one[1] ** 2, one[0] * one[1]], axis=-1),
            np.stack([two[0] ** 2, two[1] ** 2, two[0] * two[1]], axis=-1),
            np.stack([2.0 * one[0] * two[0], 2.0 * one[1] * two[1], one[0] * two[1] + one[1] * two[0]], axis=-1),
        ],
        axis=-2,
    )
    turn = np.zeros((*a11.shape, 6, 6))
    turn[..., :3, :3] = turn[..., 3:, 3:] = half
    return area[..., None, None] * np.einsum("...ai,...ab,...bj->...ij", turn, stiffness, turn)
