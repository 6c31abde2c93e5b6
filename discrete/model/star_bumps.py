"""Which way every star bumps."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from discrete.energies.elements import Array
from discrete.model.discrete_model import DiscreteModel
from discrete.model.state import State, moved_state
from pattern.geometry.normals import vertex_normals


def bump_heights(model: DiscreteModel, state: State) -> Array:
    """(S,) mm, height of each star's centre over the mean of its tips, along its plastic normal; 0 without arms.

    Positive: the star bumps to the plastic side (up).
    """
    mesh, stars = model.mesh, model.layout.arm_star
    n_stars = len(model.layout.centres)
    tips = np.zeros((n_stars, 3))
    np.add.at(tips, stars, state.positions[[rod[-1] for rod in mesh.rods]])
    arms = np.bincount(stars, minlength=n_stars)[:, None]
    centre = state.positions[mesh.star_vertices]
    drop = np.where(arms > 0, centre - tips / np.maximum(arms, 1), 0.0)
    return np.asarray((drop * star_normals(model, state)).sum(axis=1))


def star_normals(model: DiscreteModel, state: State) -> Array:
    """(S, 3) mean plastic normal of every star's arms, of unit length; zero without arms."""
    normal = np.zeros((len(model.layout.centres), 3))
    np.add.at(normal, model.layout.arm_star[model.network.rod], state.directors)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return normal / np.where(length > 0.0, length, 1.0)


def add_bumps(model: DiscreteModel, state: State, heights: Array) -> State:
    """The state with a smooth bump at every star, `heights` (S,) mm to the plastic side; 0 leaves a star alone.

    Held components stay where they are.
    """
    chosen = np.flatnonzero(heights)
    if len(chosen) == 0:
        return state
    distance, nearest = cKDTree(model.layout.centres[chosen]).query(model.mesh.points)
    lift = heights[chosen][nearest] * np.exp(-((distance / (0.35 * model.spacing)) ** 2))
    positions = state.positions + lift[:, None] * vertex_normals(state.positions, model.mesh.triangles)
    positions = np.where(model.constraints.held, state.positions, positions)
    return moved_state(state, model.edges, positions, np.zeros(len(model.edges)))
