"""Compiled loops where numba is there, plain Python where it is not."""

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
