"""A name for the code that computes samples, so that those of other code are never taken for its own."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType

from asterism import discrete, equilibrium, homogenize, pattern

# what of the packages shapes the answer of a cell
SAMPLE_SOURCES = {
    discrete: ("**/*.py",),
    equilibrium: ("**/*.py",),
    pattern: (
        "rods/*.py", "mesh/free/*.py", "mesh/outline_points.py", "geometry/*.py",
        "design/lattice.py", "design/materials.py",
        "design/residual_curvature.py", "layout/layout.py",
        "mesh/grading.py", "mesh/aligned/lattice_grid.py", "layout/supports.py", "layout/sheet_edges.py",
        "mesh/mesh.py", "design/rounding.py",
    ),
    homogenize: ("cell/*.py", "law/anisotropy.py"),
}  # fmt: skip


@functools.cache
def code_version() -> str:
    """Hash of the sources; the same wherever the same code is installed."""
    return sources_hash(SAMPLE_SOURCES)


def sources_hash(sources: Mapping[ModuleType, Sequence[str]]) -> str:
    """Hash of the source files of packages that match one of the patterns of each."""
    known = hashlib.sha256()
    for package, names in sources.items():
        folder = Path(package.__path__[0])
        for file in sorted(path for name in names for path in folder.glob(name)):
            known.update(f"{package.__name__}/{file.relative_to(folder).as_posix()}\n".encode())
            known.update(file.read_text(encoding="utf-8").encode())  # whatever ends its lines
    return known.hexdigest()[:16]
