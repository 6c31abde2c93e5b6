"""Prolongation of a state from one mesh to another mesh of the same sheet."""

from __future__ import annotations

import numpy as np

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State, edge_tangents, orthonormal_to_tangents
from asterism.discrete.release.surface_interpolation import interpolate_surface
from asterism.equilibrium.arrays import Array
from asterism.pattern.geometry.normals import vertex_normals


def prolong(coarse: DiscreteModel, state: State, fine: DiscreteModel) -> State:
    """The state of the fine model closest to a C1 surface through the coarse state, its arms at their printed length.

    A piecewise linear surface would have kinks and a high bending energy on the fine mesh; a C1 surface has none. Its
    chords shorten bent arms, so positions are reconstructed from its gradients with rod edges of the printed length.
    """
    return fit_to_surface(fine, _interpolated(coarse, state, fine, smooth=True))


def fit_to_surface(model: DiscreteModel, surface: Array) -> State:
    """The state closest to points (V, 3) mm of a smooth surface, with held components in place and arms at full length.

    Parameters
    ----------
    surface : (V, 3) mm, point of the surface for every vertex.
    """
    held = model.constraints.held
    smooth = np.where(held, model.constraints.positions_at(model.pin_progress), surface)
    length = model.parts["rod_stretch"].params[:, 1:]
    positions = model.reconstruction.fit_edges(smooth, length * edge_tangents(smooth, model.edges))
    return model.with_fitted_frames(State(positions, plastic_normals(model, positions)))


def prolong_linearly(coarse: DiscreteModel, state: State, fine: DiscreteModel) -> State:
    """The state of the fine model on the triangles of the coarse state, with nearly the same distances of its parts."""
    positions = _interpolated(coarse, state, fine, smooth=False)
    return fine.with_fitted_frames(State(positions, plastic_normals(fine, positions)))


def _interpolated(coarse: DiscreteModel, state: State, fine: DiscreteModel, smooth: bool) -> Array:
    """(V, 3) mm, the coarse state at the vertices of the fine mesh, with held components in place."""
    mesh = coarse.mesh
    positions = interpolate_surface(mesh.points, mesh.triangles, state.positions, fine.mesh.points, smooth)
    return np.where(fine.constraints.held, fine.constraints.positions_at(fine.pin_progress), positions)


def plastic_normals(model: DiscreteModel, positions: Array) -> Array:
    """(R, 3) unit normals of the sheet at every rod edge, orthogonal to the edge: the directors of `positions`."""
    t = edge_tangents(positions, model.edges)
    d = vertex_normals(positions, model.mesh.triangles)[model.edges].sum(axis=1)
    return orthonormal_to_tangents(d, t)
