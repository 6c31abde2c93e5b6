"""Strain energy density: energy per printed area as a function of the strains of `fem.shell.koiter`.

With `e = (E11, E22, 2 E12, K11, K22, 2 K12)` and `z = (K11 - K22)/2 + i K12`,

    W(e) = w_0 + s . e + e . A e / 2 + c3 Re[z^3 exp(-6 i phi)] / (1 + |z|^2/z_s^2) + w(e).

- A is a symmetric 6 x 6 stiffness: membrane, bending and their coupling. For an isotropic plate A is Koiter's energy
  (Ciarlet 2005, "An introduction to differential geometry", section 4.1), see `isotropic`.
- s is the prestress and w_0 the energy at zero strain.
- The c3 term is the lowest invariant of a lattice with sixfold symmetry, whose lines are at the angle phi: if the
  sheet turns by an angle, z turns by twice and z^3 by six times this angle. So some axes of rolling are preferred.
- A cubic alone is unbounded from below. The denominator limits its growth to |z| beyond z_s, so that W is bounded from
  below for every c3 if A is positive definite.
- w is a further energy term of the user.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.compiled import formula, loop

EnergyTerm = Callable[[Floats], tuple[Floats, Floats, Floats]]


@dataclass(frozen=True)
class Density:
    """Energy per printed area at the quadrature points (T, Q). A uniform part may be given without (T, Q).

    One quadrature point, stretched by 1 % along the first coordinate: `W = 20 * 0.01^2/2`.

    >>> sheet = Density(isotropic(membrane=20.0, bending=10.0, poisson=0.3))
    >>> energy, stress, _ = sheet(np.array([[[0.01, 0.0, 0.0, 0.0, 0.0, 0.0]]]))
    >>> energy.round(6), stress[0, 0, :3].round(6)
    (array([[0.001]]), array([0.2 , 0.06, 0.  ]))
    """

    stiffness: Floats  # A, (T, Q, 6, 6) or (6, 6), symmetric; membrane part in N/mm, coupling in N, bending in N mm
    sixfold: Floats | float = 0.0  # c3 in N mm^2, (T, Q) or a number
    # phi in radians, direction of a lattice line. A cylinder that curves along this line has the energy `+ c3
    # (kappa/2)^3` if its curvature kappa is far below 2 z_s.
    orientation: Floats | float = 0.0
    saturation: Floats | float = np.inf  # z_s per mm, (T, Q) or a number. At |z| = z_s the term is half of the cubic.
    # w as a function from e (P, 6) at all P = T Q points to its values (P,), gradients (P, 6) and Hessians (P, 6, 6).
    term: EnergyTerm | None = None
    prestress: Floats | float = 0.0  # s, stress at zero strain, (T, Q, 6) or (6,), N/mm and N
    constant: Floats | float = 0.0  # w_0, energy at zero strain, (T, Q) or a number, N/mm

    def at(self, shape: tuple[int, int]) -> Density:
        """The same density with every part as an array over the points, `shape` = (T, Q)."""

        def broadcast(values: Floats | float, tail: tuple[int, ...] = ()) -> Floats:
            # in C order, for which the loops are compiled already
            return np.array(np.broadcast_to(values, (*shape, *tail)), dtype=float, order="C")

        return Density(
            broadcast(self.stiffness, (6, 6)),
            broadcast(self.sixfold),
            broadcast(self.orientation),
            broadcast(self.saturation),
            self.term,
            broadcast(self.prestress, (6,)),
            broadcast(self.constant),
        )

    def with_gaussian(self, modulus: Floats, curvature: Floats) -> Density:
        """The density plus `modulus det b` with `b = K + b_r`: energy of Gaussian curvature (Helfrich 1973).

        Parameters
        ----------
        modulus : (T, Q) N mm.
        curvature : (T, Q, 3) rest curvature b_r, components 11, 22 and 12, per mm.
        """
        full = self.at(modulus.shape)
        b11, b22, b12 = np.moveaxis(np.broadcast_to(curvature, (*modulus.shape, 3)), -1, 0)
        full.stiffness[..., 3, 4] += modulus
        full.stiffness[..., 4, 3] += modulus
        full.stiffness[..., 5, 5] -= 0.5 * modulus
        full.prestress[..., 3:] += modulus[..., None] * np.stack([b22, b11, -b12], axis=-1)  # type: ignore[index]
        return replace(full, constant=full.constant + modulus * (b11 * b22 - b12**2))

    def __call__(self, e: Floats) -> tuple[Floats, Floats, Floats]:
        """Energies (T, Q), stresses (T, Q, 6) and stiffnesses (T, Q, 6, 6) at strains e (T, Q, 6)."""
        scalars = (self.sixfold, self.orientation, self.saturation, self.constant)
        is_expanded = (np.shape(self.stiffness), np.shape(self.prestress)) == ((*e.shape, 6), e.shape)
        is_expanded = is_expanded and all(np.shape(each) == e.shape[:2] for each in scalars)
        full = self if is_expanded else self.at(e.shape[:2])
        energy, stress, tangent = np.empty(e.shape[:2]), np.empty(e.shape), np.empty((*e.shape, 6))
        parts = (full.stiffness, full.sixfold, full.orientation, full.saturation, full.prestress, full.constant)
        _evaluate(*parts, e, energy, stress, tangent)
        if self.term is not None:
            for total, part in zip((energy, stress, tangent), self.term(e.reshape(-1, 6)), strict=True):
                total += part.reshape(total.shape)
        return energy, stress, tangent

    def energies(self, e: Floats) -> Floats:
        """(T, Q) energies at strains e (T, Q, 6), without derivatives. All parts are arrays over (T, Q), see `at`."""
        energy = np.empty(e.shape[:2])
        parts = (self.stiffness, self.sixfold, self.orientation, self.saturation, self.prestress, self.constant)
        _energies(*parts, e, energy)
        return energy if self.term is None else energy + self.term(e.reshape(-1, 6))[0].reshape(energy.shape)

    @property
    def quadratic(self) -> bool:
        """Whether the density is a quadratic function of the strains."""
        return self.term is None and not np.any(self.sixfold)


# det b = b . G b/2 of curvatures b11, b22, 2 b12
GAUSSIAN: Floats = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -0.5]])


def gaussian_limits(bending: Floats) -> tuple[Floats, Floats]:
    """Lowest and highest Gaussian modulus (...,) with which a bending stiffness (..., 3, 3) is positive definite.

    >>> low, high = gaussian_limits(np.diag([4.0, 9.0, 4.0]))
    >>> float(low.round(6)), float(high.round(6))
    (-6.0, 6.0)
    """
    inverse = np.linalg.inv(np.linalg.cholesky(bending))
    sizes = np.linalg.eigvalsh(inverse @ GAUSSIAN @ np.swapaxes(inverse, -1, -2))
    return np.asarray(-1.0 / sizes[..., -1]), np.asarray(-1.0 / sizes[..., 0])


@loop
def _evaluate(  # type: ignore[no-untyped-def]
    stiffness, sixfold, orientation, saturation, prestress, constant, e, energy, stress, tangent
):
    h = np.empty((2, 2))
    for t in range(e.shape[0]):
        for q in range(e.shape[1]):
            energy[t, q] = constant[t, q]
            for a in range(6):
                value = 0.0
                for b in range(6):
                    value += stiffness[t, q, a, b] * e[t, q, b]
                    tangent[t, q, a, b] = stiffness[t, q, a, b]
                stress[t, q, a] = prestress[t, q, a] + value
                energy[t, q] += (prestress[t, q, a] + 0.5 * value) * e[t, q, a]
            if sixfold[t, q] != 0.0:
                u, v = 0.5 * (e[t, q, 3] - e[t, q, 4]), 0.5 * e[t, q, 5]
                w, gu, gv = _roll(sixfold[t, q], orientation[t, q], saturation[t, q], u, v, h)
                energy[t, q] += w
                stress[t, q, 3] += 0.5 * gu
                stress[t, q, 4] -= 0.5 * gu
                stress[t, q, 5] += 0.5 * gv
                for a, x, y in ((3, 0.5, 0.0), (4, -0.5, 0.0), (5, 0.0, 0.5)):
                    for b, r, s in ((3, 0.5, 0.0), (4, -0.5, 0.0), (5, 0.0, 0.5)):
                        tangent[t, q, a, b] += x * (h[0, 0] * r + h[0, 1] * s) + y * (h[1, 0] * r + h[1, 1] * s)


@loop
def _energies(stiffness, sixfold, orientation, saturation, prestress, constant, e, energy):  # type: ignore[no-untyped-def]
    h = np.empty((2, 2))
    for t in range(e.shape[0]):
        for q in range(e.shape[1]):
            total = constant[t, q]
            for a in range(6):
                value = prestress[t, q, a] + 0.5 * stiffness[t, q, a, a] * e[t, q, a]
                for b in range(a):
                    value += stiffness[t, q, a, b] * e[t, q, b]
                total += value * e[t, q, a]
            if sixfold[t, q] != 0.0:
                u, v = 0.5 * (e[t, q, 3] - e[t, q, 4]), 0.5 * e[t, q, 5]
                total += _roll(sixfold[t, q], orientation[t, q], saturation[t, q], u, v, h)[0]
            energy[t, q] = total


@formula
def _roll(c3, angle, saturation, u, v, h):  # type: ignore[no-untyped-def]
    """Value and gradient of the sixfold term at z = u + i v; its Hessian is written to h (2, 2)."""
    cos, sin = c3 * np.cos(6.0 * angle), c3 * np.sin(6.0 * angle)
    uu, vv, uv = u * u, v * v, u * v
    # real and imaginary parts of c3 exp(-6 i phi) times z and z^2, real part of it times z^3
    z1, z1_i = cos * u + sin * v, cos * v - sin * u
    z2, z2_i = cos * (uu - vv) + sin * 2.0 * uv, cos * 2.0 * uv - sin * (uu - vv)
    cube = z2 * u - z2_i * v
    inverse_square = 1.0 / (saturation * saturation)
    limiter = 1.0 / (1.0 + inverse_square * (uu + vv))
    slope = -2.0 * inverse_square * limiter * limiter  # the gradient of the limiter is slope times (u, v)
    pu, pv, su, sv = 3.0 * z2, -3.0 * z2_i, slope * u, slope * v
    bend = 2.0 / limiter
    h[0, 0] = 6.0 * z1 * limiter + 2.0 * pu * su + cube * (bend * su * su + slope)
    h[1, 1] = -6.0 * z1 * limiter + 2.0 * pv * sv + cube * (bend * sv * sv + slope)
    h[0, 1] = h[1, 0] = -6.0 * z1_i * limiter + pu * sv + pv * su + cube * bend * su * sv
    return cube * limiter, pu * limiter + cube * su, pv * limiter + cube * sv


def isotropic(
    membrane: Floats | float,
    bending: Floats | float,
    poisson: Floats | float,
    bending_poisson: Floats | float | None = None,
) -> Floats:
    """(..., 6, 6) stiffness A of an isotropic sheet, per printed area and for strains in printed coordinates.

    The energy `e . A e/2` is `C/2 [(1 - nu) tr E^2 + nu (tr E)^2] + D/2 [(1 - nu) tr K^2 + nu (tr K)^2]`.

    Parameters
    ----------
    membrane : N/mm, membrane stiffness C: Young's modulus times thickness over `1 - nu^2`.
    bending : N mm, plate stiffness D.
    poisson : Poisson's ratio nu.
    bending_poisson : Poisson's ratio of bending, if it differs.

    >>> isotropic(membrane=20.0, bending=10.0, poisson=0.3)[:3, :3]
    array([[20.,  6.,  0.],
           [ 6., 20.,  0.],
           [ 0.,  0.,  7.]])
    """
    second = poisson if bending_poisson is None else bending_poisson
    parts = np.broadcast_arrays(membrane, poisson, bending, second)
    out = np.zeros((*parts[0].shape, 6, 6))
    for first, modulus, nu in ((0, parts[0], parts[1]), (3, parts[2], parts[3])):
        out[..., first, first] = out[..., first + 1, first + 1] = modulus
        out[..., first, first + 1] = out[..., first + 1, first] = nu * modulus
        out[..., first + 2, first + 2] = 0.5 * (1.0 - nu) * modulus
    return out
