"""Python's collection of reference cycles: none while libraries are loaded, and none of them later.

Loading numpy, scipy, numba and matplotlib makes a million objects that stay. The collector would go through them many
times in a command of two seconds, and once more at its end.
"""

from __future__ import annotations

import atexit
import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def no_collection() -> Iterator[None]:
    """Within the block, which loads libraries, nothing is collected; afterwards as before."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


@contextmanager
def late_collection() -> Iterator[None]:
    """Within the block, nothing is collected before `libraries_are_loaded`."""
    gc.disable()
    # the interpreter collects once more at its end
    atexit.unregister(gc.freeze)
    atexit.register(gc.freeze)
    try:
        yield
    finally:
        gc.unfreeze()
        gc.enable()


def libraries_are_loaded() -> None:
    """From here on collect cycles, as long computations need it, but not among the objects that exist."""
    gc.freeze()
    gc.enable()
