"""The mesh of the unit cell of a motif: points on its rods, free ones around them, closed to a torus."""

from __future__ import annotations

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.homogenize.cell.conforming_triangulation import IDENTITY, MeshConstraints, conforming_triangulation
from asterism.homogenize.cell.free_cell_mesh import graded_steps
from asterism.homogenize.cell.periodic_mesh import MeshPath, PeriodicMesh, Tiles
from asterism.pattern.design.errors import MeshError
from asterism.pattern.mesh.outline_points import least_pieces
from asterism.pattern.rods.motif_graph import MotifGraph

# edges of a mesh on the shorter lattice vector, at least
MIN_EDGES_A_CELL = 3
# places along a rod, for the distance to other rods
_FINE = 128
# lines that are nearer to each other than this touch
TOUCH_MM = 1e-6


def motif_cell_mesh(
    motif: MotifGraph, edge_mm: float, repeat: tuple[int, int] = (1, 1), surrounded: bool = False
) -> PeriodicMesh:
    """Mesh of `repeat` cells: the mesh of one cell, repeated. Its first vertex is the first node of the motif.

    The mesh lies in the same way to the motif wherever the motif lies to the lattice.

    Parameters
    ----------
    edge_mm : about, of the mesh; edges are shorter where rods come close, and where they curve.
    surrounded : the mesh includes the triangles around, whose points are then unfolded too.

    Raises
    ------
    MeshError
        See `conforming_triangulation`.
    """
    vectors = motif.vectors
    edge_mm = min(edge_mm, float(np.linalg.norm(vectors, axis=1).min()) / MIN_EDGES_A_CELL)
    constraints, paths = _constraints(motif, edge_mm)
    return Tiles(conforming_triangulation(constraints, edge_mm), repeat).mesh(paths, surrounded, of_stars=False)


def _constraints(motif: MotifGraph, edge_mm: float) -> tuple[MeshConstraints, list[MeshPath]]:
    """Points on the rods, nodes first, as places from the first node; and the paths of the rods over them."""
    inverse, origin = np.linalg.inv(motif.vectors), motif.nodes[0]

    def cell_of(places: Floats) -> Ints:
        return np.floor(places @ inverse + 1e-9).astype(np.int64)

    node_cell = cell_of(motif.nodes - origin)
    points = [motif.nodes - origin - node_cell @ motif.vectors]
    sizes = np.full(len(motif.nodes), edge_mm)
    inner_sizes: list[Floats] = []
    paths: list[MeshPath] = []
    count = len(motif.nodes)
    for number, rod in enumerate(motif.rods):
        along = _stations(motif, number, edge_mm)
        step = np.diff(along)
        places = rod.at(rod.points, along[1:-1] / rod.length) - origin
        cells = cell_of(places)
        own = count + np.arange(len(places))
        count += len(places)
        points.append(places - cells @ motif.vectors)
        inner_sizes.append(np.minimum(step[:-1], step[1:]))
        for node, first in ((rod.start, step[0]), (rod.end, step[-1])):
            sizes[node] = min(sizes[node], first)
        ends = node_cell[rod.start], motif.end_image[number] + node_cell[rod.end]
        paths.append(MeshPath(np.array([rod.start, *own, rod.end]), np.vstack([ends[0], cells, ends[1]])))
    a, b = (np.concatenate([path.point[part] for path in paths]) for part in (slice(None, -1), slice(1, None)))
    steps = np.concatenate([np.diff(path.image, axis=0) for path in paths])
    walls, size = np.empty((0, 2)), np.concatenate([sizes, *inner_sizes])
    return MeshConstraints(motif.vectors, np.concatenate(points), size, a, b, steps, IDENTITY, walls, walls), paths


def _stations(motif: MotifGraph, number: int, edge_mm: float) -> Floats:
    """(n + 1,) mm along a rod: even steps, shorter ones where rods come close that do not meet it."""
    rod = motif.rods[number]
    least = 1.0 if rod.length < 0.5 * edge_mm else least_pieces(rod)
    longest = rod.length / max(round(rod.length / edge_mm), least)
    along = np.linspace(0.0, rod.length, _FINE + 1)
    gap = np.full(len(along), np.inf)
    places = shapely.points(rod.at(rod.points, along / rod.length))
    for other in _images_beside(motif, number):
        gap = np.minimum(gap, shapely.distance(places, shapely.LineString(other)))
    if gap.min() < TOUCH_MM:
        x, y = rod.at(rod.points, along[gap.argmin() : gap.argmin() + 1] / rod.length)[0]
        raise MeshError(
            f"two lines touch at ({x:.3g}, {y:.3g}) mm: move the end of one away, or to an end of the other"
        )
    return graded_steps(along, longest, gap)


def _images_beside(motif: MotifGraph, number: int) -> list[Floats]:
    """Points (n, 2) of the rods around a rod that have no node in common with it."""
    own = _nodes_of(motif, number, np.zeros(2, dtype=np.int64))
    reach = max(float(np.linalg.norm(np.ptp(rod.points, axis=0))) for rod in motif.rods)
    height = 1.0 / np.linalg.norm(np.linalg.inv(motif.vectors), axis=0).max()  # of the cell
    span = np.arange(-1, 2) if reach <= height else np.arange(-(n := int(np.ceil(2.0 * reach / height))), n + 1)
    around = np.stack(np.meshgrid(span, span, indexing="ij"), axis=-1).reshape(-1, 2)
    return [
        other.points + shift @ motif.vectors
        for which, other in enumerate(motif.rods)
        for shift in around
        if not own & _nodes_of(motif, which, shift)
    ]


def _nodes_of(motif: MotifGraph, number: int, shift: Ints) -> set[tuple[int, int, int]]:
    """The nodes of an image of a rod, each with its cell."""
    rod, end = motif.rods[number], shift + motif.end_image[number]
    return {(rod.start, int(shift[0]), int(shift[1])), (rod.end, int(end[0]), int(end[1]))}
