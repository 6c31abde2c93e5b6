"""What the validation of the shell shares: materials, rates, places, loads brought up in steps."""

from collections.abc import Iterator, Sequence

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.newton.minimise import is_definite_on_support
from asterism.fem.search.mixed_newton import mixed_newton
from asterism.fem.search.relax import GRADIENT_TOLERANCE
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import Shell


def material(modulus: float, thickness: float, poisson: float) -> Floats:
    """(6, 6) of a plate."""
    plane = modulus / (1.0 - poisson**2)
    return isotropic(plane * thickness, plane * thickness**3 / 12.0, poisson)


def on_metric(stiffness: Floats, metric: Floats) -> Floats:
    """(..., 6, 6) stiffness per coordinate area and for coordinate strains, of a material given on its rest metric.

    Parameters
    ----------
    stiffness : (..., 6, 6) per area of the rest metric, for strains in an orthonormal frame of it whose first vector is
        along the first coordinate.
    metric : (..., 3) rest metric a11, a22, a12.

    Notes
    -----
    The strains transform to the frame, and the area is multiplied by `sqrt(det a)`.
    """
    a11, a22, a12 = np.moveaxis(np.asarray(metric, dtype=float), -1, 0)
    area = np.sqrt(a11 * a22 - a12**2)
    zero = np.zeros_like(a11)
    # orthonormal vectors in coordinates
    v = (1.0 / np.sqrt(a11), zero)
    w = (-a12 / (np.sqrt(a11) * area), np.sqrt(a11) / area)
    transform = np.stack(
        [
            np.stack([v[0] ** 2, v[1] ** 2, v[0] * v[1]], axis=-1),
            np.stack([w[0] ** 2, w[1] ** 2, w[0] * w[1]], axis=-1),
            np.stack([2.0 * v[0] * w[0], 2.0 * v[1] * w[1], v[0] * w[1] + v[1] * w[0]], axis=-1),
        ],
        axis=-2,
    )
    both = np.zeros((*a11.shape, 6, 6))
    both[..., :3, :3] = both[..., 3:, 3:] = transform
    return np.asarray(area[..., None, None] * np.einsum("...ai,...ab,...bj->...ij", both, stiffness, both))


def of_metric(stiffness: Floats, metric) -> Fields:
    """A plate whose rest metric is a function of the printed points (..., 2)."""
    return Fields(lambda points: Density(on_metric(stiffness, metric(points))), metric)


def stepped(shell: Shell, start: Floats, shares: Sequence[float], exact: bool = True) -> Iterator[Floats]:
    """States (N, 3) at these shares of the loads, each from the last one; converged, or the test fails.

    `exact` : each Hessian is positive definite.
    """
    loads, factor, x, strains = shell.loads, shell.factor(), start, None
    for share in shares:
        shell.loads = share * loads
        found = mixed_newton(shell, x, factor, GRADIENT_TOLERANCE * shell.force_scale, strains)
        assert found.converged
        x, strains = found.state, shell.strains(found.state)
        if exact:
            assert stable(shell, x)
        yield x


def stable(shell: Shell, x: Floats) -> bool:
    """The exact Hessian is positive definite, rigid motions held."""
    return is_definite_on_support(shell, x, shell.hessian(x), shell.factor())


def at(shell: Shell, x: Floats, *points: tuple[float, float]) -> Floats:
    """(n, 3) places of printed points."""
    return np.asarray(shell.space.locate(np.array(points)).value @ x)


def parts(shell: Shell, x: Floats) -> list[float]:
    """Energy of stretching and of bending."""
    e, law = shell.strains(x), np.broadcast_to(shell.density.stiffness, (*shell.points.shape[:2], 6, 6))
    return [
        0.5 * float(np.einsum("tq,tqa,tqab,tqb", shell.assembly.weights, e[..., s], law[..., s, s], e[..., s]))
        for s in (slice(0, 3), slice(3, 6))
    ]


def rate(coarse: float, fine: float, ratio: float = 2.0) -> float:
    """Observed order from two errors, the meshes `ratio` apart."""
    return float(np.log(abs(coarse / fine)) / np.log(ratio))
