"""Elements of a strip whose periods are images of each other under one unknown screw motion.

An unfolded point is a base point x, its image `Q x + t` in the next period, or its image `Q^T (x - t)` in the one
before. The rotation Q and the shift t are unknowns like the positions: the screw is free. With the spin w of Q, a step
changes Q to `exp([w]) Q`. So the first derivative of an image is

    Q dx + dt + w x (Q x)                next period,
    Q^T (dx - dt - w x (x - t))          period before,

and the second one, which adds to the Hessian of an element, `w x (w x Q x)/2 + w x (Q dx)` and
`Q^T (w x (w x (x - t))/2 - w x (dx - dt))`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from asterism.discrete.energies.elements import Elements
from asterism.equilibrium.arrays import Array

_XYZ = np.arange(3)


@dataclass(frozen=True)
class ScrewImages:
    """The map from V base points, a row t and a frame Q to U unfolded points.

    Attributes
    ----------
    base : (U,) base point of each point.
    period : (U,) -1, 0 or 1.
    n_base : V.
    n_edges : R, rod edges; they are unfolded in one piece.
    """

    base: Array
    period: Array
    n_base: int
    n_edges: int
    _last: list[tuple[Array, Array]] = field(default_factory=list, repr=False, compare=False)

    def split(self, packed: Array) -> tuple[Array, Array, Array]:
        """Base points (V, 3), t (3,) and Q (3, 3) of a packed state of the cell."""
        rows = packed[: 3 * (self.n_base + 1)].reshape(-1, 3)
        return rows[:-1], rows[-1], packed[-9:].reshape(3, 3).T

    def unfold(self, positions: Array, rotation: Array) -> Array:
        """(U, 3) unfolded points of positions (V + 1, 3), the last of which is t."""
        points, shift = positions[:-1][self.base], positions[-1]
        after, before = (self.period[:, None] == p for p in (1, -1))
        moved = np.where(after, points @ rotation.T + shift, points)
        return np.asarray(np.where(before, (points - shift) @ rotation, moved))

    def unfold_packed(self, packed: Array) -> Array:
        """Packed state of the unfolded mesh. The last one is kept, for the next kind of elements."""
        for known, whole in self._last:
            if known is packed:
                return whole
        split = 3 * (self.n_base + 1)
        points = self.unfold(packed[:split].reshape(-1, 3), packed[-9:].reshape(3, 3).T)
        whole = np.concatenate([points.ravel(), packed[split:-9]])
        self._last[:] = [(packed, whole)]
        return whole


class ScrewElements:
    """The elements of an unfolded strip with the degrees of freedom of one period: positions, t, twists, spin of Q.

    Parameters
    ----------
    part : elements over unfolded points (U) and rod edges (R).
    images : of the unfolded points.
    """

    def __init__(self, part: Elements, images: ScrewImages) -> None:
        self.part, self.images = part, images
        n_points, n_base = len(images.base), images.n_base
        first = part.dofs[0]
        self._nodes = part.dofs[:, first < 3 * n_points][:, ::3] // 3
        twists = part.dofs[:, first >= 3 * n_points] - 3 * n_points
        self._twists = twists.shape[1]
        own = (3 * images.base[self._nodes][:, :, None] + _XYZ).reshape(len(part), -1)
        rows = 3 * (n_base + 1)
        screw = np.broadcast_to(np.r_[3 * n_base + _XYZ, rows + images.n_edges + _XYZ], (len(part), 6))
        self.dofs = np.hstack([own, rows + twists, screw]).astype(np.int32)

    def __len__(self) -> int:
        return len(self.part)

    def energies(self, packed: Array) -> Array:
        """(E,) N mm."""
        return self.part.energies(self.images.unfold_packed(packed))

    def gradients(self, packed: Array) -> Array:
        """(E, N) gradients by the dofs of the cell."""
        own = self.part.gradients(self.images.unfold_packed(packed))
        return np.asarray(np.einsum("ei,eij->ej", own, self._chain(packed, slice(None))))

    def hessians(self, packed: Array, blend: float = 0.0, rows: slice = slice(None)) -> Array:
        """(E, N (N + 1)/2) packed lower triangles; `blend` as in `Elements.hessians`."""
        unfolded = self.images.unfold_packed(packed)
        low, chain = self.part.hessians(unfolded, blend, rows), self._chain(packed, rows)
        n, size = chain.shape[1:]
        full = np.empty((len(low), n, n))
        i, j = np.tril_indices(n)
        full[:, i, j] = full[:, j, i] = low
        whole = np.matmul(chain.transpose(0, 2, 1), np.matmul(full, chain))
        if blend < 1.0:
            whole += (1.0 - blend) * self._turning(packed, self.part.gradients(unfolded)[rows], size, rows)
        i, j = np.tril_indices(size)
        return np.ascontiguousarray(whole[:, i, j])

    def _chain(self, packed: Array, rows: slice) -> Array:
        """(E, n, N) derivative of an element's degrees of freedom by those of the cell."""
        points, shift, rotation = self.images.split(packed)
        nodes = self._nodes[rows]
        count, size = nodes.shape
        n = 3 * size + self._twists
        out = np.zeros((count, n, n + 6))
        for a in range(size):
            block, x, period = slice(3 * a, 3 * a + 3), points[self.images.base[nodes[:, a]]], self._period(nodes[:, a])
            after, before = (np.flatnonzero(period == p) for p in (1, -1))
            out[:, block, block] = np.eye(3)
            out[after, block, block] = rotation
            out[before, block, block] = rotation.T
            out[after, block, n : n + 3] = np.eye(3)
            out[before, block, n : n + 3] = -rotation.T
            out[after, block, n + 3 :] = -_cross(x[after] @ rotation.T)
            out[before, block, n + 3 :] = rotation.T @ _cross(x[before] - shift)
        for a in range(self._twists):
            out[:, 3 * size + a, 3 * size + a] = 1.0
        return out

    def _turning(self, packed: Array, gradients: Array, size: int, rows: slice) -> Array:
        """(E, N, N) part of the Hessian by the second derivative of the images, for gradients (E, n)."""
        points, shift, rotation = self.images.split(packed)
        nodes = self._nodes[rows]
        out = np.zeros((len(nodes), size, size))
        spin, move = slice(size - 3, size), slice(size - 6, size - 3)
        for a in range(nodes.shape[1]):
            block, x, period = slice(3 * a, 3 * a + 3), points[self.images.base[nodes[:, a]]], self._period(nodes[:, a])
            for p in (1, -1):
                some = np.flatnonzero(period == p)
                force, arm = gradients[some, block], x[some]
                if p == 1:
                    arm, mixed = arm @ rotation.T, -_cross(force) @ rotation
                else:
                    force, arm = force @ rotation.T, arm - shift
                    mixed = _cross(force)
                    out[some, spin, move] -= mixed
                    out[some, move, spin] -= mixed.transpose(0, 2, 1)
                out[some, spin, block] += mixed
                out[some, block, spin] += mixed.transpose(0, 2, 1)
                both = force[:, :, None] * arm[:, None]
                out[some, spin, spin] += 0.5 * (both + both.transpose(0, 2, 1))
                out[some, spin, spin] -= np.einsum("ni,ni->n", force, arm)[:, None, None] * np.eye(3)
        return out

    def _period(self, nodes: Array) -> Array:
        return np.asarray(self.images.period[nodes])


def _cross(vectors: Array) -> Array:
    """(n, 3, 3) matrices of the cross products with vectors (n, 3)."""
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    return np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
