"""Starts without folds: triangles that a start has turned over or crushed are laid flat by those around them.

Arms that keep their length, supports that move, and shapes of other meshes may leave triangles that lie upside down
between the tip of an arm and what it meets. The energy of such a fold is many times that of the whole sheet. Newton's
method leaves it in short steps, or ends in a minimum with a fold that no print has.
"""

from __future__ import annotations

import numpy as np

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array, Ints
from asterism.pattern.geometry.normals import sum_at_vertices
from asterism.pattern.geometry.planar import triangle_areas

# cosine of the angle to the mean normal around it, below which a triangle counts as folded
MIN_COSINE = 0.3
# least stretches of triangles that are laid flat, by the free fabric: the better one is taken
MIN_STRETCHES = (0.8, 0.15)
MAX_ROUNDS = 10


def unfolded(model: DiscreteModel, state: State) -> State:
    """The state with its folds laid flat, if that lowers its energy; else the state itself.

    Folded triangles get the mean deformation of the others around them, crushed ones a least stretch. Positions follow
    by least squares, in which rods keep their length and held components stay.
    """
    # exactly folded triangles have no finite energy
    best, lowest = state, np.nan_to_num(model.energy(state), nan=np.inf)
    # deformations are by the free fabric at the present release; those of the reconstruction by another shape of it
    printed = np.column_stack([model.mesh.points, np.zeros(model.n_vertices)])
    columns = np.linalg.solve(model.reconstruction.gradients(printed)[0][0, :2], np.diag(model.released_stretch))
    back, area = np.linalg.inv(columns), triangle_areas(model.mesh.points, model.mesh.triangles)
    for least in MIN_STRETCHES:
        positions = state.positions
        for _ in range(MAX_ROUNDS):
            gradients, edges = model.reconstruction.gradients(positions)
            if not np.isfinite(gradients).all():
                break
            by_free = gradients @ columns
            change = _flat(model.mesh.triangles, area, by_free, least) - by_free
            if not change.any():
                break
            positions = positions + model.reconstruction.displacements(change @ back, np.zeros_like(edges))
            flat = model.reachable_state(state, model.moved_to(state, positions))
            energy = model.energy(flat)
            if energy < lowest:
                lowest, best = energy, flat
        if positions is state.positions:
            break
    return best


def _flat(triangles: Ints, area: Array, gradients: Array, least: float) -> Array:
    """Deformation gradients (T, 3, 2) without folds; those of the other triangles stay."""
    count = int(triangles.max()) + 1

    def mean_around(values: Array, weight: Array) -> Array:
        """(T, k) means of values (T, k) of triangles over all that meet at the corners of each."""
        weights = weight.repeat(3)
        total = sum_at_vertices(triangles, weights[:, None] * values.repeat(3, axis=0), count)
        return np.asarray((total / sum_at_vertices(triangles, weights, count)[:, None])[triangles].mean(axis=1))

    normal = np.cross(gradients[:, :, 0], gradients[:, :, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    around = mean_around(normal, area)
    upright = (normal * around).sum(axis=1) > MIN_COSINE * np.linalg.norm(around, axis=1)
    # where all triangles at a corner are folded, their mean is all that is known
    mean = mean_around(gradients.reshape(-1, 6), np.where(upright, area, 1e-9 * area)).reshape(gradients.shape)
    flat = np.where(upright[:, None, None], gradients, mean)
    left, stretch, right = np.linalg.svd(flat, full_matrices=False)
    crushed = stretch[:, 1] < least
    flat[crushed] = (left * np.maximum(stretch, least)[:, None])[crushed] @ right[crushed]
    return np.asarray(flat)
