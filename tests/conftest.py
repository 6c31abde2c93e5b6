"""Tests run side by side: each worker keeps to one thread, or they would wait for each other."""

import gc
import os
import signal
from functools import cache
from pathlib import Path

import hypothesis
import pytest
from jaxtyping import install_import_hook

# Modules whose annotations give the shapes of arrays, such as Float[np.ndarray, "V 3"]: every call in a test, and every
# record that is made, is checked against them. Modules with compiled loops cannot be wrapped.
CHECKED_MODULES = (
    "asterism.shape.surface",
    "asterism.pattern.geometry",
    "asterism.pattern.layout.layout",
    "asterism.pattern.mesh.mesh",
)
install_import_hook(CHECKED_MODULES, "beartype.beartype")

ROOT = Path(__file__).parents[1]
# programs that tests start run the checkout too, with the machine code of its loops
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
# cells are kept with the tests' other files, for all workers and runs
os.environ.setdefault("ASTERISM_CELLS", str(ROOT / ".pytest_cache" / "cells"))
# a machine that is busy with other things makes no example wrong
hypothesis.settings.register_profile("untimed", deadline=None)
hypothesis.settings.load_profile("untimed")
# pictures are made without a display, also where a test draws on its own
os.environ.setdefault("MPLBACKEND", "Agg")
# a shell that starts the tests in the background has them ignore Ctrl-C, and with them every program they start
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


# loading the libraries and the tests makes objects that stay: the collector goes through none of them
gc.disable()


def pytest_collection_finish() -> None:
    """From here on cycles are collected, but not among the objects that exist."""
    gc.freeze()
    gc.enable()


def pytest_sessionstart(session: pytest.Session) -> None:
    """Before tests side by side begin in a fresh checkout, compile the loops once; each worker would compile them."""
    is_worker = hasattr(session.config, "workerinput")
    if is_worker or not getattr(session.config.option, "numprocesses", None):
        return
    # not before the annotations of `CHECKED_MODULES` are checked
    from asterism.process.compiling import WARM_UP, start_compiling

    for process in [start_compiling(package) for package in WARM_UP]:
        if process is not None:
            process.wait()


ORDER = (
    "validation",
    "test_notebooks.py",
    "test_fuzz.py",
    "test_readme.py",
    "asterism/studio/page",
    "discrete/release",
    *(f"asterism/{room}" for room in ("previews", "exact", "laws", "reports", "verification", "cli", "draw", "print")),
    "asterism/measure",
    "asterism",
    "discrete",
    "homogenize",
    "fem",
    "equilibrium",
    "pattern",
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What takes longest first: tests side by side are dealt out file by file.

    So nobody waits for one long file at the end. A file is run by one worker, which makes its sheets once.
    """
    root = Path(__file__).parent
    for item in items:
        # comparisons with figures, benchmarks and solutions that others published
        if root / "validation" in item.path.parents:
            item.add_marker(pytest.mark.slow)
    rank = {root / place: number for number, place in enumerate(ORDER)}

    @cache
    def order(file: Path) -> int:
        return next((rank[place] for place in (file, *file.parents) if place in rank), len(ORDER))

    items.sort(key=lambda item: order(item.path))
