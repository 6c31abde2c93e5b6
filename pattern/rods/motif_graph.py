"""The graph of one cell of a motif that repeats on a lattice: each rod once, with the cells to which it leads."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.rods import Rods
from asterism.pattern.design.sizing.profiles import Profile
from asterism.pattern.design.stars import ROD_SIZE_KEYS
from asterism.pattern.geometry.plane_lattice import PlaneLattice
from asterism.pattern.rods.curves import polyline
from asterism.pattern.rods.drawn_graph import PlacedLine, graph_of_lines
from asterism.pattern.rods.graph import Rod


@dataclass(frozen=True)
class MotifGraph:
    """Nodes and rods of one cell of a pattern that repeats without an end."""

    vectors: Floats  # (2, 2) mm, lattice vectors as rows
    nodes: Floats  # (N, 2) mm, one place of each node. The first rod starts at the first node.
    # one of each class of images. A rod runs from the node `start` to the image `end_image` of the node `end`.
    rods: tuple[Rod, ...]
    end_image: Ints  # (R, 2) numbers of lattice vectors

    @property
    def ends_at(self) -> Ints:
        """(N,) number of rod ends at each node."""
        ends = [end for rod in self.rods for end in (rod.start, rod.end)]
        return np.bincount(np.array(ends, dtype=np.int64), minlength=len(self.nodes))


def motif_graph(rods: Rods, lattice: Lattice) -> MotifGraph:
    """The graph of the motif of `[rods]` on a lattice. Lines of neighbouring copies cut each other, and bond.

    Raises `DesignError` if there is no motif, its sizes vary over the sheet, or it cannot be printed.

    A square grid has one node and two rods in its cell, which lead to the next cells:

    >>> grid = Rods.model_validate({"motif": [{"line_mm": [(0, 0), (10, 0)]}, {"line_mm": [(0, 0), (0, 10)]}]})
    >>> cell = motif_graph(grid, Lattice(kind="square", spacing_mm=10.0))
    >>> len(cell.nodes), cell.ends_at.tolist(), cell.end_image.tolist()
    (1, [4], [[1, 0], [0, 1]])
    """
    if not rods.motif:
        raise DesignError("rods.motif", "is missing: a unit cell repeats a motif")
    if rods.on_sheet:
        raise DesignError("rods", "must have a motif alone: lines that do not repeat have no unit cell")
    _check_equal(rods)
    copies = [
        PlacedLine(line, polyline(line, rods.curve_mm) + place, line.name or f"motif[{k}]", copy)
        for copy, place in enumerate(_places_nearby(rods, lattice))
        for k, line in enumerate(rods.motif)
    ]
    graph, pieces = graph_of_lines(copies, rods)
    own = [rod for rod, piece in zip(graph.rods, pieces, strict=True) if piece.line < len(rods.motif)]
    if not own:
        raise DesignError("rods.motif", "must have a line that is longer than half its width")
    # mm: places of a cell closer than this are one, but for rounding, whatever `join_mm` is
    return _folded(own, np.asarray(lattice.vectors), max(rods.join_mm, 1e-5))


def _places_nearby(rods: Rods, lattice: Lattice) -> Floats:
    """(n, 2) mm, shifts of the copies that touch the motif and of those that touch these; that of the motif first."""
    points = np.concatenate([polyline(line, rods.curve_mm) for line in rods.motif])
    reach = 2.0 * float(np.linalg.norm(np.ptp(points, axis=0))) + 4.0 * rods.join_mm
    vectors = np.asarray(lattice.vectors)
    # copies of a motif around the cell, beyond which a motif is too long for its lattice
    if np.pi * reach**2 > 2000 * abs(np.linalg.det(vectors)):
        raise DesignError("rods.motif", "is too long for its lattice: draw the lines of one cell")
    reach += float(np.linalg.norm(vectors, axis=1).max())
    lattice_at_0 = PlaneLattice(vectors, np.zeros(2))
    steps = lattice_at_0.cells_within(np.full(2, -reach), np.full(2, reach))
    places = lattice_at_0.place(steps[np.argsort(np.abs(steps).sum(axis=1), kind="stable")])
    return np.asarray(places[np.linalg.norm(places, axis=1) <= reach])


def _check_equal(rods: Rods) -> None:
    sizes = [("rods", rods), *((f"rods.motif[{k}]", line) for k, line in enumerate(rods.motif))]
    for place, section in sizes:
        for name in ROD_SIZE_KEYS:
            if isinstance(getattr(section, name), Profile):
                raise DesignError(f"{place}.{name}", "must be a number: all copies in a unit cell are equal")


def _folded(rods: list[Rod], vectors: Floats, join_mm: float) -> MotifGraph:
    """The rods with nodes of the cell, each moved so that it starts at the place of its node.

    Ends that are within `join_mm` of an image of another are at the same node, as on the sheet; they move there.
    """
    inverse = np.linalg.inv(vectors)
    nodes: list[Floats] = []

    def node_at(place: Floats) -> tuple[int, Ints]:
        """Number of the node at a place, and its image there."""
        for number, known in enumerate(nodes):
            image = np.rint((place - known) @ inverse).astype(np.int64)
            if np.linalg.norm(place - known - image @ vectors) <= join_mm:
                return number, image
        nodes.append(place)
        return len(nodes) - 1, np.zeros(2, dtype=np.int64)

    folded, end_image = [], []
    for rod in rods:
        start, image = node_at(rod.points[0])
        end, far = node_at(rod.points[-1])
        points = rod.points - image @ vectors
        points[0], points[-1] = nodes[start], nodes[end] + (far - image) @ vectors
        folded.append(replace(rod, points=points, start=start, end=end, group=-1))
        end_image.append(far - image)
    return MotifGraph(vectors, np.array(nodes), tuple(folded), np.array(end_image, dtype=np.int64))
