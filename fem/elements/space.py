"""Interface of a discretisation: what the shell, its supports and its loads need."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from skfem import MeshTri

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.elements.deformation import affine, flat
from asterism.fem.elements.tabulation import Evaluation, Tabulation

Jets = Callable[[Floats], Floats]


"""Map from printed points (n, 2) mm to (n, 6, 3): position and its derivatives 1, 2, 11, 22, 12."""


class Space(Protocol):
    """Scalar functions on a triangle mesh, used for each component of the position.

    Attributes
    ----------
    mesh : triangles in printed mm.
    size : number N of scalar dofs.
    smooth : the functions are C1, with value and derivatives at the vertices as dofs.
    mid_normals : normal derivatives at the edge midpoints are dofs too.
    degree : of the polynomials.
    """

    mesh: MeshTri
    size: int
    smooth: bool
    mid_normals: bool
    degree: int

    def jets(self, triangles: Ints, points: Floats) -> tuple[Ints, Floats]:
        """Dofs (n, m), and (n, m, 6) value and derivatives 1, 2, 11, 22, 12 of their functions at points (n, 2)."""

    def tabulate(self, order: int) -> Tabulation:
        """The functions at the points of a quadrature that is exact for polynomials of degree `order`."""

    def locate(self, points: Floats) -> Evaluation:
        """Evaluation of functions of the space at printed points (n, 2) mm."""

    def penalty(self, modulus: Floats | float = 1.0) -> sp.csr_matrix | None:
        """(N, N) quadratic form of the slope jumps, per bending modulus (T,) N mm; None if the functions are C1."""

    def interpolate(self, jets: Jets) -> Floats:
        """(N, 3) coefficients of the interpolant of a map of the printed sheet into space."""


def flat_positions(space: Space) -> Floats:
    """(N, 3) mm, coefficients of the printed sheet in the plane z = 0."""
    return space.interpolate(flat().jets)


def constant(space: Space) -> Floats:
    """(N,) coefficients of the function one."""
    return np.ascontiguousarray(space.interpolate(affine(np.zeros((3, 2)), (1.0, 0.0, 0.0)).jets)[:, 0])
