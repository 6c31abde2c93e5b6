"""In the first run, compile the loops of one model in another process while this one computes with the other model.

A process compiles one loop at a time, and a command that needs both models would wait for one after the other. Both
processes keep their machine code in the same folder, where this one finds that of the other.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

Package = Literal["discrete", "fem"]
# programs that compile the loops of a package: the smallest design of the gallery
WARM_UP: dict[Package, str] = {
    "discrete": "import asterism; asterism.simulate(asterism.new('star'), starts=1)",
    "fem": "import asterism; asterism.preview(asterism.new('star'))",
}


@contextmanager
def compiling_ahead(package: Package | None) -> Iterator[None]:
    """Within the block, another process compiles the loops of a package, if no earlier run has."""
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
    from asterism.equilibrium.compiled import has_machine_code

    spec = find_spec(f"asterism.{package}")
    assert spec is not None and spec.origin is not None
    folder = Path(spec.origin).parent
    if has_machine_code(folder) or not os.access(folder, os.W_OK):
        return None
    nowhere = subprocess.DEVNULL
    # -P: files in the user's folder, such as a random.py, must not take the place of modules
    program = [sys.executable, "-P", "-c", WARM_UP[package]]
    return subprocess.Popen(program, stdin=nowhere, stdout=nowhere, stderr=nowhere)
