"""One source for two ways of running an element formula.

Every energy writes its formula once, for one element, with plain arithmetic on components. Numba compiles
it inside a loop over the elements; without numba the same functions run on all elements at once, with an
array over the elements in the place of every number. The two agree to rounding, and the second accepts
complex numbers, which the derivative tests use.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

try:
    from numba import njit
    from numba.extending import register_jitable

    HAVE_NUMBA = True
except ImportError:  # numba lags behind new Pythons: everything still runs, slower
    HAVE_NUMBA = False


def formula(function: Callable[..., Any]) -> Callable[..., Any]:
    """Mark a function of one element: callable from Python as it is, and from compiled loops."""
    return register_jitable(function) if HAVE_NUMBA else function


def loop(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a loop over elements; the machine code is kept on disk between runs."""
    return njit(cache=True, nogil=True, error_model="numpy")(function) if HAVE_NUMBA else function


Vector = tuple[Any, Any, Any]


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
def scaled(s, a):  # type: ignore[no-untyped-def]
    """s a."""
    return (s * a[0], s * a[1], s * a[2])


@formula
def dot(a, b):  # type: ignore[no-untyped-def]
    """a . b, without conjugation: complex steps pass through."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@formula
def cross(a, b):  # type: ignore[no-untyped-def]
    """a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
