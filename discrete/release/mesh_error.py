"""The mesh error of a shape, estimated from its distances to the shapes on coarser meshes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.equilibrium import Equilibrium
from asterism.equilibrium.arrays import Array
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.geometry.point_location import locate
from asterism.pattern.layout.free_motions import FreeMotions, free_motions

# assumed order of convergence in the edge length; on graded meshes most sheets converge faster
ORDER = 1.5
# two shapes further apart than this, in % of the diameter, count as different forms
MAX_CHANGE_PERCENT = 8.0


@dataclass(frozen=True)
class MeshErrorEstimate:
    """What the meshes of a search say about the error of its last shape."""

    # estimated rms distance to the shape on an infinitely fine mesh, in % of the diameter; None if one mesh was solved,
    # or if the last two have different forms.
    percent: float | None = None
    change_percent: float | None = None  # rms distance to the shape on the mesh before; None if one mesh was solved
    forms_differ: bool = False  # the shapes on the last two meshes have different forms


def mesh_error(vertices: Sequence[int], changes: Sequence[float | None]) -> MeshErrorEstimate:
    """Estimate the error of the last shape.

    If the error on a mesh of edge h is `c h^p`, the distance of two shapes is the difference of their errors, and that
    of the finer one follows (Richardson 1911), with the order `ORDER`. A small distance may be chance: it counts for no
    less than the distance before leads to expect.

    Parameters
    ----------
    vertices : of all meshes, the finest last.
    changes : rms distance to the shape before, in % of the diameter; None for the first mesh.

    >>> round(mesh_error([500, 1000, 2000], [None, 2.0, 1.0]).percent, 2)
    1.74
    >>> mesh_error([500, 1000], [None, 12.0]).forms_differ
    True
    """
    if len(vertices) < 2 or changes[-1] is None:
        return MeshErrorEstimate()
    if changes[-1] > MAX_CHANGE_PERCENT:
        return MeshErrorEstimate(None, changes[-1], True)
    errors = []
    for number in range(max(1, len(vertices) - 2), len(vertices)):
        change = changes[number]
        ratio = np.sqrt(vertices[number] / vertices[number - 1])
        # meshes of nearly equal edges give no estimate
        if change is None or ratio < 1.15 or change > MAX_CHANGE_PERCENT:
            continue
        finest = np.sqrt(vertices[number] / vertices[-1])
        errors.append(change / (ratio**ORDER - 1.0) * finest**ORDER)
    return MeshErrorEstimate(float(max(errors)) if errors else None, changes[-1])


def change_percent(coarse: DiscreteModel, before: Equilibrium, fine: DiscreteModel, after: Equilibrium) -> float:
    """Rms distance of the shapes on two meshes at the vertices of the coarse one, in % of the diameter.

    Only rigid motions that the supports leave free are taken out.
    """
    printed, one = coarse.mesh.points, before.state.positions
    other = places(fine, after.state.positions, printed)
    free = motions_left_free(fine, after.state.positions)
    rotation, shift = free.fit(one, other)
    distance = np.sqrt(((one @ rotation.T + shift - other) ** 2).sum(axis=1).mean())
    return float(100.0 * distance / diameter(after.state.positions))


def places(model: DiscreteModel, positions: Array, printed: Array) -> Array:
    """(n, 3) mm, places of printed points (n, 2) on positions (V, 3), linear in each triangle."""
    mesh = model.mesh
    # on the chords of a curved outline
    triangle, weights = locate(mesh.points, mesh.triangles, printed, model.spacing)
    return np.asarray(np.einsum("nk,nki->ni", weights, positions[mesh.triangles[triangle]]))


def motions_left_free(model: DiscreteModel, positions: Array) -> FreeMotions:
    """The rigid motions that the supports leave free."""
    supports = model.layout.support_samples
    if len(supports.printed) == 0:
        return FreeMotions()
    _, vertex = cKDTree(model.mesh.points).query(supports.printed)
    return free_motions(supports, positions[vertex], model.design.gravity.pull)
