"""The arms of a layout as rods on a mesh: edges, stencils, junctions, and the parameters of their energies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asterism.discrete.model.state import edge_tangents
from asterism.equilibrium.arrays import Array


@dataclass(frozen=True)
class RodNetwork:
    """Edges and stencils of rods, which meet at junctions by their first vertices."""

    edges: Array  # (R, 2) vertices, along each rod
    rod: Array  # (R,) the rod of each edge
    midpoint: Array  # (R,) position of the edge's midpoint along its rod, 0 at the start and 1 at the end
    stencil_vertices: Array  # (S, 3) vertices
    stencil_edges: Array  # (S, 2) edges
    signs: Array  # (S, 2) 1, or -1 where the stencil runs against the edge
    weight: Array  # (S,) share of the cross-section that bends and twists in this stencil, see `rod_network`


def rod_network(
    paths: tuple[Array, ...],
    junction: Array,
    printed: Array,
    links: Sequence[tuple[tuple[int, int], tuple[int, int]]] = (),
) -> RodNetwork:
    """Edges and stencils of rods along vertex paths.

    At a junction of N rods each rod splits into N - 1 copies, one for each other rod. Each of the N (N - 1)/2 pairs
    bends and twists with weight 1/(N - 1). Three arms have the paper's weight 1/2 (section 3.2); two arms are one
    straight rod.

    Parameters
    ----------
    paths : one path of vertices for each rod.
    junction : (rods,) rods with the same number (>= 0) meet at their first vertex; -1 is a free start.
    printed : (V, 2) mm.
    links : pairs of ends (rod, 0 for its start or 1 for its end) at the same vertex, at which one rod goes on as
        another, or a closed rod as itself.

    Three arms of one edge each from vertex 0:

    >>> tips = np.array([[0, 0], [1, 0], [-0.5, 0.9], [-0.5, -0.9]])
    >>> star = rod_network((np.array([0, 1]), np.array([0, 2]), np.array([0, 3])), np.zeros(3, dtype=int), tips)
    >>> star.stencil_vertices.tolist(), star.weight.tolist()
    ([[1, 0, 2], [1, 0, 3], [2, 0, 3]], [0.5, 0.5, 0.5])
    """
    edges: list[tuple[int, int]] = []
    of_edges: list[tuple[int, float]] = []  # rod and midpoint
    stencils: list[tuple[tuple[int, int, int], tuple[int, int], tuple[float, float], float]] = []
    first: list[int] = []
    for r, path in enumerate(paths):
        start = len(edges)
        first.append(start)
        length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(printed[path], axis=0), axis=1))])
        for j in range(len(path) - 1):
            edges.append((path[j], path[j + 1]))
            of_edges.append((r, 0.5 * (length[j] + length[j + 1]) / length[-1]))
            if j > 0:
                vertices = path[j - 1], path[j], path[j + 1]
                stencils.append((vertices, (start + j - 1, start + j), (1.0, 1.0), 1.0))
    for star in np.unique(junction[junction >= 0]):
        joined = np.flatnonzero(junction == star)
        for i, a in enumerate(joined):
            for b in joined[i + 1 :]:
                vertices = paths[a][1], paths[a][0], paths[b][1]
                stencils.append((vertices, (first[a], first[b]), (-1.0, 1.0), 1.0 / (len(joined) - 1)))
    for (one, one_end), (other, other_end) in links:
        vertices = paths[one][-2 if one_end else 1], paths[one][-one_end], paths[other][-2 if other_end else 1]
        last = first[one] + len(paths[one]) - 2, first[other] + len(paths[other]) - 2
        pair = last[0] if one_end else first[one], last[1] if other_end else first[other]
        stencils.append((vertices, pair, (1.0 if one_end else -1.0, -1.0 if other_end else 1.0), 1.0))
    rod, midpoint = np.array(of_edges).reshape(-1, 2).T
    columns = zip(*stencils, strict=True) if stencils else ((), (), (), ())
    of_vertices, of_pairs, signs, weight = columns
    return RodNetwork(
        np.array(edges, dtype=np.int64).reshape(-1, 2),
        rod.astype(np.int64),
        midpoint,
        np.array(of_vertices, dtype=np.int64).reshape(-1, 3),
        np.array(of_pairs, dtype=np.int64).reshape(-1, 2),
        np.array(signs, dtype=float).reshape(-1, 2),
        np.array(weight, dtype=float),
    )


def stretch_params(network: RodNetwork, printed: Array, modulus: float, width: Array, thickness: Array) -> Array:
    """(R, 2) parameters of `RodStretch`, for a modulus in MPa and the width and thickness (R,) mm of every edge."""
    length = np.linalg.norm(printed[network.edges[:, 1]] - printed[network.edges[:, 0]], axis=1)
    return np.column_stack([modulus * width * thickness, length])


def bend_params(
    network: RodNetwork, printed: Array, modulus: float, width: Array, thickness: Array, curvature: Array
) -> Array:
    """(S, 6) parameters of `RodBend`. The stiffness of a stencil is the mean of its two edges.

    Parameters
    ----------
    printed : (V, 2) mm; the rest curvature in the plane of the sheet is the angle between the printed edges.
    modulus : MPa, of the plastic.
    width, thickness : (R,) mm, of every edge.
    curvature : (R,) 1/mm, rest curvature about the width.
    """
    about_width = _mean(network, modulus * width * thickness**3 / 12.0) * network.weight
    in_plane = _mean(network, modulus * thickness * width**3 / 12.0) * network.weight
    span = stencil_length(network, printed)
    a, b, c = (np.pad(printed[network.stencil_vertices[:, i]], ((0, 0), (0, 1))) for i in range(3))
    t0 = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
    t1 = (c - b) / np.linalg.norm(c - b, axis=1, keepdims=True)
    turn = 2.0 * np.cross(t0, t1)[:, 2] / (1.0 + (t0 * t1).sum(axis=1))
    rest = 0.5 * _mean(network, curvature) * span
    return np.column_stack([about_width / span, in_plane / span, rest, turn, network.signs])


def twist_params(
    network: RodNetwork, printed: Array, modulus: float, poisson: float, width: Array, thickness: Array
) -> Array:
    """(S, 4) parameters of `RodTwist`, without rest twist; arguments as in `bend_params`.

    The shear modulus is `E/(2 (1 + nu))`.
    """
    stiffness = modulus / (2.0 * (1.0 + poisson)) * torsion_constant(width, thickness)
    span = stencil_length(network, printed)
    return np.column_stack([_mean(network, stiffness) * network.weight / span, network.signs, np.zeros(len(span))])


def stencil_length(network: RodNetwork, printed: Array) -> Array:
    """(S,) mm, sum of the printed lengths of the two edges of each stencil."""
    length = np.linalg.norm(printed[network.edges[:, 1]] - printed[network.edges[:, 0]], axis=1)
    return np.asarray(length[network.stencil_edges].sum(axis=1))


def stencil_inputs(network: RodNetwork, n_vertices: int) -> tuple[Array, Array]:
    """Inputs (S, 15) and dofs (S, 11) of the stencils: three vertices, then two directors or twists."""
    xyz = np.arange(3)
    points = (3 * network.stencil_vertices[:, :, None] + xyz).reshape(-1, 9)
    directors = (3 * n_vertices + 3 * network.stencil_edges[:, :, None] + xyz).reshape(-1, 6)
    return np.hstack([points, directors]), np.hstack([points, 3 * n_vertices + network.stencil_edges])


def rod_curvatures(network: RodNetwork, positions: Array, directors: Array, printed: Array) -> Array:
    """(S,) 1/mm, curvature of the rods about their width; positive where their ends bend down, seen in print."""
    t = edge_tangents(positions, network.edges)[network.stencil_edges] * network.signs[:, :, None]
    width = np.cross(directors[network.stencil_edges], t)
    binormal = 2.0 * np.cross(t[:, 0], t[:, 1]) / (1.0 + (t[:, 0] * t[:, 1]).sum(axis=1))[:, None]
    return np.asarray((binormal * width.sum(axis=1)).sum(axis=1) / stencil_length(network, printed))


def _mean(network: RodNetwork, values: Array) -> Array:
    return np.asarray(values[network.stencil_edges].mean(axis=1))


@dataclass(frozen=True)
class JointNetwork:
    """Joints, and the half edges that leave them."""

    vertices: Array  # (J,) vertex of each joint
    joint: Array  # (H,) joint of each half edge
    edge: Array  # (H,) rod edge of each half edge
    far_vertex: Array  # (H,) vertex at the other end of that edge
    sign: Array  # (H,) 1, or -1 if the edge runs towards the joint


def joint_network(paths: tuple[Array, ...], joints: Sequence[Sequence[tuple[int, int]]]) -> JointNetwork:
    """The joints of rods along vertex paths.

    Parameters
    ----------
    paths : one path of vertices for each rod, in the order of the edges of its `RodNetwork`.
    joints : for each joint the ends of rods there: number of the rod, and 0 for its start or 1 for its end.

    A rod over vertices 0, 1, 2 and a branch from vertex 2 to 3:

    >>> corner = joint_network((np.array([0, 1, 2]), np.array([2, 3])), [[(0, 1), (1, 0)]])
    >>> corner.vertices.tolist(), corner.edge.tolist(), corner.far_vertex.tolist(), corner.sign.tolist()
    ([2], [1, 2], [1, 3], [-1.0, 1.0])
    """
    first = np.concatenate([[0], np.cumsum([len(path) - 1 for path in paths])])
    vertices = [paths[rod][-end] for (rod, end), *_ in joints]
    halves = [
        (number, first[rod + 1] - 1 if end else first[rod], paths[rod][-2 if end else 1], -1 if end else 1)
        for number, ends in enumerate(joints)
        for rod, end in ends
    ]
    joint, edge, far_vertex, sign = np.array(halves, dtype=np.int64).reshape(-1, 4).T
    return JointNetwork(np.array(vertices, dtype=np.int64), joint, edge, far_vertex, sign.astype(float))


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


def torsion_constant(width: Array, thickness: Array) -> Array:
    """(...) mm^4, Saint-Venant's torsion constant J of rectangles of width and thickness (...) mm, in any order.

    The series of Timoshenko and Goodier, Theory of Elasticity, section 109, up to terms below 1e-9.

    The square has J = 0.1406 a^4, a thin strip nearly a b^3/3:

    >>> torsion_constant(np.array([1.0, 100.0]), np.array([1.0, 1.0])).round(4)
    array([ 0.1406, 33.1233])
    """
    a, b = np.maximum(width, thickness), np.minimum(width, thickness)
    n = np.arange(1, 200, 2).reshape(-1, *([1] * np.ndim(a)))
    series = (np.tanh(n * np.pi * a / (2.0 * b)) / n**5).sum(axis=0)
    return np.asarray(a * b**3 * (1.0 / 3.0 - 64.0 / np.pi**5 * (b / a) * series))
