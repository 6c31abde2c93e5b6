"""The joints of a graph on a mesh: their half edges, and the parameters of their energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.discrete.energies.rods.network import RodNetwork
from asterism.discrete.energies.rods.section import torsion_constant
from asterism.discrete.model.state import edge_tangents
from asterism.equilibrium.arrays import Array


@dataclass(frozen=True)
class JointNetwork:
    """Joints, and the half edges that leave them.

    Attributes
    ----------
    vertices : (J,) vertex of each joint.
    joint : (H,) joint of each half edge.
    edge : (H,) rod edge of each half edge.
    far_vertex : (H,) vertex at the other end of that edge.
    sign : (H,) 1, or -1 if the edge runs towards the joint.
    """

    vertices: Array
    joint: Array
    edge: Array
    far_vertex: Array
    sign: Array


def joint_network(paths: tuple[Array, ...], joints: list[list[tuple[int, int]]]) -> JointNetwork:
    """The joints of rods along vertex paths.

    Parameters
    ----------
    paths : one path of vertices for each rod, in the order of the edges of its `RodNetwork`.
    joints : for each joint the ends of rods there: number of the rod, and 0 for its start or 1 for its end.

    Examples
    --------
    A rod over vertices 0, 1, 2 and a branch from vertex 2 to 3:

    >>> corner = joint_network((np.array([0, 1, 2]), np.array([2, 3])), [[(0, 1), (1, 0)]])
    >>> corner.vertices.tolist(), corner.edge.tolist(), corner.far_vertex.tolist(), corner.sign.tolist()
    ([2], [1, 2], [1, 3], [-1.0, 1.0])
    """
    first = np.concatenate([[0], np.cumsum([len(path) - 1 for path in paths])])
    vertices, joint, edge, far_vertex, sign = [], [], [], [], []
    for number, ends in enumerate(joints):
        rod, end = ends[0]
        vertices.append(paths[rod][-end])
        for rod, end in ends:
            joint.append(number)
            edge.append(first[rod + 1] - 1 if end else first[rod])
            far_vertex.append(paths[rod][-2 if end else 1])
            sign.append(-1.0 if end else 1.0)
    return JointNetwork(
        vertices=np.array(vertices, dtype=np.int64),
        joint=np.array(joint, dtype=np.int64),
        edge=np.array(edge, dtype=np.int64),
        far_vertex=np.array(far_vertex, dtype=np.int64),
        sign=np.array(sign, dtype=float),
    )


def joint_inputs(joints: JointNetwork, n_vertices: int, n_edges: int) -> tuple[Array, Array]:
    """Inputs (H, 15) and dofs (H, 10) of `RodJoint`."""
    xyz = np.arange(3)
    node, far = 3 * joints.vertices[joints.joint][:, None] + xyz, 3 * joints.far_vertex[:, None] + xyz
    directors = 3 * n_vertices + 3 * joints.edge[:, None] + xyz
    frames = 3 * (n_vertices + n_edges) + 9 * joints.joint[:, None]
    inputs = np.hstack([node, far, directors, frames + xyz, frames + 6 + xyz])
    twist = 3 * n_vertices + joints.edge[:, None]
    spin = 3 * n_vertices + n_edges + 3 * joints.joint[:, None] + xyz
    return inputs, np.hstack([node, far, twist, spin])


def joint_params(
    joints: JointNetwork,
    network: RodNetwork,
    printed: Array,
    modulus: float,
    poisson: float,
    width: Array,
    thickness: Array,
    curvature: Array,
) -> Array:
    """(H, 8) parameters of `RodJoint`, without rest twist.

    Parameters
    ----------
    printed : (V, 2) mm.
    modulus, poisson : MPa and 1, of the plastic.
    width, thickness : (R,) mm, of every edge.
    curvature : (R,) 1/mm, rest curvature about the width.
    """
    edge = joints.edge
    w, h = width[edge], thickness[edge]
    step = printed[joints.far_vertex] - printed[joints.vertices[joints.joint]]
    length = np.linalg.norm(step, axis=1)
    shear = modulus / (2.0 * (1.0 + poisson))
    stiffness = [modulus * w * h**3 / 12.0, modulus * h * w**3 / 12.0, shear * torsion_constant(w, h)]
    columns = [*(value / length for value in stiffness), 0.5 * curvature[edge] * length]
    return np.column_stack([*columns, step / length[:, None], joints.sign, np.zeros(len(length))])


def fitted_frames(joints: JointNetwork, edges: Array, printed: Array, positions: Array, directors: Array) -> Array:
    """(J, 3, 3) frames of joints, each the rotation nearest to those of its half edges since the print.

    Parameters
    ----------
    edges : (R, 2) vertices of the rod edges.
    printed : (V, 2) mm.
    positions, directors : (V, 3) mm and (R, 3), of the state.
    """
    before = np.column_stack([printed, np.zeros(len(printed))])
    up = np.tile([0.0, 0.0, 1.0], (len(edges), 1))

    def axes(places: Array, normals: Array) -> Array:
        """(H, 3, 3) tangent, width and normal of each half edge, as columns."""
        t = edge_tangents(places, edges)
        return np.stack([t, np.cross(normals, t), normals], axis=2)[joints.edge]

    turned = axes(positions, directors) @ axes(before, up).transpose(0, 2, 1)
    total = np.zeros((len(joints.vertices), 3, 3))
    np.add.at(total, joints.joint, turned)
    u, _, vt = np.linalg.svd(total)
    u[:, :, 2] *= np.linalg.det(u @ vt)[:, None]
    return np.asarray((u @ vt).transpose(0, 2, 1))
