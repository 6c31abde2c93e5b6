"""Search for certified equilibria of a shell: from initial guesses, from a given state, or in load steps.

Every result carries its evidence: norm of the gradient, and definiteness of the exact Hessian. An equilibrium whose
Hessian is not positive definite is a saddle; the search leaves it along its lowest mode.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.newton.minimise import Minimum, find_minimum, is_definite_on_support
from asterism.fem.search.initial_guesses import InitialGuess, initial_guesses
from asterism.fem.search.mean_fields import Side
from asterism.fem.search.mixed_newton import mixed_newton
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.fem.shell.shell import Shell

GRADIENT_TOLERANCE = 1e-11  # 1: gradient norm of an equilibrium over `Shell.force_scale`
MAX_ITERATIONS = 60  # iterations of Newton's method with mixed points
MAX_FURTHER_ITERATIONS = 12  # the same after a minimum has been found
MAX_DESCENT_ITERATIONS = 200  # iterations of energy minimisation after Newton's method has failed
# 1: energy of a guess above the best one, over that of the flat sheet above it, up to which the guess is followed
CLOSE_GUESS = 0.1
# iterations of one search, load steps included; then it ends with the best state, and certifies no minimum
MAX_RELAX_ITERATIONS = 1000
MODE_COUNT = 3  # softest modes that are computed


@dataclass(frozen=True)
class Trial:
    """An initial guess that was followed, with the state x (N, 3) in mm where it ended and its energy in N mm."""

    name: str
    energy: float
    is_minimum: bool
    iterations: int
    x: Floats


@dataclass(kw_only=True)
class ShellEquilibrium(Minimum):
    """A state of the shell with its certificate: minimum, saddle or not converged.

    For the others, see `Minimum`.
    """

    strains: Floats  # (T, Q, 6) at the quadrature points; `follow` continues from them
    energies: dict[str, float]  # N mm, by part: as `Shell.energies`, with the part of Gaussian curvature as `gaussian`
    guess: str  # name of the initial guess that led here
    # (k,) N/mm^3, smallest eigenvalues of the Hessian with respect to the mass matrix of unit density. A mode of 1 mm
    # rms displacement has half of this times the area as its energy. An eigenvalue far below the others belongs to a
    # near-zero mode, such as a rotation of the roll axis of a uniform sheet. Empty if not computed.
    soft_modes: Floats = field(default_factory=lambda: np.empty(0))
    trials: tuple[Trial, ...] = ()  # all initial guesses that were followed
    load_steps: int = 0  # number of steps in which fields and loads were applied; 0 without load steps

    @property
    def x(self) -> Floats:
        """(N, 3) positions of the dofs, mm."""
        return self.state  # type: ignore[no-any-return]

    @property
    def absolute_energy(self) -> float:
        """N mm, sum of the absolute values of the parts: the scale of errors of the energy."""
        return sum(map(abs, self.energies.values()))


def relax(
    shell: Shell,
    factor: Factor | None = None,
    side: Side = "auto",
    shapes: Sequence[SimpleShape] | None = None,
    max_guesses: int = 2,
    soft_modes: int = MODE_COUNT,
    symmetries: Sequence[Floats] = (),
) -> ShellEquilibrium:
    """Find the equilibrium of lowest energy among those that the best initial guesses lead to.

    Raises `ValueError` if `shapes` is empty, or `max_guesses` is below 1.

    Parameters
    ----------
    factor : of `shell.factor()`, for repeated use. At the end it holds the exact Hessian if that is positive definite.
        By default a factor is made for this call.
    side : side of the printed plane for the edges; by default that of the rest curvature.
    shapes : simple shapes for the initial guesses; by default the candidates of the mean fields.
    max_guesses : number of guesses of different kinds (cap, arc, saddle, flat) that are followed. If the best guess is
        bent about an axis, guesses about other axes with a similar energy are followed too.
    soft_modes : number of smallest eigenvalues to compute.
    symmetries : rotations and reflections (2, 2) of the print; axes that they map onto each other count once.
    """
    if shapes is not None and not len(shapes):
        raise ValueError("shapes = []: at least one shape is needed; None takes the candidates of the mean fields")
    if max_guesses < 1:
        raise ValueError(f"max_guesses = {max_guesses!r}: must be at least 1")
    if factor is None:
        factor = shell.factor()
        try:
            return relax(shell, factor, side, shapes, max_guesses, soft_modes, symmetries)
        finally:
            factor.close()
    kinds, turned = initial_guesses(shell, factor, side, None if shapes is None else list(shapes), symmetries)
    results: list[ShellEquilibrium] = []
    # guesses of the best kind in other directions that are followed
    chosen = _promising(kinds, kinds)[:max_guesses] + _promising(turned, kinds)[:2]
    for guess in sorted(chosen, key=lambda guess: guess.energy):
        # once a minimum is known, a further guess gets few iterations, and more only if its energy is already lower
        lowest = min((each.energy for each in results if each.is_minimum), default=np.inf)
        known = [each.x for each in results if each.is_minimum]
        is_first, enough = lowest == np.inf, MAX_FURTHER_ITERATIONS
        name = guess.shape.name
        results.append(follow(shell, guess.x, factor, name, patient=is_first, max_iterations=enough, known=known))
        if not results[-1].is_minimum and results[-1].energy < lowest < np.inf:
            results.append(follow(shell, results[-1].x, factor, name))
    taken = sum(each.iterations for each in results)
    # if no guess leads to a minimum, the load grows in steps; a sheet that collapses does so in steps as well
    for steps in () if any(is_collapsing(shell, each) for each in results) else (4, 16):
        if taken < MAX_RELAX_ITERATIONS and not any(each.is_minimum for each in results):
            stepped, iterations = follow_load_steps(shell, factor, steps, MAX_RELAX_ITERATIONS - taken)
            results += [stepped] if stepped is not None else []
            taken += iterations
    best = min(results, key=_rank)
    if best.is_minimum:
        if best is not results[-1]:
            factorise(shell, best.x, factor)
        best = replace(best, soft_modes=softest_shell_modes(shell, best.x, factor, soft_modes)[0])
    return replace(best, trials=tuple(trial for each in results for trial in each.trials))


def follow(
    shell: Shell,
    x: Floats,
    factor: Factor,
    name: str = "given",
    strains: Floats | None = None,
    patient: bool = True,
    max_iterations: int = MAX_FURTHER_ITERATIONS,
    known: Sequence[Floats] = (),
) -> ShellEquilibrium:
    """Find the equilibrium that a state x leads to, and certify it.

    Parameters
    ----------
    x : (N, 3) mm, a state that meets the supports.
    factor : of `shell.factor()`; at the end it holds the exact Hessian if that is positive definite.
    name : name of the guess, for the result.
    strains : (T, Q, 6) mixed strains at x, such as those of an equilibrium before an edit.
    patient : if False, the search stops after few iterations and without energy minimisation.
    max_iterations : number of these iterations.
    known : (N, 3) mm each, minima; the search ends at one of them as soon as it comes near.
    """
    tolerance = GRADIENT_TOLERANCE * shell.force_scale
    given = [strains]  # for the first state only

    def iterate(state: Floats) -> Minimum:
        strains, most = given.pop() if given else None, MAX_ITERATIONS if patient else max_iterations
        return mixed_newton(shell, state, factor, tolerance, strains, most, known)

    # largest change of a dof when a saddle is left, over the extent of the sheet
    most, step = MAX_DESCENT_ITERATIONS if patient else 0, 0.02 * shell.extent
    end = find_minimum(shell, x, factor, tolerance, iterate, step, max_iterations=most)
    trial = Trial(name, end.energy, end.is_minimum, end.iterations, end.state)
    strains, energies = shell.strains(end.state), energies_by_part(shell, end.state)
    return ShellEquilibrium(**vars(end), strains=strains, energies=energies, guess=name, trials=(trial,))


def is_collapsing(shell: Shell, result: ShellEquilibrium) -> bool:
    """Whether a search without a minimum has released more strain energy than the flat sheet has.

    Then Gaussian curvature does more work than bending takes up, and the sheet folds to ever smaller waves. Strain
    energies without a modulus of Gaussian curvature are not negative.
    """
    if result.is_minimum or "gaussian" not in result.energies:
        return False
    strain_energy = result.energies["sheet"] + result.energies["gaussian"]
    return strain_energy < -shell.energies(shell.flat)["sheet"]


def factorise(shell: Shell, x: Floats, factor: Factor) -> bool:
    """Factorise the exact Hessian at x (N, 3), with rigid motions fixed; False if it is not positive definite."""
    return is_definite_on_support(shell, x, shell.hessian(x), factor)


def follow_load_steps(
    shell: Shell, factor: Factor, steps: int, max_iterations: int = MAX_RELAX_ITERATIONS
) -> tuple[ShellEquilibrium | None, int]:
    """The equilibrium from the printed sheet with fields, loads and supports in steps, and the iterations that it took.

    The equilibrium is None if a step fails, or if the steps before the last take more than `max_iterations`.
    """
    x = shell.flat
    equilibrium, spent = None, 0
    for step in range(1, steps + 1):
        if spent > max_iterations:
            return None, spent
        part = shell.at_progress(step / steps)
        equilibrium = follow(part, part.constrain(x), factor, f"{steps} load steps")
        spent += equilibrium.iterations
        if not equilibrium.converged:
            return None, spent
        x = equilibrium.x
    return None if equilibrium is None else replace(equilibrium, load_steps=steps), spent


def softest_shell_modes(shell: Shell, x: Floats, factor: Factor, count: int = MODE_COUNT) -> tuple[Floats, Floats]:
    """Smallest eigenvalues (k,) in N/mm^3 and modes (n, k); the factor holds the Hessian at the minimum x (N, 3).

    All rigid motions are left out, also those to which loads give a stiffness, since they do not change the form.
    """
    return softest_modes(shell.mass, factor, shell.rigid_motions(x), count)


def energies_by_part(shell: Shell, x: Floats) -> dict[str, float]:
    """Parts of the energy in N mm as in `Shell.energies`, with the part of Gaussian curvature as `gaussian`."""
    energies, gaussian = shell.energies(x), shell.gaussian_energy(x)
    return energies | ({"sheet": energies["sheet"] - gaussian, "gaussian": gaussian} if gaussian else {})


def _promising(offered: Sequence[InitialGuess], kinds: Sequence[InitialGuess]) -> list[InitialGuess]:
    """The guesses close to the best one, measured by its gain over the flat sheet."""
    best = kinds[0].energy
    flat = next((guess.energy for guess in kinds if guess.shape.name == "flat"), best)
    return [guess for guess in offered if guess is kinds[0] or guess.energy - best <= CLOSE_GUESS * (flat - best)]


def _rank(result: ShellEquilibrium) -> tuple[bool, bool, float]:
    """Minima before others, low energies before high ones."""
    energy = result.energy if np.isfinite(result.energy) else np.inf
    return not result.is_minimum, not result.converged, energy


class MassOperator(Protocol):
    """A symmetric positive definite matrix, or an operator that acts like one."""

    def __matmul__(self, vectors: Floats) -> Floats:
        """Product (size, k) with vectors (size, k)."""


def softest_modes(mass: MassOperator, factor: Factor, rigid: Floats, count: int) -> tuple[Floats, Floats]:
    """Smallest eigenvalues (k,) of `H v = value M v` and their modes (size, k), with `v M v = 1`.

    Block Lanczos with the inverse of H (Golub and Underwood 1977); every block is orthogonal to all earlier ones.

    Parameters
    ----------
    mass : M (size, size), positive definite.
    factor : holds H on an isostatic support, positive definite (see `minimise.is_definite_on_support`).
    rigid : (size, r) motions that H maps to zero, left out of the modes; r may be 0.
    count : number of modes; the result has fewer if the problem has fewer.

    >>> from asterism.equilibrium.linear.backends import make_factor
    >>> from asterism.equilibrium.linear.sparse_pattern import SparsePattern
    >>> pattern = SparsePattern([np.array([[0, 1], [1, 2]])], 3, np.arange(1, 3))  # the first unknown is held
    >>> data = pattern.assemble([np.array([[1.0, -1.0, 1.0], [1.0, -1.0, 1.0]])])
    >>> factor = make_factor(pattern, "superlu")
    >>> factor.factorise(data)
    True
    >>> values, modes = softest_modes(np.eye(2), factor, np.empty((2, 0)), 2)
    >>> values.round(4).tolist()
    [0.382, 2.618]
    """
    size, motions = rigid.shape
    count = min(count, size - motions)
    if count < 1:
        return np.empty(0), np.empty((size, 0))
    # further vectors in every block, for multiple eigenvalues
    block = _unit(np.random.default_rng(0).standard_normal((size, count + 1)))
    # squared length of a vector that consists of rounding errors, over that of a unit vector
    zero = 1e-20 * float((block * (mass @ block)).sum(axis=0).max())
    # vectors v with v M v = 1, the rigid motions first; their images M v; and the displacements H^-1 M v
    vectors, images = _orthonormal(rigid, mass @ rigid, zero)
    solved = np.empty((size, 0))
    values, turn = np.empty(0), np.empty((0, 0))
    # usually fewer than ten; rounding errors can prevent convergence
    for _ in range(60):
        block = _unit(block)
        for _ in range(2):  # one projection leaves too much of nearly parallel vectors
            block = block - vectors @ (images.T @ block)
        block, image = _orthonormal(block, mass @ block, zero)
        if not block.shape[1]:  # the whole space is used up
            break
        vectors, images = np.hstack([vectors, block]), np.hstack([images, image])
        # forces that do no work on rigid motions cause no reactions of the support
        block = factor.solve(image)
        solved = np.hstack([solved, block])
        previous = values
        inverse, turn = np.linalg.eigh(images[:, motions:].T @ solved)
        values, turn = 1.0 / inverse[: -count - 1 : -1], turn[:, : -count - 1 : -1]
        # relative change between blocks; the change after it is about its square
        if len(values) == len(previous) and np.abs(values - previous).max() <= 1e-5 * abs(values[-1]):
            break
    return values, np.asarray(vectors[:, motions:] @ turn)


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=0), np.finfo(float).tiny))


def _orthonormal(vectors: Floats, images: Floats, zero: float) -> tuple[Floats, Floats]:
    """Orthonormal combinations of vectors v (size, k), `v M v = 1`, and their images M v; zero vectors are left out."""
    square, turn = np.linalg.eigh(vectors.T @ images)
    kept = square > zero
    turn = turn[:, kept] / np.sqrt(square[kept])
    return vectors @ turn, images @ turn
