"""Compilation of numba loops: announced, ahead of time in another process, and left out by a clock.

numba compiles a loop at its first call and keeps the machine code on disk for later runs.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Literal

from asterism.equilibrium.compiled import has_machine_code, uncached


def how_often() -> str:
    """In which runs loops are compiled, in words."""
    return "in each run, as no folder for compiled code can be written" if uncached else "later runs have the code"


@contextmanager
def announce_compiling(say: Callable[[str], None]) -> Iterator[None]:
    """Within the block, call `say` with one line for each package whose loops are compiled.

    numba reports the functions that it compiles, but not those whose machine code it reads from disk.
    """
    from numba.core import event

    # packages whose loops take seconds to compile, in a user's words
    titles = {"discrete": "the exact model", "fem": "the preview's shell", "homogenize": "the law of the stars"}
    announced: set[str] = set()

    class Listener(event.Listener):
        """numba calls `on_start` before it compiles a function."""

        def on_start(self, event: Any) -> None:
            package = event.data["dispatcher"].py_func.__module__.split(".")[1]
            if package in titles and package not in announced:
                announced.add(package)
                say(f"compiling {titles[package]}: about 20 s, {how_often()}")

        def on_end(self, event: Any) -> None:
            pass

    with event.install_listener("numba:compile", Listener()):
        yield


@contextmanager
def signs_while_compiling(say: Callable[[str], None], every_s: float) -> Iterator[None]:
    """Within the block, call `say` with a line of text every so many seconds in which loops are compiled.

    `say` is called in another thread.
    """
    from numba.core import event

    is_over = threading.Event()

    def watch() -> None:
        while not is_over.wait(every_s):
            if sum(1 if each.is_start else -1 for _, each in list(recorded.buffer)) > 0:
                say(f"compiling, {how_often()}")

    with event.install_recorder("numba:compile") as recorded:
        threading.Thread(target=watch, daemon=True).start()
        try:
            yield
        finally:
            is_over.set()


@contextmanager
def clock_without_compiling() -> Iterator[Callable[[], float]]:
    """Yield a clock (s) that stops while loops are compiled, or their machine code is read from disk."""
    from numba.core import event

    spent = event.TimingListener()  # type: ignore[no-untyped-call]
    # numba holds this lock while a loop is compiled or read from disk
    with event.install_listener("numba:compiler_lock", spent):
        yield lambda: time.perf_counter() - (spent.duration if spent.done else 0.0)


Package = Literal["discrete", "fem"]
# programs that compile the loops of a package: the smallest design of the gallery
WARM_UP: dict[Package, str] = {
    "discrete": "import asterism; asterism.simulate(asterism.new('star'), starts=1)",
    "fem": "import asterism; asterism.preview(asterism.new('star'))",
}


@contextmanager
def compiling_ahead(package: Package | None) -> Iterator[None]:
    """Within the block, another process compiles the loops of a package, if no earlier run has.

    A process compiles one loop at a time, and a command that needs both models would wait for one after the other. Both
    processes keep their machine code in the same folder, where this one finds that of the other.
    """
    # without a second core it would slow this process down
    other = start_compiling(package) if package is not None and (os.cpu_count() or 1) > 1 else None
    try:
        yield
    finally:
        if other is not None:
            other.kill()
            other.wait()


def start_compiling(package: Package) -> subprocess.Popen[bytes] | None:
    """Start a process that compiles the loops of a package; None if an earlier one has, or nobody could find them."""
    spec = find_spec(f"asterism.{package}")
    assert spec is not None and spec.origin is not None
    folder = Path(spec.origin).parent
    if has_machine_code(folder) or not os.access(folder, os.W_OK):
        return None
    nowhere = subprocess.DEVNULL
    # -P: files in the user's folder, such as a random.py, must not take the place of modules
    program = [sys.executable, "-P", "-c", WARM_UP[package]]
    return subprocess.Popen(program, stdin=nowhere, stdout=nowhere, stderr=nowhere)
