"""A state of one mesh carried to another mesh of the same sheet."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.interpolate import CloughTocher2DInterpolator, LinearNDInterpolator, NearestNDInterpolator

from discrete.elements import Array
from discrete.model import Model
from discrete.state import State, tangents
from pattern.normals import vertex_normals


def prolonged(coarse: Model, state: State, fine: Model) -> State:
    """The fine model's state closest to a smooth surface through the coarse one, its arms at their printed length.

    A piecewise linear surface has kinks that the fine hinges would have to undo; a C1 interpolation has none. It
    still shortens the arms where they bend, so the positions are put together again from its gradients, with every
    rod edge as long as printed.
    """
    return fitted(fine, _interpolated(coarse, state, fine, CloughTocher2DInterpolator))


def fitted(model: Model, surface: Array) -> State:
    """The state closest to places (V, 3) mm on a smooth surface, its pins held and its arms at their printed length."""
    held = model.constraints.held
    smooth = np.where(held, model.constraints.places(model.release), surface)
    length = model.parts["rod_stretch"].params[:, 1:]
    positions = model.reconstruction.fitted(smooth, length * tangents(smooth, model.edges))
    return State(positions, plastic_normals(model, positions))


def flatly_prolonged(coarse: Model, state: State, fine: Model) -> State:
    """The fine model's state on the coarse triangles themselves: parts that were apart stay apart, about."""
    positions = _interpolated(coarse, state, fine, LinearNDInterpolator)
    return State(positions, plastic_normals(fine, positions))


def _interpolated(coarse: Model, state: State, fine: Model, interpolator: Any) -> Array:
    points = fine.mesh.points
    smooth = interpolator(coarse.mesh.points, state.positions, rescale=True)(points)
    outside = np.isnan(smooth).any(axis=1)
    if outside.any():
        nearest = NearestNDInterpolator(coarse.mesh.points, state.positions - _lifted(coarse.mesh.points))
        smooth[outside] = nearest(points[outside]) + _lifted(points[outside])
    held = fine.constraints.held
    return np.where(held, fine.constraints.places(fine.release), smooth)


def _lifted(points: Array) -> Array:
    return np.column_stack([points, np.zeros(len(points))])


def plastic_normals(model: Model, positions: Array) -> Array:
    """(R, 3) mean normal of the sheet along every rod edge, orthogonal to it."""
    t = tangents(positions, model.edges)
    d = vertex_normals(positions, model.mesh.triangles)[model.edges].sum(axis=1)
    d -= (d * t).sum(axis=1, keepdims=True) * t
    return d / np.linalg.norm(d, axis=1, keepdims=True)
