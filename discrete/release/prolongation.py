"""A state of one mesh carried to another mesh of the same sheet."""

from __future__ import annotations

import numpy as np

from discrete.energies.elements import Array
from discrete.model.discrete_model import DiscreteModel
from discrete.model.state import State, edge_tangents, orthonormal_to_tangents
from discrete.release.surface_interpolation import interpolate_surface
from pattern.geometry.normals import vertex_normals


def prolong(coarse: DiscreteModel, state: State, fine: DiscreteModel) -> State:
    """The fine model's state closest to a smooth surface through the coarse one, its arms at their printed length.

    A piecewise linear surface has kinks that the fine hinges would have to undo; a C1 interpolation has none. It
    still shortens the arms where they bend, so the positions are put together again from its gradients, with every
    rod edge as long as printed.
    """
    return fit_to_surface(fine, _between(coarse, state, fine, smooth=True))


def fit_to_surface(model: DiscreteModel, surface: Array) -> State:
    """The state closest to places (V, 3) mm on a smooth surface, its pins held and its arms at their printed length."""
    held = model.constraints.held
    smooth = np.where(held, model.constraints.positions_at(model.pin_progress), surface)
    length = model.parts["rod_stretch"].params[:, 1:]
    positions = model.reconstruction.fit_edges(smooth, length * edge_tangents(smooth, model.edges))
    return State(positions, plastic_normals(model, positions))


def prolong_linearly(coarse: DiscreteModel, state: State, fine: DiscreteModel) -> State:
    """The fine model's state on the coarse triangles themselves: parts that were apart stay apart, about."""
    positions = _between(coarse, state, fine, smooth=False)
    return State(positions, plastic_normals(fine, positions))


def _between(coarse: DiscreteModel, state: State, fine: DiscreteModel, smooth: bool) -> Array:
    mesh = coarse.mesh
    places = interpolate_surface(mesh.points, mesh.triangles, state.positions, fine.mesh.points, smooth)
    return np.where(fine.constraints.held, fine.constraints.positions_at(fine.pin_progress), places)


def plastic_normals(model: DiscreteModel, positions: Array) -> Array:
    """(R, 3) mean normal of the sheet along every rod edge, orthogonal to it."""
    t = edge_tangents(positions, model.edges)
    d = vertex_normals(positions, model.mesh.triangles)[model.edges].sum(axis=1)
    return orthonormal_to_tangents(d, t)
