"""Extrapolation of a shape from two meshes: the sheet rotates on as it did from the first to the second.

Sheets with the paper's hinges change from mesh to mesh, mostly in the same direction.
"""

from __future__ import annotations

import numpy as np

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State, edge_tangents, rotate_vectors
from asterism.discrete.release.prolongation import plastic_normals
from asterism.equilibrium.arrays import Array
from asterism.pattern.geometry.rigid_fit import rigid_fit


def extrapolate(model: DiscreteModel, before: State, state: State, share: float) -> State:
    """Extrapolate from the state `before` beyond `state`, both on the mesh of the model.

    Every triangle and rod edge rotates on about the axis of its rotation between the two states, without stretch, as in
    a sheet that rolls up to a tube. Positions follow by least squares.

    Parameters
    ----------
    share : rotation beyond `state` over the rotation from `before` to `state`.
    """
    rotation, shift = rigid_fit(before.positions, state.positions)
    old = before.rotated(rotation, shift)
    (f0, _), (f1, e1) = (model.reconstruction.gradients(s.positions) for s in (old, state))
    spin = share * rotation_vectors(_spatial(f0), _spatial(f1))
    edge_spin = share * rotation_vectors(*(_frames(model, s) for s in (old, state)))
    columns = f1.transpose(0, 2, 1)
    change = (rotate_vectors(spin, columns) - columns).transpose(0, 2, 1)
    edge_change = rotate_vectors(edge_spin, e1[:, None])[:, 0] - e1
    positions = state.positions + model.reconstruction.displacements(change, edge_change)
    return model.with_fitted_frames(State(positions, plastic_normals(model, positions)))


def rotation_vectors(before: Array, after: Array) -> Array:
    """(E, 3) rad, vectors of the rotations in the polar decompositions of `after before^-1`, matrices (E, 3, 3).

    Examples
    --------
    >>> quarter = np.array([[[0, -1, 0], [1, 0, 0], [0, 0, 1.0]]])
    >>> (rotation_vectors(np.eye(3)[None], quarter) / np.pi).round(6) + 0.0
    array([[0. , 0. , 0.5]])
    """
    u, _, vt = np.linalg.svd(after @ np.linalg.inv(before))
    q = u @ vt
    skew = np.stack([q[:, 2, 1] - q[:, 1, 2], q[:, 0, 2] - q[:, 2, 0], q[:, 1, 0] - q[:, 0, 1]], axis=1)
    sine = 0.5 * np.linalg.norm(skew, axis=1)
    angle = np.arctan2(sine, 0.5 * (np.trace(q, axis1=1, axis2=2) - 1.0))
    # a rotation by pi has no axis in this formula and gives zero; no element rotates so far between two meshes
    return np.asarray((0.5 * angle / np.maximum(sine, 1e-12))[:, None] * skew)


def _spatial(f: Array) -> Array:
    """(T, 3, 3) deformation gradients (T, 3, 2) with the unit normal as third column."""
    normal = np.cross(f[:, :, 0], f[:, :, 1])
    return np.concatenate([f, (normal / np.linalg.norm(normal, axis=1, keepdims=True))[:, :, None]], axis=2)


def _frames(model: DiscreteModel, state: State) -> Array:
    """(R, 3, 3) tangent, director and their cross product of every rod edge, as columns."""
    t = edge_tangents(state.positions, model.edges)
    return np.stack([t, state.directors, np.cross(t, state.directors)], axis=2)
