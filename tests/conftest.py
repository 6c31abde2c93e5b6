"""Tests run side by side: each worker keeps to one thread, or they would wait for each other."""

import os
import signal
from functools import cache
from pathlib import Path

import pytest
from jaxtyping import install_import_hook

# Modules whose annotations give the shapes of arrays, such as Float[np.ndarray, "V 3"]: every call in a test, and every
# record that is made, is checked against them. Modules with compiled loops cannot be wrapped.
CHECKED_MODULES = (
    "asterism.shape.diameter",
    "asterism.shape.pose",
    "asterism.shape.self_intersections",
    "asterism.shape.surface_fields",
    "fem.elements.tabulation",
    "pattern.geometry",
    "pattern.layout.layout",
    "pattern.mesh.mesh",
)
install_import_hook(CHECKED_MODULES, "beartype.beartype")

for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
# pictures are made without a display, also where a test draws on its own
os.environ.setdefault("MPLBACKEND", "Agg")
# a shell that starts the tests in the background has them ignore Ctrl-C, and with them every program they start
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


ORDER = (
    "validation",
    "test_notebooks.py",
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
    """What takes longest, and shares most, first: tests side by side are dealt out in parts that get smaller.

    So the sheets of the paper's figures are not computed by each worker, and nobody waits for one long test at the end.
    Two workers begin an eighth of all tests apart: in a fresh checkout the first one compiles the loops of the preview,
    while the second one compares scans and fits strips, which need few of them.
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
