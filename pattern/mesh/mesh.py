"""A triangle mesh of the printed sheet whose edges follow every arm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int


@dataclass(frozen=True)
class Mesh:
    """Triangles of the sheet and the paths of the arms on it, in print coordinates (mm).

    Attributes
    ----------
    points : (V, 2) mm, every one used by a triangle.
    triangles : (T, 3) counterclockwise.
    rods : one array a rod (in the order of the layout's graph): vertices from its start, of an arm the star's centre,
        to its end; consecutive ones are edges of triangles.
    star_vertices : (S,) the vertex at each star's centre.
    border_vertices : (n,) vertices on the outline, counterclockwise.
    pin_vertices : one array a pin set of the layout. For points: in their order. For edges: every mesh vertex on them.
    kind : "aligned" or "delaunay".
    hole_vertices : for each hole of the layout the vertices on its edge, in their order.
    """

    points: Float[np.ndarray, "V 2"]
    triangles: Int[np.ndarray, "T 3"]
    rods: tuple[Int[np.ndarray, " _"], ...]
    star_vertices: Int[np.ndarray, " S"]
    border_vertices: Int[np.ndarray, " n"]
    pin_vertices: tuple[Int[np.ndarray, " _"], ...]
    kind: str
    hole_vertices: tuple[Int[np.ndarray, " _"], ...] = ()
