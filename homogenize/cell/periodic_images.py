"""Elements of an unfolded mesh as functions of the degrees of freedom of one cell.

An unfolded point is `R_u x_b + B (m1 p1 + m2 p2)`: its rotated base point, plus the macroscopic variables p1 and p2 for
its lattice vectors. On a flat cell R and B are identities, and p1, p2 are the images of the cell vectors. On a tube of
given angles (objective images) R_u rotates about the axis and B keeps the axial component: p1, p2 are axial shifts. The
map is linear, so the gradient of an element is `T^T g` and its Hessian `T^T H T`.

Rods are unfolded in one piece each, so their directors need no images. The joints at their ends do: an unfolded joint
has the frame `R_u F_j` of its base joint j, and spins by `R_u w` if that spins by w.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field

import numpy as np

from asterism.discrete.energies.elements import Elements
from asterism.equilibrium.arrays import Array


@dataclass(frozen=True)
class PeriodicImages:
    """The map from base points and two macroscopic rows (rows V and V + 1 of the positions) to unfolded points."""

    base: Array  # (U,) base points
    turn: Array  # (U, 3, 3) rotations R_u
    count: Array  # (U, 2) numbers m1, m2 of cell vectors
    axes: Array  # (3, 3) B
    n_base: int  # V
    # (K,) unfolded point of each unfolded joint.
    joint_point: Array = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    joint: Array = field(default_factory=lambda: np.empty(0, dtype=np.int64))  # (K,) its base joint
    _last: list[tuple[Array, Array]] = field(default_factory=list, repr=False, compare=False)

    def unfold(self, positions: Array) -> Array:
        """(U, 3) unfolded points of positions (V + 2, 3)."""
        own = np.einsum("uij,uj->ui", self.turn, positions[self.base])
        return np.asarray(own + self.count @ (positions[self.n_base :] @ self.axes.T))

    @property
    def n_joints(self) -> int:
        """J, the number of base joints."""
        return int(self.joint.max(initial=-1)) + 1

    @property
    def joint_turn(self) -> Array:
        """(K, 3, 3) rotations of the unfolded joints."""
        return self.turn[self.joint_point]

    def unfold_frames(self, frames: Array) -> Array:
        """(K, 3, 3) frames of the unfolded joints, of those (J, 3, 3) of the base joints; rows as in `State`."""
        return np.asarray(frames[self.joint] @ self.joint_turn.transpose(0, 2, 1))

    def unfold_packed(self, packed: Array) -> Array:
        """Packed configuration of the unfolded mesh. The last one is kept, for the next kind of elements."""
        for known, whole in self._last:
            if known is packed:
                return whole
        split, last = 3 * (self.n_base + 2), len(packed) - 9 * self.n_joints
        points = self.unfold(packed[:split].reshape(-1, 3))
        frames = self.unfold_frames(packed[last:].reshape(-1, 3, 3))
        whole = np.concatenate([points.ravel(), packed[split:last], frames.ravel()])
        self._last[:] = [(packed, whole)]
        return whole


class PeriodicElements:
    """The elements of an unfolded mesh with the degrees of freedom of the cell: positions (V + 2 rows), then twists
    and spins.

    Parameters
    ----------
    part : elements over unfolded points (U), rod edges (R) and unfolded joints.
    images : of the unfolded points and joints.
    n_edges : R.
    """

    def __init__(self, part: Elements, images: PeriodicImages, n_edges: int) -> None:
        self.part, self.images = part, images
        n_unfolded, rows = len(images.base), images.n_base + 2
        spin = 3 * n_unfolded + n_edges
        first = part.dofs[0]  # all elements of a part have the same kinds of dofs
        nodes = part.dofs[:, first < 3 * n_unfolded][:, ::3] // 3
        twists = part.dofs[:, (first >= 3 * n_unfolded) & (first < spin)] - 3 * n_unfolded
        joints = (part.dofs[:, first >= spin][:, ::3] - spin) // 3
        xyz = np.arange(3)
        own = (3 * images.base[nodes][:, :, None] + xyz).reshape(len(nodes), -1)
        macro = np.broadcast_to(3 * images.n_base + np.arange(6), (len(nodes), 6))
        spins = (3 * rows + n_edges + 3 * images.joint[joints][:, :, None] + xyz).reshape(len(nodes), -1)
        self.dofs = np.hstack([own, 3 * rows + twists, spins, macro]).astype(np.int32)
        self._transform = self._chain(nodes, twists.shape[1], joints)
        # On the coarsest meshes an element holds two images of one point. Off-diagonal entries of its Hessian, which a
        # lower triangle holds once, then lie on the diagonal of the cell's Hessian and count twice.
        i, j = _lower(self.dofs.shape[1])
        twice = (self.dofs[:, i] == self.dofs[:, j]) & (i != j)
        self._twice = twice if twice.any() else None

    def _chain(self, nodes: Array, n_twists: int, joints: Array) -> Array:
        """(E, n, N) derivative of an element's degrees of freedom by those of the cell."""
        count, size = nodes.shape
        n = 3 * size + n_twists + 3 * joints.shape[1]
        t = np.zeros((count, n, n + 6))
        for a in range(size):
            block = slice(3 * a, 3 * a + 3)
            t[:, block, block] = self.images.turn[nodes[:, a]]
            for p in range(2):
                last = n + 3 * p
                shift = self.images.count[nodes[:, a], p]
                t[:, block, last : last + 3] = shift[:, None, None] * self.images.axes
        for a in range(n_twists):
            t[:, 3 * size + a, 3 * size + a] = 1.0
        for a in range(joints.shape[1]):
            block = slice(3 * size + n_twists + 3 * a, 3 * size + n_twists + 3 * a + 3)
            t[:, block, block] = self.images.joint_turn[joints[:, a]]
        return t

    def __len__(self) -> int:
        return len(self.part)

    def energies(self, packed: Array) -> Array:
        """(E,) N mm."""
        return self.part.energies(self.images.unfold_packed(packed))

    def gradients(self, packed: Array) -> Array:
        """(E, N) gradients."""
        return np.asarray(
            np.einsum("ei,eij->ej", self.part.gradients(self.images.unfold_packed(packed)), self._transform)
        )

    def hessians(self, packed: Array, blend: float = 0.0, rows: slice = slice(None)) -> Array:
        """(E, N (N + 1)/2) packed lower triangles of all elements, or of some rows."""
        low = self.part.hessians(self.images.unfold_packed(packed), blend, rows)
        transform = self._transform[rows]
        n, big = transform.shape[1:]
        full = np.empty((len(low), n, n), dtype=low.dtype)
        i, j = _lower(n)
        full[:, i, j] = low
        full[:, j, i] = low
        whole = np.matmul(transform.transpose(0, 2, 1), np.matmul(full, transform))
        i, j = _lower(big)
        packed_low = np.ascontiguousarray(whole[:, i, j])
        if self._twice is not None:
            packed_low[self._twice[rows]] *= 2.0
        return packed_low


@functools.cache
def _lower(n: int) -> tuple[Array, Array]:
    """Rows and columns of a lower triangle, cached: they take as long as the Hessian of a cell."""
    return np.tril_indices(n)
