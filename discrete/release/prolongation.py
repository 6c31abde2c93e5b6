"""A state of one mesh carried to another mesh of the same sheet."""

from __future__ import annotations

import numpy as np

from discrete.energies.elements import Array
from discrete.model.model import Model
from discrete.model.state import State, across, tangents
from discrete.release.between_vertices import between_vertices
from pattern.geometry.normals import vertex_normals


def prolonged(coarse: Model, state: State, fine: Model) -> State:
    """The fine model's state closest to a smooth surface through the coarse one, its arms at their printed length.

    A piecewise linear surface has kinks that the fine hinges would have to undo; a C1 interpolation has none. It
    still shortens the arms where they bend, so the positions are put together again from its gradients, with every
    rod edge as long as printed.
    """
    return fitted(fine, _between(coarse, state, fine, smooth=True))


def fitted(model: Model, surface: Array) -> State:
    """The state closest to places (V, 3) mm on a smooth surface, its pins held and its arms at their printed length."""
    held = model.constraints.held
    smooth = np.where(held, model.constraints.places(model.progress), surface)
    length = model.parts["rod_stretch"].params[:, 1:]
    positions = model.reconstruction.fitted(smooth, length * tangents(smooth, model.edges))
    return State(positions, plastic_normals(model, positions))


def flatly_prolonged(coarse: Model, state: State, fine: Model) -> State:
    """The fine model's state on the coarse triangles themselves: parts that were apart stay apart, about."""
    positions = _between(coarse, state, fine, smooth=False)
    return State(positions, plastic_normals(fine, positions))


def _between(coarse: Model, state: State, fine: Model, smooth: bool) -> Array:
    mesh = coarse.mesh
    places = between_vertices(mesh.points, mesh.triangles, state.positions, fine.mesh.points, smooth)
    return np.where(fine.constraints.held, fine.constraints.places(fine.progress), places)


def plastic_normals(model: Model, positions: Array) -> Array:
    """(R, 3) mean normal of the sheet along every rod edge, orthogonal to it."""
    t = tangents(positions, model.edges)
    d = vertex_normals(positions, model.mesh.triangles)[model.edges].sum(axis=1)
    return across(d, t)
