"""The mesh of a shown sheet as a message."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.planar import is_in_sorted
from asterism.studio.messages import ShownMesh


def mesh_message(number: int, printed: Floats, triangles: Ints, arm_site: Ints, is_fine: bool) -> ShownMesh:
    """The message with a mesh: points (V, 2) mm, triangles (T, 3), and the row of the site of each ribbon (A,)."""
    return ShownMesh(
        mesh=number,
        printed=printed.astype(np.float32),
        triangles=triangles.astype(np.uint32),
        outline=outline_of(triangles).astype(np.uint32),
        arm_site=arm_site.astype(np.uint32),
        is_fine=is_fine,
    )


def outline_of(triangles: Ints) -> Ints:
    """(R,) vertices around a sheet of triangles (T, 3), counterclockwise.

    Examples
    --------
    >>> outline_of(np.array([[0, 1, 2], [0, 2, 3]])).tolist()
    [0, 1, 2, 3]
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    size = int(edges.max()) + 1
    there: Ints = edges[:, 0] * size + edges[:, 1]
    back: Ints = edges[:, 1] * size + edges[:, 0]
    rim = edges[~is_in_sorted(there, np.sort(back))]
    following = dict(rim.tolist())
    ring = [min(following)]
    while (after := following[ring[-1]]) != ring[0] and len(ring) < len(following):
        ring.append(after)
    return np.array(ring)
