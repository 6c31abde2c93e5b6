"""Prolongation of a state from one mesh to another mesh of the same sheet, and extrapolation from two meshes."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CloughTocher2DInterpolator, LinearNDInterpolator, NearestNDInterpolator
from scipy.spatial import ConvexHull

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State, edge_tangents, orthonormal_to_tangents, rotate_vectors
from asterism.equilibrium.arrays import Array, Ints
from asterism.pattern.geometry.normals import vertex_normals
from asterism.pattern.geometry.planar import distance_to_segment, triangle_areas
from asterism.pattern.geometry.rigid_fit import rigid_fit


def prolong(coarse: DiscreteModel, state: State, fine: DiscreteModel) -> State:
    """The state of the fine model closest to a C1 surface through the coarse state, its arms at their printed length.

    A piecewise linear surface would have kinks and a high bending energy on the fine mesh; a C1 surface has none. Its
    chords shorten bent arms, so positions are reconstructed from its gradients with rod edges of the printed length.
    """
    return fit_to_surface(fine, _interpolated(coarse, state, fine, smooth=True))


def fit_to_surface(model: DiscreteModel, surface: Array) -> State:
    """The state closest to points (V, 3) mm of a surface, with held components in place and arms at full length."""
    held = model.constraints.held
    smooth = np.where(held, model.constraints.positions_at(model.pin_progress), surface)
    length = model.parts["rod_stretch"].params[:, 1:]
    move = model.reconstruction.fit_edges(smooth, length * edge_tangents(smooth, model.edges)) - smooth
    # an arm that ends beside a support does not pass it
    most = 0.25 * model.layout.distance_to_supports(model.mesh.points)
    positions = smooth + move * np.minimum(most / np.maximum(np.linalg.norm(move, axis=1), 1e-12), 1.0)[:, None]
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


def interpolate_surface(printed: Array, triangles: Ints, positions: Array, points: Array, smooth: bool) -> Array:
    """Position of printed points on a sheet that is given at the vertices of its mesh.

    It returns (n, 3) mm. Beyond the border the nearest vertex or triangle continues.

    The interpolators of scipy triangulate the points anew and would interpolate across a notch. Sheets that are not
    convex use those of matplotlib, on the triangles of the sheet.

    Parameters
    ----------
    printed, positions : (V, 2) and (V, 3) mm, of the vertices.
    triangles : (T, 3) vertices.
    points : (n, 2) mm, printed points.
    smooth : C1 cubics (Clough and Tocher) with gradients of least bending; otherwise linear on triangles.

    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    >>> tilted = np.column_stack([square, square[:, 0]])
    >>> interpolate_surface(square, np.array([[0, 1, 2], [0, 2, 3]]), tilted, np.array([[0.5, 0.2]]), False).round(6)
    array([[0.5, 0.2, 0.5]])
    """
    area = np.abs(triangle_areas(printed, triangles)).sum()
    # a sheet is convex if it fills its hull but for this
    if area > (1.0 - 1e-6) * ConvexHull(printed).volume:
        interpolator = CloughTocher2DInterpolator if smooth else LinearNDInterpolator
        out = interpolator(printed, positions, rescale=True)(points)
        outside = np.isnan(out).any(axis=1)
        if outside.any():  # they get the displacement of the nearest vertex
            nearest = NearestNDInterpolator(printed, positions - _in_space(printed))
            out[outside] = nearest(points[outside]) + _in_space(points[outside])
        return np.asarray(out)
    return _on_triangles(printed, triangles, positions, points, smooth)


def _on_triangles(printed: Array, triangles: Ints, positions: Array, points: Array, smooth: bool) -> Array:
    from matplotlib.tri import CubicTriInterpolator, LinearTriInterpolator, Triangulation  # slow to load

    mesh = Triangulation(printed[:, 0], printed[:, 1], triangles)
    finder = mesh.get_trifinder()
    out = np.empty((len(points), 3))
    for axis, values in enumerate(positions.T):
        within = (CubicTriInterpolator if smooth else LinearTriInterpolator)(mesh, values, trifinder=finder)
        out[:, axis] = np.ma.filled(within(*points.T), np.nan)
    outside = np.flatnonzero(np.isnan(out).any(axis=1))
    if len(outside):  # the nearest border triangle continues linearly
        triangle, side = np.nonzero(mesh.neighbors == -1)
        ends = [printed[triangles[triangle, (side + k) % 3]] for k in (0, 1)]
        corners = triangles[triangle[distance_to_segment(points[outside, None], *ends).argmin(axis=1)]]
        origin, sides = printed[corners[:, 0]], printed[corners[:, 1:]] - printed[corners[:, :1]]
        part = np.linalg.solve(np.swapaxes(sides, 1, 2), (points[outside] - origin)[..., None])
        edges = positions[corners[:, 1:]] - positions[corners[:, :1]]
        out[outside] = positions[corners[:, 0]] + (part * edges).sum(axis=1)
    return out


def _in_space(points: Array) -> Array:
    return np.column_stack([points, np.zeros(len(points))])


def extrapolate(model: DiscreteModel, before: State, state: State, share: float) -> State:
    """Extrapolate from the state `before` beyond `state`, both on the mesh of the model.

    Sheets with the paper's hinges change from mesh to mesh, mostly in the same direction. Every triangle and rod edge
    rotates on about the axis of its rotation between the two states, without stretch, as in a sheet that rolls up to a
    tube. Positions follow by least squares.
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
