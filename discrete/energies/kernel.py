"""The compiled loop over element formulas, and the vector operations in which they are written.

Each energy has one formula, for one element, in plain arithmetic on components. Numba compiles it within a loop over
the elements. The tests call the same function with arrays over the elements, also of complex numbers, by which they
differentiate.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from asterism.equilibrium.compiled import formula, loop

__all__ = ["combine", "cross", "dot", "formula", "multiply", "point", "sub", "sweep"]


@formula
def point(q, i):  # type: ignore[no-untyped-def]
    """The i-th point of the packed coordinates q."""
    return (q[3 * i], q[3 * i + 1], q[3 * i + 2])


@formula
def sub(a, b):  # type: ignore[no-untyped-def]
    """a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@formula
def combine(s, a, t, b):  # type: ignore[no-untyped-def]
    """s a + t b."""
    return (s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2])


@formula
def multiply(s, a):  # type: ignore[no-untyped-def]
    """s a."""
    return (s * a[0], s * a[1], s * a[2])


@formula
def dot(a, b):  # type: ignore[no-untyped-def]
    """a . b without complex conjugation, so that complex steps differentiate it."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@formula
def cross(a, b):  # type: ignore[no-untyped-def]
    """a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def sweep(
    m: int,
    n: int,
    energy_of: Callable[..., Any],
    gradient_of: Callable[..., Any],
    hessian_of: Callable[..., Any],
) -> Callable[..., None]:
    """Compile the loop over elements that read m numbers and have n dofs.

    The loop writes energies (order 0), gradients (order 1) or packed lower triangles of Hessians (order 2) to the last
    three of its arguments.
    """

    def over(configuration, inputs, params, order, blend, energy, gradient, hessian):  # type: ignore[no-untyped-def]
        q, h = np.empty(m), np.zeros((n, n))
        for e in range(inputs.shape[0]):
            for i in range(m):
                q[i] = configuration[inputs[e, i]]
            if order == 0:
                energy[e] = energy_of(q, params[e])
            elif order == 1:
                gradient_of(q, params[e], gradient[e])
            else:
                hessian_of(q, params[e], blend, h)
                k = 0
                for i in range(n):
                    for j in range(i + 1):
                        hessian[e, k] = h[i, j]
                        k += 1

    # numba names its cache files after the function: with equal names, two processes could load each other's loop
    over.__qualname__ = energy_of.__name__
    return loop(over)
