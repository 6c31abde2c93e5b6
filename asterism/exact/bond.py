"""The bond between plastic and fabric: the line force with which the fabric pulls at the rods of an exact shape."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State, edge_tangents
from asterism.equilibrium.arrays import Floats

# widths of a rod over which its line force is averaged at least. At a tip the force of a line on a sheet is singular,
# and rods are lines: what happens within a width is beyond the model. Means over two widths converge with the mesh.
WIDTHS_PER_PIECE = 2.0


class LineForces(NamedTuple):
    """Forces of the fabric on the rods for each mm of rod, at every rod edge.

    Attributes
    ----------
    peel : (R,) N/mm, away from the plastic at a right angle to the bond; negative where the fabric presses on it.
    shear : (R,) N/mm, in the plane of the bond, along and across the rod.
    """

    peel: Floats
    shear: Floats


def line_forces(model: DiscreteModel, state: State) -> LineForces:
    """The line forces between fabric and rods in a state of equilibrium, as means over pieces of the rods.

    Notes
    -----
    Rods and fabric share vertices. In equilibrium the fabric holds each vertex against the force of the rods, the
    negative gradient of their energies, so it pulls at the rods with their gradient. The rods' own weight, about
    1e-5 N/mm, counts as a force of the fabric. Rods that meet at a vertex share its force by their lengths there.
    Every rod is divided into equal pieces of at least `WIDTHS_PER_PIECE` widths.
    """
    net, n_vertices = model.network, model.n_vertices
    if not len(net.edges):
        return LineForces(np.empty(0), np.empty(0))
    packed = state.packed
    force = np.zeros(model.n_dofs)
    for name, part in model.parts.items():
        if name.startswith("rod_"):
            force += np.bincount(part.dofs.ravel(), part.gradients(packed).ravel(), model.n_dofs)
    length = np.linalg.norm(model.mesh.points[net.edges[:, 1]] - model.mesh.points[net.edges[:, 0]], axis=1)
    at_vertex = np.bincount(net.edges.ravel(), np.repeat(0.5 * length, 2), n_vertices)
    density = force[: 3 * n_vertices].reshape(-1, 3) / np.maximum(at_vertex, 1e-300)[:, None]

    # along all rods, one after the other: the force in the frames of the edges, summed up over half edges
    tangent, normal = edge_tangents(state.positions, net.edges), state.directors
    frames = np.stack([tangent, np.cross(normal, tangent), normal], axis=1)
    on_halves = np.einsum("rij,rhj->rhi", frames, density[net.edges]) * 0.5 * length[:, None, None]
    total = np.vstack([np.zeros(3), np.cumsum(on_halves.reshape(-1, 3), axis=0)])
    place = np.concatenate([[0.0], np.cumsum(np.repeat(0.5 * length, 2))])

    of_rod = np.bincount(net.rod, length)
    first = (np.cumsum(of_rod) - of_rod)[net.rod]
    widths = of_rod**2 / np.bincount(net.rod, length * model.edge_width)
    piece = (of_rod / np.maximum(np.floor(widths / WIDTHS_PER_PIECE), 1.0))[net.rod]
    begin = first + piece * np.floor((place[1::2] - first) / piece)
    along, across, off = (
        (np.interp(begin + piece, place, each) - np.interp(begin, place, each)) / piece for each in total.T
    )
    return LineForces(peel=-model.edge_side * off, shear=np.hypot(along, across))
