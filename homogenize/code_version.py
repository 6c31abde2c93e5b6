"""A name for the code that computes samples, so that those of other code are never taken for its own."""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path

import discrete
import equilibrium
import homogenize
import pattern

# what of the packages shapes the answer of a cell
SOURCES = {
    discrete: ("*.py",),
    equilibrium: ("*.py",),
    pattern: (
        "arms.py", "kept_curvature.py", "lattice.py", "layout.py", "materials.py", "mesh.py", "normals.py", "planar.py",
        "rounding.py",
    ),
    homogenize: (
        "arm_segments.py", "blend.py", "cell.py", "directions.py", "free_points.py", "images.py", "isotropy.py",
        "natural.py", "objective.py", "periodic_delaunay.py", "relax.py", "relief.py", "rolled_membrane.py",
        "rolling.py", "sample.py", "stability.py", "star_torus.py", "torus.py", "torus_free.py", "unfolding.py",
    ),
}  # fmt: skip


@functools.cache
def code_version() -> str:
    """Hash of the sources; the same wherever the same code is installed."""
    known = hashlib.sha256()
    for package, names in SOURCES.items():
        folder = Path(package.__path__[0])
        for file in sorted(path for name in names for path in folder.glob(name)):
            known.update(f"{package.__name__}/{file.name}\n".encode())
            known.update(file.read_text(encoding="utf-8").encode())  # whatever ends its lines
    return known.hexdigest()[:16]
