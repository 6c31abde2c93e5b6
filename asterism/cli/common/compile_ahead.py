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

# programs that compile the loops of a package: the smallest design of the gallery
WARM_UP = {
    "discrete": "import asterism; asterism.simulate(asterism.new('star'))",
    "fem": "import asterism; asterism.preview(asterism.new('star'))",
}


@contextmanager
def compiling_ahead(package: Literal["discrete", "fem"] | None) -> Iterator[None]:
    """Within the block, another process compiles the loops of a package, if no earlier run has."""
    if package is None or not _pays(package):
        yield
        return
    nowhere = subprocess.DEVNULL
    # -P: files in the user's folder, such as a random.py, must not take the place of modules
    program = [sys.executable, "-P", "-c", WARM_UP[package]]
    other = subprocess.Popen(program, stdin=nowhere, stdout=nowhere, stderr=nowhere)
    try:
        yield
    finally:
        other.kill()
        other.wait()


def _pays(package: str) -> bool:
    """Whether there is something to compile, a second core for it, and a place where this process would find it."""
    from equilibrium.compiled import has_machine_code

    spec = find_spec(package)
    assert spec is not None and spec.origin is not None
    folder = Path(spec.origin).parent
    return not has_machine_code(folder) and (os.cpu_count() or 1) > 1 and os.access(folder, os.W_OK)
