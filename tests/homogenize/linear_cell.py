"""The linear objective cell, another way to the stiffness of the flat relaxed cell for strains and curvatures.

The image of a lattice vector A is an infinitesimal rigid motion. For the strain E and the curvature K it is

    u(X + A) = u(X) + dF A + omega x x(X) - e3 (A . K A)/2,   omega = e3 x (F^-T K A),   dF = F^-T E,

about the relaxed cell `a_m = F A_m`. `F^T F^-T K = K` is symmetric, so the images of all lattice vectors commute to
first order. The results are for E and K of the mean surface. The stiffness is the second derivative of the energy by
(E, K), with all other variables in equilibrium (static condensation):

    [A B; B^T D] = (H_ee - H_eq H_qq^-1 H_qe)/|cell|.

The relaxed cell has inner forces, so the second order of the images contributes: rotations `omega x (omega x x)/2`, and
for the shift that of a geodesic, `omega x (omega x F A)/6`. With these terms the second derivative for a cylinder is
exactly that of the tube's energy.

Gaussian curvature does work on the forces within a relaxed cell: `c det K`, which adds c to D12 and takes c/2 from
D33. No cylinder shows c, and images of two directions commute to first order only, so that c depends on the points that
represent the cell. In a sheet c is fixed at its border, where Airy's function of the inner forces vanishes. Take
`D12 + 2 D33` from here, and the rest from elsewhere (`homogenize.cell.motif_responses`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from asterism.equilibrium.arrays import Array
from asterism.homogenize.cell.flat_cell import FlatCell, mean_height
from asterism.homogenize.cell.linear_response import NEUTRAL_SHIFT
from asterism.homogenize.cell.unit_cell import ANCHOR, UnitCell
from tests.homogenize.stability import reduction_matrix, unfolded_hessian

# Voigt: 11, 22 and 2 x 12 as symmetric matrices
VOIGT_BASIS = np.array([[[1.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 1.0]], [[0.0, 0.5], [0.5, 0.0]]])


@dataclass(frozen=True)
class EffectiveStiffness:
    """Linear response of the flat relaxed cell, per printed area, in print coordinates.

    `W = M . K + 1/2 E . A E + E . B K + 1/2 K . D K`, with the Voigt vectors E of the strain and K of the curvature.
    """

    stiffness: Array  # (6, 6) `[A B; B^T D]`; A in N/mm, B in N, D in N mm
    moment: Array  # (3,) N, M

    @property
    def rest_curvature(self) -> Array:
        """(3,) 1/mm, curvature K without force and moment; a minimum only if D is positive definite."""
        return np.asarray(np.linalg.solve(self.stiffness, np.concatenate([np.zeros(3), -self.moment]))[3:])


def effective_stiffness(cell: UnitCell, flat: FlatCell) -> EffectiveStiffness:
    """Effective stiffness and moment of the relaxed cell.

    Parameters
    ----------
    flat : the flat equilibrium of this cell.
    """
    cell.set_flat()
    state, torus = flat.state, cell.mesh
    n_points, n_base = len(torus.base), torus.n_base
    place = state.positions[torus.base]
    span = torus.image @ torus.cell_vectors  # (U, 2) A of every point
    inverse = np.linalg.inv(flat.deformation)
    rotations = np.zeros((6, n_points, 3))  # omega of every point, by the six
    moves = np.zeros((6, n_points, 3))
    for i, form in enumerate(VOIGT_BASIS):
        moves[i, :, :2] = span @ (inverse.T @ form).T
        rotations[3 + i] = _about(span @ (inverse.T @ form).T)
        moves[3 + i] = np.cross(rotations[3 + i], place)
        moves[3 + i, :, 2] -= 0.5 * np.einsum("ui,ij,uj->u", span, form, span)

    hessian, force = unfolded_hessian(cell, state), cell.unfolded_gradient(state)
    load = force[: 3 * n_points].reshape(-1, 3)
    at_joints, first_spin = cell.images.joint_point, 3 * n_points + len(cell.edges)
    spins = rotations[:, at_joints]
    torques = force[first_spin:].reshape(-1, 3)
    imposed = np.zeros((hessian.shape[0], 6))
    imposed[: 3 * n_points] = moves.reshape(6, -1).T
    imposed[first_spin:] = spins.reshape(6, -1).T
    pulled = hessian @ imposed
    inner = reduction_matrix(cell.images, np.ones(n_points), len(cell.edges), turned=False)
    held = 3 * ANCHOR + np.arange(3)
    free = np.setdiff1d(np.arange(inner.shape[1]), held)
    coupling = inner.T @ pulled
    for i in range(3, 6):  # the images turn what moves
        torque = np.cross(load, rotations[i])
        for axis in range(3):
            coupling[axis : 3 * n_base : 3, i] += np.bincount(torus.base, torque[:, axis], n_base)
        # two rotations one after the other: half of their product is in the spin that stands for both
        twisted = 0.5 * np.cross(torques, spins[i])
        for axis in range(3):
            coupling[3 * n_base + len(cell.edges) + axis :: 3, i] += np.bincount(
                cell.images.joint, twisted[:, axis], cell.images.n_joints
            )
    coupling = coupling[free]
    stiff = (inner.T @ hessian @ inner).tocsc()[free][:, free]
    if cell.images.n_joints:
        stiff = stiff + NEUTRAL_SHIFT * float(np.abs(stiff.diagonal()).max()) * sp.identity(len(free))
    whole = imposed.T @ pulled - coupling.T @ splu(stiff.tocsc()).solve(coupling)
    whole += _second_order(load, rotations, place, span @ flat.deformation.T, span, inverse)
    whole += _changed_slopes(torques, span[at_joints], inverse)
    whole = 0.5 * (whole + whole.T) / cell.area
    moment = np.einsum("ux,iux->i", load, moves[3:]) + np.einsum("kx,ikx->i", torques, spins[3:])
    moment /= cell.area
    return EffectiveStiffness(_of_lower_surface(whole, moment, -mean_height(cell, state), inverse @ inverse), moment)


def _of_lower_surface(stiffness: Array, moment: Array, depth: float, inverse_metric: Array) -> Array:
    """(6, 6) stiffness for a surface that lies lower by `depth` (mm) than the one whose strain and curvature were
    imposed.

    The upper surface has the strain `E + z K` and the curvature `K + z K a^-1 K`.
    """
    shift = np.eye(6)
    shift[:3, 3:] = depth * np.eye(3)
    out = shift.T @ stiffness @ shift
    for i, one in enumerate(VOIGT_BASIS):
        for j, other in enumerate(VOIGT_BASIS):
            square = one @ inverse_metric @ other
            second = square + square.T
            out[3 + i, 3 + j] += depth * (moment @ [second[0, 0], second[1, 1], 2.0 * second[0, 1]])
    return out


def _about(tilt: Array) -> Array:
    """(U, 3) e3 x tilt (U, 2)."""
    return np.column_stack([-tilt[:, 1], tilt[:, 0], np.zeros(len(tilt))])


def _second_order(load: Array, rotations: Array, place: Array, reach: Array, span: Array, inverse: Array) -> Array:
    """(6, 6) work of the forces (U, 3) on the second derivatives of the images."""
    out = np.zeros((6, 6))
    arm = place + np.pad(reach, ((0, 0), (0, 1))) / 3.0
    twice = [np.cross(one, arm) for one in rotations]
    for i in range(3, 6):
        for j in range(3, 6):
            both = 0.5 * (np.cross(rotations[i], twice[j]) + np.cross(rotations[j], twice[i]))
            out[i, j] = (load * both).sum()
    for i, j, about in _changed_rotations(span, inverse):
        out[i, 3 + j] = out[3 + j, i] = (load * np.cross(about, place)).sum()
    return out


def _changed_slopes(torques: Array, span: Array, inverse: Array) -> Array:
    """(6, 6) work of the torques (K, 3) at joints on the second derivatives of their images; span (K, 2)."""
    out = np.zeros((6, 6))
    for i, j, about in _changed_rotations(span, inverse):
        out[i, 3 + j] = out[3 + j, i] = (torques * about).sum()
    return out


def _changed_rotations(span: Array, inverse: Array) -> Iterator[tuple[int, int, Array]]:
    """Strain i, curvature j, and the change (n, 3) of the images' rotations: their slope at a given K depends on F."""
    for i, strain in enumerate(VOIGT_BASIS):
        for j, form in enumerate(VOIGT_BASIS):
            yield i, j, _about(span @ (-inverse.T @ strain @ inverse @ inverse.T @ form).T)
