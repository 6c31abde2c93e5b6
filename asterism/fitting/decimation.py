"""Fewer triangles for a large target, with the distance by which the surface moves."""

from __future__ import annotations

import numpy as np

from asterism.fitting.disk import Disk, disk_of
from asterism.fitting.errors import TargetError
from asterism.measure.compare.nearest import NearestOnSurface

# a fit uses the target over cells of some mm; 20 000 triangles resolve a target of 4 m to some hundredths of a cell
MAX_TARGET_TRIANGLES = 20_000
# vertices whose distance from the decimated surface is measured
MAX_MEASURED_VERTICES = 20_000


def decimated(disk: Disk, name: str) -> tuple[Disk, str]:
    """A disk of at most `MAX_TARGET_TRIANGLES` triangles, and a note about it; a smaller one as it is, without a note.

    Edges are collapsed in the order of their quadric errors (Garland and Heckbert 1997), by fast-simplification.

    Raises
    ------
    TargetError
        The surface loses its form, because its triangles differ too much.
    """
    if len(disk.triangles) <= MAX_TARGET_TRIANGLES:
        return disk, ""
    from fast_simplification import simplify  # rarely used

    before = len(disk.triangles)
    vertices, triangles = simplify(
        disk.vertices, disk.triangles.astype(np.int32), target_count=MAX_TARGET_TRIANGLES
    )  # fmt: skip
    try:
        smaller = disk_of(np.asarray(vertices, dtype=float), np.asarray(triangles, dtype=np.int64), name)
    except TargetError:
        raise TargetError(name, f"has {before} triangles and cannot be decimated: simplify it") from None
    some = disk.vertices[:: max(len(disk.vertices) // MAX_MEASURED_VERTICES, 1)]
    moved = np.abs(NearestOnSurface(smaller.vertices, smaller.triangles)(some).distance).max()
    after = len(smaller.triangles)
    return smaller, f"{before} triangles are decimated to {after}, which moves the surface by at most {moved:.2g} mm"
