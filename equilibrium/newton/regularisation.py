"""Search directions from a Hessian that may be indefinite."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.clock import Clock
from asterism.equilibrium.linear.conjugate_gradients import NotPositiveDefiniteError
from asterism.equilibrium.linear.factor import Factor, IterativeFactor
from asterism.equilibrium.linear.sparse_pattern import stiffen
from asterism.equilibrium.newton.problem import AnyState, HasNearNullspace, Problem

# Factor on the regularisation after a refused matrix. A refused matrix costs as much as an accepted one, so the blend,
# which ends at 1, gets there from 1e-3 in three refusals.
GROWTH = 30.0
# Stiffness added to the convex model where it has none, over the median diagonal entry of the exact Hessian.
CONVEX_STIFFNESS_FRACTION = 1e-3
DECAY = 0.1  # factor on the amount after a step that needed no increase
MIN_AMOUNT = 1e-3  # first amount after a refused matrix; amounts below become zero
MIN_AFTER_LINE_SEARCH = 1e-2  # first amount after a failed line search
MAX_FORCING_TERM = 1e-2  # largest relative residual of an iterative solution
MIN_FORCING_TERM = 1e-10


class Regularisation:
    """Makes the matrix `(1 - b) H + b H_psd` positive definite with the smallest b that the factorisation accepts.

    Parameters
    ----------
    problem, factor : the energy and the solver for its Hessians.
    shift : added to the diagonal of every matrix.
    clock : takes the time of each part.
    amount : first b.

    Attributes
    ----------
    amount : present b; 0 is the exact Hessian.
    proven : b with which a similar problem may begin: that of the first direction, or less if it was accepted at once.
    factorisations : matrices given to the factor so far.
    """

    def __init__(self, problem: Problem, factor: Factor, shift: float, clock: Clock, amount: float) -> None:
        self._problem, self._factor, self._shift, self._clock = problem, factor, shift, clock
        self._iterative = factor if isinstance(factor, IterativeFactor) else None
        self.amount = amount
        self.proven: float | None = None
        self.factorisations = 0
        self._was_refused = False  # a matrix of the last direction
        self._solved_norm = 0.0  # norm of the last gradient that was solved for
        self._support: Ints = np.empty(0, dtype=np.int64)

    def direction(self, state: AnyState, gradient: Floats) -> Floats:
        """Descent direction (size,) from a positive definite matrix close to the Hessian.

        Raises
        ------
        FloatingPointError
            The Hessian is not finite.
        """
        if self._iterative and isinstance(self._problem, HasNearNullspace):
            self._iterative.set_near_nullspace(*self._problem.near_nullspace(state))
        with self._clock("support"):
            self._support = self._problem.support(state)
        exact, convex = self._hessian(state, 0.0), None
        diagonal = self._problem.pattern.diagonal  # after the Hessian, which may change the pattern
        # absolute values, since under compression most diagonal entries can be negative
        added = CONVEX_STIFFNESS_FRACTION * float(np.median(np.abs(exact[diagonal])))
        self._was_refused = False
        while True:
            if self.amount == 0.0:
                data = exact
            else:
                if convex is None:
                    convex = self._hessian(state, 1.0)
                    # semidefinite is not definite: slack fabric without bending has directions without stiffness
                    convex[diagonal] += added
                blend = min(self.amount, 1.0)
                data = (1.0 - blend) * exact + blend * convex
                if self.amount > 1.0:
                    data[diagonal] += added * self.amount
            if self._factorise(data):
                try:
                    with self._clock("solve"):
                        step = -self._solve(gradient)
                    if self.proven is None:
                        self.proven = self.amount if self._was_refused else _lower(self.amount / GROWTH)
                    return step
                except NotPositiveDefiniteError:
                    pass
            if not np.isfinite(data).all():
                raise FloatingPointError("the Hessian is not finite")
            self._was_refused = True
            self.amount = max(GROWTH * self.amount, MIN_AMOUNT)

    def is_definite(self, state: AnyState) -> bool:
        """Whether the exact Hessian with the shift, on its support, is positive definite; one factorisation."""
        with self._clock("support"):
            self._support = self._problem.support(state)
        accepted = self._factorise(self._hessian(state, 0.0))
        return accepted and (not self._iterative or self._iterative.proves_definite())

    @property
    def is_exact(self) -> bool:
        """The last direction is that of the exact Hessian, which a factorisation has proven positive definite."""
        return self.amount == 0.0 and self._iterative is None

    def decrease(self) -> None:
        """After a successful step: reduce the amount, unless the step needed an increase."""
        if not self._was_refused:
            self.amount = _lower(DECAY * self.amount)

    def increase(self) -> bool:
        """After a failed line search: increase the amount; False if it is at its limit."""
        if self.amount >= 1.0:
            return False
        self.amount = max(10.0 * self.amount, MIN_AFTER_LINE_SEARCH)
        return True

    def _hessian(self, state: AnyState, blend: float) -> Floats:
        with self._clock("hessian"):
            data = self._problem.hessian(state, blend)
        pattern = self._problem.pattern
        data[pattern.diagonal] += self._shift
        # rigid motions cost no energy: a support changes the step by a rigid motion, and only zeros of the inertia
        stiffen(pattern, data, self._support)
        return data

    def _solve(self, gradient: Floats) -> Floats:
        if not self._iterative:
            return self._factor.solve(gradient)
        # inexact at first, then exact enough for quadratic convergence (Eisenstat and Walker 1996, choice 2)
        norm = float(np.linalg.norm(gradient))
        forcing = MAX_FORCING_TERM
        if self._solved_norm > 0.0:
            forcing = min(MAX_FORCING_TERM, 0.9 * (norm / self._solved_norm) ** 2)
        self._solved_norm = norm
        return self._iterative.solve(gradient, max(forcing, MIN_FORCING_TERM))

    def _factorise(self, data: Floats) -> bool:
        self.factorisations += 1
        with self._clock("factorisation"):
            return bool(self._factor.factorise(data))


def _lower(amount: float) -> float:
    return amount if amount >= 0.99 * MIN_AMOUNT else 0.0
