"""Compiled loops where numba is there, plain Python where it is not."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

try:
    from numba import config, njit
    from numba.extending import register_jitable

    HAVE_NUMBA = True
except ImportError:  # numba lags behind new Pythons: everything still runs, slower
    HAVE_NUMBA = False


def formula(function: Callable[..., Any]) -> Callable[..., Any]:
    """Mark a function of one element: callable from Python as it is, and from compiled loops."""
    return register_jitable(function) if HAVE_NUMBA else function


def loop(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a loop over elements; the machine code is kept on disk between runs.

    numba looks at the file of the loop alone to see whether its machine code is stale. The formulas of a loop may be in
    other files, so it is kept in a folder whose name changes with all of them.
    """
    if not HAVE_NUMBA:
        return function
    folder = Path(function.__code__.co_filename).parent / "__pycache__" / f"formulas-{_digest(function)}"
    usual = config.CACHE_DIR  # type: ignore[attr-defined]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
    except OSError:  # installed where only an administrator may write: numba finds another place
        pass
    try:
        # numpy's error model: a division by zero in a collapsed triangle is an infinite energy, as it is without numba
        return njit(cache=True, nogil=True, error_model="numpy")(function)
    finally:
        config.CACHE_DIR = usual  # type: ignore[attr-defined]


def _digest(function: Callable[..., Any]) -> str:
    """Of every file with formulas that the function's package may use."""
    file, depth = Path(function.__code__.co_filename), function.__module__.count(".")
    package = file.parents[max(depth - 1, 0)]
    files = sorted({*package.rglob("*.py"), *Path(__file__).parent.rglob("*.py")})
    texts = [text for file in files if b"@formula" in (text := file.read_bytes()) or file == Path(__file__)]
    return hashlib.sha256(b"".join(texts)).hexdigest()[:12]
