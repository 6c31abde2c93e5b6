"""Linear response of an equilibrium to errors of its stiffnesses: one solve for each, with the factor of its Hessian.

The strain energy has four parts: membrane, bending, sixfold term and Gaussian curvature. With membrane strains E,
changes of curvature K and the stiffness `A = [[M, C], [C^T, B]]` (`fem.shell.density`), the membrane part is the energy
of `N = M E + C K`, that is `N . M^-1 N / 2`, with all further terms of the density; bending has the rest of A.
If one part is larger by the share e, its forces f are larger by e f, and the response of the equilibrium is
`-e H^-1 f` with its Hessian H. Without loads the four forces add up to zero, so that a common error moves nothing.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.linear_response import newton_step
from asterism.fem.shell.density import Density
from asterism.fem.shell.shell import Shell

STIFFNESSES = ("membrane", "bending", "sixfold", "gaussian")


def stiffness_responses(shell: Shell, x: Floats, factor: Factor) -> Floats:
    """(n, 4) mm, displacements of the free unknowns per relative error of each stiffness, as in `STIFFNESSES`.

    They are without the free rigid motions.

    Parameters
    ----------
    x : (N, 3) mm, equilibrium; the factor holds the Hessian there.
    """
    forces = np.stack([shell.restrict(shell.assembly.forces(x, each)) for each in part_stresses(shell, x)], axis=1)
    return newton_step(shell, x, factor, forces)


def part_stresses(shell: Shell, x: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """(T, Q, 6) each: the stress by each of `STIFFNESSES` at a state x (N, 3); their sum is that of the density."""
    strains, density, modulus = shell.strains(x), shell.density, shell.gaussian_modulus
    b11, b22, double_b12 = np.moveaxis((strains + shell.rest)[..., 3:], -1, 0)
    gaussian = np.zeros_like(strains)
    gaussian[..., 3:] = modulus[..., None] * np.stack([b22, b11, -0.5 * double_b12], axis=-1)
    linear = np.einsum("tqab,tqb->tqa", density.stiffness, strains) + density.prestress
    sixfold = Density(np.zeros((6, 6)), density.sixfold, density.orientation, density.saturation)(strains)[1]
    plane = np.linalg.solve(density.stiffness[..., :3, :3], linear[..., :3, None])[..., 0]
    membrane = np.einsum("tqab,tqb->tqa", density.stiffness[..., :3], plane)
    bending = linear - membrane - gaussian
    if density.term is not None:
        membrane = membrane + density.term(strains.reshape(-1, 6))[1].reshape(strains.shape)
    return membrane, bending, sixfold, gaussian


def rms_of(shell: Shell, x: Floats, moves: Floats) -> Floats:
    """(k,) mm, rms over the printed sheet of displacements (n, k), with the rigid motions that make it smallest."""
    rigid = shell.rigid_modes(x)
    if rigid.shape[1]:
        image = shell.mass @ rigid
        moves = moves - rigid @ np.linalg.solve(rigid.T @ image, image.T @ moves)
    squares = np.einsum("nk,nk->k", moves, shell.mass @ moves)
    return np.asarray(np.sqrt(np.maximum(squares, 0.0) / shell.assembly.weights.sum()))
