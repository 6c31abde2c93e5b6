"""Linear response of an equilibrium to small changes of fields, loads or supports: one solve with its Hessian.

With the gradient g of the changed energy and the Hessian H of the old equilibrium the response is `-H^-1 g`. The factor
holds H, as `fem.search.relax.relax` and `follow` leave it. The response is the first step of Newton's method with mixed
points, so `follow` continues from its state and strains and needs one iteration less.

If supports move by c, g is linear in c as well: the gradient at the old equilibrium, plus `K c` with the Hessian K over
all dofs. The gradient at the old state with moved supports would be useless, since it strains the adjacent triangles
far beyond the linear range.

Sensitivities are the responses to many small changes of the fields. A change dS of the stress at a fixed state changes
the gradient of the energy by `sum_q w B_q^T dS_q`, and with the Hessian H the equilibrium by `-H^-1` times that.

The strain energy has four parts, whose stiffnesses have errors: membrane, bending, sixfold term and Gaussian curvature.
With membrane strains E, changes of curvature K and the stiffness `A = [[M, C], [C^T, B]]` (`fem.shell.density`), the
membrane part is the energy of `N = M E + C K`, that is `N . M^-1 N / 2`, with all further terms of the density; bending
has the rest of A.
If one part is larger by the share e, its forces f are larger by e f, and the response of the equilibrium is
`-e H^-1 f` with its Hessian H. Without loads the four forces add up to zero, so that a common error moves nothing.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.mixed_newton import MAX_STEP
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import Shell

MIN_SUPPORT_MOVE = 1e-9  # 1: displacement of a support over the extent, below which it counts as zero
STIFFNESSES = ("membrane", "bending", "sixfold", "gaussian")


@dataclass(frozen=True)
class Response:
    """An equilibrium after the change, to first order.

    Attributes
    ----------
    x : (N, 3).
    """

    x: Floats
    _shell: Shell
    _start: Floats
    _before: Floats

    @cached_property
    def strains(self) -> Floats:
        """(T, Q, 6) mixed strains; computed at the first use."""
        return self._before + self._shell.assembly.strain_changes(self._start, self.x - self._start)


def linear_response(shell: Shell, x: Floats, factor: Factor) -> Response:
    """The linear response of an equilibrium to a change of fields, loads or supports.

    The response has no free rigid motions. That of a very soft sheet is shortened to the largest step of Newton's
    method.

    Parameters
    ----------
    shell : the shell after the change.
    x : (N, 3) mm, equilibrium before the change.
    factor : holds the Hessian at x before the change.
    """
    start = shell.constrain(x)
    if float(np.abs(start - x).max()) > MIN_SUPPORT_MOVE * shell.extent:
        return _response_to_moved_supports(shell, x, start - x, factor)
    strains = shell.strains(start)
    _, stress, _ = shell.density(strains)
    gradient = shell.restrict(shell.assembly.forces(start, stress) + shell.external_gradient(start))
    move = shell.move(np.zeros_like(start), newton_step(shell, start, factor, gradient))
    largest = float(np.abs(move).max())
    limit = MAX_STEP * shell.extent
    return Response(start + (move if largest <= limit else limit / largest * move), shell, start, strains)


def _response_to_moved_supports(shell: Shell, x: Floats, moved: Floats, factor: Factor) -> Response:
    """The response of the equilibrium x (N, 3) to supports that move by `moved` (N, 3), and to changed fields."""
    strains = shell.strains(x)
    _, stress, stiffness = shell.density(strains)
    forces = shell.assembly.forces(x, stress) + shell.external_gradient(x)
    forces = forces + shell.assembly.product(shell.assembly.tangent(x, stiffness, stress), moved)
    move = shell.move(moved, newton_step(shell, x, factor, shell.restrict(forces)))
    return Response(x + move, shell, x, strains)


def newton_step(shell: Shell, x: Floats, factor: Factor, gradient: Floats) -> Floats:
    """(n,) or (n, k) Newton steps for gradients over the free unknowns, without the free rigid motions."""
    step, rigid = -factor.solve(gradient), shell.rigid_modes(x)
    return np.asarray(step - rigid @ (rigid.T @ step))


def stress_under(shell: Shell, x: Floats, fields: Fields) -> Floats:
    """(T, Q, 6) stress that other fields would have at the state x (N, 3); the shell stays as it is.

    Raises
    ------
    FieldError
        The fields are not admissible.
    """
    strains = shell.assembly.strains(x, fields.rest(shell.points))
    return np.asarray(fields.densities(shell.points)(strains)[1])


def stress_responses(shell: Shell, x: Floats, factor: Factor, changes: Iterable[Floats]) -> Floats:
    """(N, 3, P) displacements of the equilibrium x for P small changes of the stress, without free rigid motions.

    Parameters
    ----------
    shell : at equilibrium in x.
    x : (N, 3) mm.
    factor : holds the Hessian at x.
    changes : P arrays (T, Q, 6), changes of the stress at fixed x.
    """
    gradients = [shell.restrict(shell.assembly.forces(x, change)) for change in changes]
    if not gradients:
        return np.zeros((*x.shape, 0))
    steps = -np.asarray(factor.solve(np.column_stack(gradients)))
    rigid = shell.rigid_modes(x)
    steps = steps - rigid @ (rigid.T @ steps)
    zero = np.zeros_like(x)
    return np.stack([shell.move(zero, step) for step in steps.T], axis=-1)


def compliance(shell: Shell, x: Floats, factor: Factor, forces: Floats) -> float:
    """`f . H^-1 f` in N mm: the work of small loads s f, with f (N, 3) N on the dofs, is s^2 times this.

    Half of the work is elastic energy. So a disturbance of energy E moves the loaded points by up to
    `sqrt(2 E f . H^-1 f)` along f. The factor holds the Hessian H at the equilibrium x (N, 3). The part of the loads
    along free rigid motions is left out.
    """
    load, rigid = shell.restrict(forces), shell.rigid_modes(x)
    load = load - rigid @ (rigid.T @ load)
    return float(load @ factor.solve(load))


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
