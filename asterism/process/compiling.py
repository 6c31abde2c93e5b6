"""Loops are compiled when first called, and kept for later runs: a line before the silence, and a fair clock."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from equilibrium.compiled import HAVE_NUMBA

# whose loops they are, in a user's words; those of other packages are done at once, or none of ours
OWNERS = {
    "discrete": "the exact model",
    "fem": "the preview's shell",
    "homogenize": "the law of the stars",
}


@contextmanager
def told_of_compiling(say: Callable[[str], None]) -> Iterator[None]:
    """Within the block, say once for each package that its loops are being compiled, if they really are.

    numba announces every function that it compiles, and none that it finds on disk.
    """
    if not HAVE_NUMBA:
        yield
        return
    from numba.core import event

    said: set[str] = set()

    class Watch(event.Listener):
        """Told by numba when it begins with a function, and when it is done."""

        def on_start(self, event: Any) -> None:
            package = event.data["dispatcher"].py_func.__module__.split(".")[0]
            if package in OWNERS and package not in said:
                said.add(package)
                say(f"compiling {OWNERS[package]}: in the first run only, some 20 s")

        def on_end(self, event: Any) -> None:
            pass

    with event.install_listener("numba:compile", Watch()):
        yield


@contextmanager
def clock_without_compiling() -> Iterator[Callable[[], float]]:
    """A clock (s) that stands still while loops are compiled, or their machine code is read from the disk."""
    if not HAVE_NUMBA:
        yield time.perf_counter
        return
    from numba.core import event

    spent = event.TimingListener()  # type: ignore[no-untyped-call]
    # held whenever a loop gets its machine code, from wherever
    with event.install_listener("numba:compiler_lock", spent):
        yield lambda: time.perf_counter() - (spent.duration if spent.done else 0.0)
