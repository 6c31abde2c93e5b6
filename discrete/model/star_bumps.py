"""The bumps of the stars: their heights, and states with prescribed bumps."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array
from asterism.pattern.geometry.normals import vertex_normals

BUMP_RADIUS_FRACTION = 0.35  # 1: radius at which a Gaussian bump falls to 1/e, over the spacing of the stars


def bump_heights(model: DiscreteModel, state: State) -> Array:
    """(S,) mm, height of each star's centre above the mean of its tips, to its plastic's side; 0 without arms."""
    mesh, stars = model.mesh, model.layout.arm_star
    n_stars = len(model.layout.centres)
    tips = np.zeros((n_stars, 3))
    np.add.at(tips, stars, state.positions[[rod[-1] for rod in mesh.rods[: len(stars)]]])
    arms = np.bincount(stars, minlength=n_stars)[:, None]
    centre = state.positions[mesh.star_vertices]
    above_tips = np.where(arms > 0, centre - tips / np.maximum(arms, 1), 0.0)
    return np.asarray(model.layout.star_side * (above_tips * star_normals(model, state)).sum(axis=1))


def star_normals(model: DiscreteModel, state: State) -> Array:
    """(S, 3) unit vectors along the mean normal of each star's arms, up in print; zero without arms."""
    normal = np.zeros((len(model.layout.centres), 3))
    arms = model.network.rod < len(model.layout.arm_star)  # all rods, but those of a drawing
    np.add.at(normal, model.layout.arm_star[model.network.rod[arms]], state.directors[arms])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return normal / np.where(length > 0.0, length, 1.0)


def add_bumps(model: DiscreteModel, state: State, heights: Array) -> State:
    """The state with a Gaussian bump added at every star.

    Parameters
    ----------
    heights : (S,) mm, to the side of each star's plastic; a star of height 0 does not change. Held components do not
        move.
    """
    bumped = np.flatnonzero(heights)
    if len(bumped) == 0:
        return state
    up = (model.layout.star_side * heights)[bumped]
    distance, nearest = cKDTree(model.layout.centres[bumped]).query(model.mesh.points)
    lift = up[nearest] * np.exp(-((distance / (BUMP_RADIUS_FRACTION * model.spacing)) ** 2))
    positions = state.positions + lift[:, None] * vertex_normals(state.positions, model.mesh.triangles)
    positions = np.where(model.constraints.held, state.positions, positions)
    return model.moved_to(state, positions)
