"""The models of one sheet from coarse to fine, each made when the search reaches it."""

from __future__ import annotations

from contextlib import suppress
from math import sqrt

import numpy as np

from asterism.discrete.model.contact_model import ContactModel
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.meshing import mesh_layout

# the coarsest mesh of a search to a tolerance: edges between two adjacent stars, and vertices of a small sheet
COARSEST_EDGES_PER_SPACING = 5
LEAST_VERTICES = 300
# 1: edges of a mesh over those of the next finer one
EDGE_RATIO = sqrt(2.0)
# a search to a tolerance makes no mesh of more vertices, but for a second one
MAX_VERTICES = 25_000
# edges between two adjacent stars on its finest mesh, for a tolerance of 1 % and more; all but the softest sheets are
# within it on coarser ones
FINEST_EDGES_PER_SPACING = 14.5
# the shortest edge of a design
MIN_EDGE_MM = 0.2
# meshes in a row that the search passes over because their edges are too long for the rods
MAX_PASSED_OVER = 6
# a search to a given edge: vertices of the coarsest mesh, about, and edges between two adjacent stars on it
COARSE_VERTICES = 1100
MIN_EDGES_PER_SPACING = 4.0
# 1: vertices of a level over those of the level before; large changes of a soft shape are slow
MAX_VERTEX_RATIO = 3.0
# 1: vertices of a coarse mesh over those of the finest, if it is worth its time
MAX_COARSE_VERTEX_FRACTION = 0.6


def model_on(design: Design, layout: Layout, edge_mm: float) -> DiscreteModel:
    """The model of a design on one mesh; with contact if the design asks for it.

    Raises
    ------
    MeshError
        No mesh of this edge follows the rods.
    """
    mesh = mesh_layout(layout, edge_mm, design.mesh.kind, design.mesh.seed, design.graded_meshes)
    return (ContactModel if design.solver.contact else DiscreteModel)(design, layout, mesh)


class Ladder:
    """The models of a sheet from coarse to fine.

    With a tolerance there is always a finer one, up to `MAX_VERTICES`; the search ends where its estimated error is
    within the tolerance. With a given edge the last mesh has this edge.

    Parameters
    ----------
    design, layout : the sheet.
    edge_mm : edge of a single mesh; by default the search has coarser ones, as the design says.

    Attributes
    ----------
    tolerance_percent : of the diameter; None if the edge is given.

    Examples
    --------
    >>> from asterism.pattern import gallery
    >>> from asterism.pattern.layout.build import layout
    >>> design = gallery.load("star")
    >>> [model.n_vertices for model in Ladder(design, layout(design), edge_mm=4.0).models]
    [37]
    """

    def __init__(self, design: Design, layout: Layout, edge_mm: float | None = None) -> None:
        self.design, self.layout, self._single = design, layout, edge_mm
        self.tolerance_percent = None if edge_mm or design.mesh_edge_mm else design.mesh.tolerance_percent
        self._models: list[DiscreteModel] = []
        self._edges: list[float] = []
        self._next = 0.0

    @property
    def models(self) -> list[DiscreteModel]:
        """From coarse to fine, those made so far; the first use makes the coarsest one, or all if the edge is given."""
        if not self._models:
            given = self._single or self.design.mesh_edge_mm
            if given is None:
                self._next = self._coarsest_edge()
                self._add_finer()
            else:
                self._add_down_to(given)
        return self._models

    @property
    def edges(self) -> list[float]:
        """mm, of the meshes of the models."""
        return self._edges if self.models else []

    def finer_than(self, number: int) -> bool:
        """Whether there is a model after the one of this number; with a tolerance it is made now."""
        if number + 1 < len(self.models):
            return True
        if self.tolerance_percent is None:
            return False
        enough = EDGE_RATIO**2 * self.models[-1].n_vertices > MAX_VERTICES or self._next < self._finest_edge()
        return not (enough and number > 0) and self._add_finer()

    def _coarsest_edge(self) -> float:
        """The edge of the coarsest mesh, mm."""
        of_small_sheet = sqrt(abs(polygon_area(self.layout.outline)) / (sqrt(0.75) * LEAST_VERTICES))
        return float(max(min(self.layout.spacing_mm / COARSEST_EDGES_PER_SPACING, of_small_sheet), MIN_EDGE_MM))

    def _finest_edge(self) -> float:
        """The edge of the finest mesh, mm: errors are about proportional to the edge to the power of 3/2."""
        assert self.tolerance_percent is not None, "the search is to a tolerance"
        return float(
            self.layout.spacing_mm / FINEST_EDGES_PER_SPACING * min(self.tolerance_percent, 1.0) ** (2.0 / 3.0)
        )

    def _add_finer(self) -> bool:
        """Add the next finer model; a mesh whose edges are too long for the rods is passed over."""
        problem: MeshError | None = None
        for _ in range(MAX_PASSED_OVER):
            if self._next < MIN_EDGE_MM:
                break
            edge, self._next = self._next, self._next / EDGE_RATIO
            try:
                self._add(edge)
                return True
            except MeshError as error:
                problem = error
        if problem is not None and not self._models:
            raise problem
        return False

    def _add_down_to(self, edge: float) -> None:
        finest = model_on(self.design, self.layout, edge)
        for coarse in () if self._single else coarser_edges(finest, edge):
            with suppress(MeshError):  # arms too short for this mesh: the search starts on a finer one
                self._add(coarse, MAX_COARSE_VERTEX_FRACTION * finest.n_vertices)
        self._models.append(finest)
        self._edges.append(edge)

    def _add(self, edge: float, most: float = np.inf) -> None:
        model = model_on(self.design, self.layout, edge)
        if model.n_vertices < most:
            self._models.append(model)
            self._edges.append(edge)


def coarser_edges(finest: DiscreteModel, edge_mm: float) -> list[float]:
    """mm, edges of the coarser meshes of a search that ends on a given mesh, the longest first."""
    ratio = finest.n_vertices / COARSE_VERTICES
    # designs of many stars need more than COARSE_VERTICES
    growth = min(np.sqrt(ratio), finest.spacing / MIN_EDGES_PER_SPACING / edge_mm)
    steps = int(np.ceil(2.0 * np.log(growth) / np.log(MAX_VERTEX_RATIO))) if ratio > 2.0 and growth > 1.0 else 0
    return [edge_mm * growth ** (step / steps) for step in range(steps, 0, -1)]
