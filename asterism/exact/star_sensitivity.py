"""Sensitivities of an exact shape: the change of its equilibrium for a small change of each star.

The mesh of a changed star is the one before, moved with the ends of its arms. The sheet first keeps its shape: its
vertices move along it as their places on the print do. The gradient that the energy then has drives the linear
response. Stars some lattice steps apart share no vertex, so that they are changed together.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.levels import model_on
from asterism.discrete.release.prolongation import fit_to_surface
from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.equilibrium.newton.minimise import is_definite_on_support
from asterism.equilibrium.threads import one_blas_thread
from asterism.pattern.design.design import Design
from asterism.pattern.design.stars import LENGTH, SIZE_KEYS, STAR_SIZES, SizeName
from asterism.pattern.geometry.normals import sum_at_vertices
from asterism.pattern.geometry.planar import triangle_areas
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import size_rows, stars_apart, with_painted_stars
from asterism.pattern.rods.graph import RodGraph
from asterism.shape.shape import Shape
from asterism.shape.surface import deformation_gradients, directed_edges

# lattice steps between stars of which one of `STAR_SIZES` is changed together: a length moves the mesh
COLOUR_STEPS = tuple(3 if size is LENGTH else 2 for size in STAR_SIZES)
# change of a size for the differences: of lengths in mm, of others relative to them
SIZE_STEP = 1e-4


class SaddleError(Error, ValueError):
    """An equilibrium is no minimum, and has no response."""


class StarResponse:
    """The linear response of an exact minimum to small changes of the sizes of its stars.

    Parameters
    ----------
    shape : exact shape of a design with S stars, a minimum.
    sizes : K of `length_mm`, `thickness_mm` and `width_mm`; those that the design rounds have no response.

    Raises
    ------
    SaddleError
        The shape is not a minimum.

    Examples
    --------
    The moves of a sheet of one star whose arms get 0.1 mm longer:

    >>> from asterism.exact.simulation import exact_shape
    >>> from asterism.pattern import gallery
    >>> shape = exact_shape(gallery.load("star"), edge_mm=4.0)
    >>> StarResponse(shape, "length_mm")(np.array([[0.1]])).shape == (len(shape.positions), 3, 1)
    True
    """

    @one_blas_thread()
    def __init__(self, shape: Shape, *sizes: SizeName) -> None:
        design = Design.from_dict(shape.summary["design"])
        model = model_on(design, layout(design), shape.summary["edge_mm"])
        state = solve_on_mesh(model, fit_to_surface(model, shape.positions)).state
        self._model, self._factor = model, model.factor()
        if not is_definite_on_support(model, state, model.hessian(state, 0.0), self._factor):
            raise SaddleError("sensitivities belong to a minimum")
        moved = _followed(model)
        self._forces = sp.hstack([_forces(model, state, size, moved) for size in sizes]).tocsr()

    def __call__(self, changes: Floats) -> Floats:
        """(V, 3, n) mm, moves of the vertices for changes (K S, n) of the sizes, mm: first all of the first size."""
        model, response = self._model, np.zeros((self._model.n_dofs, changes.shape[1]))
        response[model.free] = self._factor.solve(np.ascontiguousarray(-(self._forces @ changes)[model.free]))
        return response[: 3 * model.n_vertices].reshape(model.n_vertices, 3, -1)


def _forces(model: DiscreteModel, state: State, size: SizeName, moved: Callable[[Floats], Floats]) -> sp.coo_array:
    """(n_dofs, S) change of the energy's gradient per mm of one size of each star, at its vertices.

    `moved`: moves of all vertices of the mesh for those of the rods.
    """
    column, rounding = SIZE_KEYS.index(size), model.design.required_stars.rounding
    plan, known = model.layout, model.layout.star_sizes_mm[:, column]
    if rounding is not None and rounding.rounds(size):
        return sp.coo_array((model.n_dofs, len(known)))  # it stays as it is printed
    gradient, vertex = model.full_gradient(state), model.vertex_of_dofs
    steps = np.full(len(known), SIZE_STEP) * (1.0 if size == "length_mm" else known)
    # down, since longer arms may reach others, but not below what can be printed
    steps = np.where(known - steps < STAR_SIZES[column].limits[0], steps, -steps)
    parts = []
    for stars in stars_apart(plan, COLOUR_STEPS[column]):
        sizes = size_rows({size: known[stars] + steps[stars]})
        design = with_painted_stars(model.design, plan.sites[stars], sizes)
        changed = layout(design)
        moves = moved(_rod_moves(model, changed.graph))
        other = type(model)(design, changed, replace(model.mesh, points=model.mesh.points + moves))
        kept = model.moved_to(state, state.positions + _along_the_sheet(model, state.positions, moves))
        change = other.full_gradient(kept) - gradient
        touched = np.flatnonzero(change)
        owner = stars[cKDTree(plan.centres[stars]).query(model.mesh.points[vertex[touched]])[1]]
        parts.append((change[touched] / steps[owner], touched, owner))
    values, rows, columns = (np.concatenate(each) for each in zip(*parts, strict=True))
    return sp.coo_array((values, (rows, columns)), shape=(model.n_dofs, len(known)))


def _rod_moves(model: DiscreteModel, graph: RodGraph) -> Floats:
    """(V, 2) mm, moves of the vertices of rods that are as those of a graph; others stay."""
    mesh, moves = model.mesh, np.zeros_like(model.mesh.points)
    for path, before, after in zip(mesh.rods, model.layout.graph.rods, graph.rods, strict=True):
        if not np.array_equal(before.points, after.points):
            steps = np.linalg.norm(np.diff(mesh.points[path], axis=0), axis=1)
            part = np.concatenate([[0.0], np.cumsum(steps) / steps.sum()])
            moves[path] = after.at(after.points, part) - before.at(before.points, part)
    return moves


def _followed(model: DiscreteModel) -> Callable[[Floats], Floats]:
    """The moves of all vertices (V, 2) mm for those of rods: vertices around them within their star's cell follow."""
    mesh, pairs = model.mesh, directed_edges(model.mesh.triangles)
    cell = cKDTree(model.layout.centres).query(mesh.points)[1]
    known = np.asarray(model.constraints.held.any(axis=1))
    known[pairs[cell[pairs[:, 0]] != cell[pairs[:, 1]]]] = True
    known[np.concatenate([*mesh.rods, mesh.border_vertices, *mesh.hole_vertices])] = True
    joins = sp.coo_array((np.ones(len(pairs)), pairs.T), shape=(len(known), len(known))).tocsr()
    free = np.flatnonzero(~known)
    rows = sp.csgraph.laplacian(joins + joins.T).tocsr()[free]
    factor = splu(rows[:, free].tocsc())

    def moved(moves: Floats) -> Floats:
        moves[free] = factor.solve(-(rows @ moves))
        return moves

    return moved


def _along_the_sheet(model: DiscreteModel, positions: Floats, moves: Floats) -> Floats:
    """(V, 3) mm, by how much the vertices of a sheet move along it, if their printed places move by (V, 2) mm."""
    points, corners = model.mesh.points, model.mesh.triangles
    area = triangle_areas(points, corners).repeat(3)
    gradients = deformation_gradients(points, positions, corners).reshape(-1, 6).repeat(3, axis=0)
    # the mean at every vertex by the areas
    total = sum_at_vertices(corners, area[:, None] * gradients, len(points)).reshape(-1, 3, 2)
    mean = total / sum_at_vertices(corners, area, len(points))[:, None, None]
    return np.einsum("vij,vj->vi", mean, moves)
