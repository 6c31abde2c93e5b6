"""Maps from the printed sheet into space with two derivatives, such as the target positions of supports."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats

PlaneMap = Callable[[Floats], Floats]


@dataclass(frozen=True)
class Deformation:
    """A map of printed points (n, 2) mm into space."""

    position: PlaneMap  # function to positions (n, 3) mm
    gradient: PlaneMap  # function to derivatives 1, 2: (n, 3, 2)
    hessian: PlaneMap  # function to derivatives 11, 22, 12: (n, 3, 3) per mm

    def jets(self, points: Floats) -> Floats:
        """(n, 6, 3) position and derivatives 1, 2, 11, 22, 12."""
        parts = [self.position(points)[:, :, None], self.gradient(points), self.hessian(points)]
        return np.concatenate(parts, axis=2).transpose(0, 2, 1)

    def normal(self, points: Floats) -> Floats:
        """(n, 3) unit normals along `x_1 x x_2`."""
        first = self.gradient(points)
        cross = np.cross(first[..., 0], first[..., 1])
        return np.asarray(cross / np.linalg.norm(cross, axis=1, keepdims=True))

    def normal_turn(self, points: Floats, tangent: Floats) -> Floats:
        """(n, 3) derivative of the unit normal along `tangent` (n, 2), per mm."""
        first, second = self.gradient(points), self.hessian(points)
        along = second[..., [[0, 2], [2, 1]]] @ tangent[:, None, :, None]
        along = along[..., 0]
        cross = np.cross(first[..., 0], first[..., 1])
        change = np.cross(along[..., 0], first[..., 1]) + np.cross(first[..., 0], along[..., 1])
        length = np.linalg.norm(cross, axis=1, keepdims=True)
        normal = cross / length
        return np.asarray((change - np.sum(change * normal, axis=1, keepdims=True) * normal) / length)


def affine(matrix: ArrayLike, offset: ArrayLike = (0.0, 0.0, 0.0)) -> Deformation:
    """The deformation `matrix` (3, 2) times the printed point, plus `offset` (3,) mm."""
    slope, start = np.asarray(matrix, dtype=float), np.asarray(offset, dtype=float)
    return Deformation(
        lambda p: p @ slope.T + start,
        lambda p: np.broadcast_to(slope, (len(p), 3, 2)),
        lambda p: np.zeros((len(p), 3, 3)),
    )


def flat(scale: float = 1.0, centre: ArrayLike = (0.0, 0.0)) -> Deformation:
    """The deformation in the printed plane that scales lengths by `scale` about `centre` (2,) mm.

    >>> flat(0.5, centre=(10.0, 0.0)).position(np.array([[20.0, 4.0]]))
    array([[15.,  2.,  0.]])
    """
    centre = np.asarray(centre, dtype=float)
    return affine(scale * np.eye(3)[:, :2], np.r_[(1.0 - scale) * centre, 0.0])
