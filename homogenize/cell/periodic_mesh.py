"""A periodic triangle mesh of a unit cell, unfolded to the points that its elements use."""

from __future__ import annotations

from dataclasses import dataclass

from pattern.geometry.arrays import Floats, Ints

# of the spacing, closer than which the ends of arms are one point
TOUCHING_TOLERANCE = 1e-6


@dataclass(frozen=True)
class PeriodicMesh:
    """A periodic mesh, unfolded: points that elements use, each an image of a base point.

    Attributes
    ----------
    points : (U, 2) mm, print coordinates of the unfolded points; the first `n_base` are the base points.
    base : (U,) the base point of each.
    image : (U, 2) how many cell vectors A1 and A2 lie between them.
    triangles : (T, 3) counterclockwise, one of each class of images.
    around : (R, 3) the images of triangles that share an edge with those.
    hinges : (H, 4) edge, left apex and right apex, one of each class.
    rods : vertex paths of the arms from the star's centre, each star in one piece.
    star_vertices : (S,).
    cell_vectors : (2, 2) mm, rows.
    """

    points: Floats
    base: Ints
    image: Ints
    triangles: Ints
    around: Ints
    hinges: Ints
    rods: tuple[Ints, ...]
    arm_star: Ints
    star_vertices: Ints
    cell_vectors: Floats
    n_base: int

    @property
    def area(self) -> float:
        """mm^2, of the printed cell."""
        (a, b), (c, d) = self.cell_vectors
        return float(abs(a * d - b * c))
