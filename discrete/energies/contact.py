"""Contact of the sheet with itself: a barrier between parts of its middle surface that come close.

Incremental potential contact (Li et al. 2020), by the IPC Toolkit, weighted by area and in physical units (Li et al.
2023): the energy is `E` times a sum over pairs weighted by their areas. Pairs of vertices, edges and triangles count
together, so that it is stiffer where two layers lie triangle on triangle than where they are shifted. It begins where
two middle surfaces are a thickness apart, and is infinite where they are half a thickness apart: fabric is soft.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from discrete.energies.elements import Array
from pattern.design.errors import DesignError
from pattern.mesh.mesh import Mesh

MIN_DISTANCE_FRACTION = 0.5  # smallest distance of the middle surfaces over the distance at which contact begins
# printed distance within which parts are neighbours, over the longest edge plus the contact distance
NEIGHBOUR_DISTANCE_FACTOR = 1.5
MAX_CCD_ITERATIONS = 1000  # of the search for the first contact along a step (Li et al. 2021, additive CCD)


def ipc_toolkit() -> Any:
    """The package `ipctk`.

    Raises
    ------
    DesignError
        It is not installed.
    """
    try:
        import ipctk
    except ImportError:
        raise DesignError("solver.contact", "needs the package ipctk: pip install ipctk") from None
    ipctk.set_logger_level(ipctk.critical)  # its remarks would go to standard output
    ipctk.set_num_threads(1)  # several add in any order, and the same design would not give the same digits
    return ipctk


class ContactBarrier:
    """Barrier between all parts of a sheet that are not neighbours.

    Parts are neighbours if their printed distance is below NEIGHBOUR_DISTANCE_FACTOR times the longest edge plus the
    contact distance. Neighbours are never in contact: the mesh may be finer than the fabric is thick, and bending alone
    governs folds with a radius of about a thickness.

    Parameters
    ----------
    mesh : of the printed sheet.
    distance : mm, contact begins at this distance of the middle surfaces.
    stretch : largest stretch of the print.
    modulus : MPa, scale of the pressure: that of the fabric.
    """

    def __init__(self, mesh: Mesh, distance: float, stretch: float, modulus: float) -> None:
        self._ipc = ipc_toolkit()
        self.distance, self.min_distance = distance, MIN_DISTANCE_FRACTION * distance
        self._barrier_width = distance - self.min_distance
        triangles = mesh.triangles.astype(np.int32)
        edges = self._ipc.edges(triangles).astype(np.int32)
        printed = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
        longest = float(np.linalg.norm(printed[edges[:, 1]] - printed[edges[:, 0]], axis=1).max())
        self.neighbour_distance = NEIGHBOUR_DISTANCE_FACTOR * (longest + stretch * distance)
        self._mesh = self._ipc.CollisionMesh(*(np.asfortranarray(a) for a in (printed, edges, triangles)))
        pairs = np.sort(cKDTree(mesh.points).query_pairs(self.neighbour_distance, output_type="ndarray"), axis=1)
        number = np.arange(len(mesh.points)).astype(object)  # every number once, however many pairs it is in
        apart = dict.fromkeys(zip(*number[pairs.T], strict=True), False)
        self._mesh.can_collide = self._ipc.make_sparse_filter(apart, True)
        self._potential = self._ipc.BarrierPotential(self._barrier_width, modulus, True)
        # energy, gradient and Hessian are asked for at the same positions, one after the other
        self._collision_cache: tuple[Array | None, Any] = None, None
        self._hessian_cache: tuple[Array | None, list[Any]] = None, []

    def energy(self, positions: Array) -> float:
        """N mm; infinite where parts are closer than `min_distance`."""
        if not np.isfinite(positions).all():
            return float("inf")
        return float(self._potential(self._active_pairs(positions), self._mesh, np.asfortranarray(positions)))

    def gradient(self, positions: Array) -> Array:
        """(3 V,) N."""
        return np.asarray(
            self._potential.gradient(self._active_pairs(positions), self._mesh, np.asfortranarray(positions))
        )

    def hessian(self, positions: Array, blend: float) -> tuple[Array, Array, Array]:
        """Rows, columns and values (K,) of the Hessian over 3 V dofs, N/mm; blend 1 is positive semidefinite."""
        weighted = zip((1.0 - blend, blend), self._hessians(positions), strict=True)
        total = sum(weight * part for weight, part in weighted if weight > 0.0).tocoo()
        return total.row, total.col, total.data

    def hessian_pattern(self, positions: Array) -> tuple[Array, Array]:
        """Rows and columns of what Hessians hold, whatever their blend: the toolkit leaves out zeros of each."""
        return _entry_indices(self._hessians(positions))

    def hessian_pattern_nearby(self, positions: Array) -> tuple[Array, Array]:
        """The same if contact began at twice the distance."""
        wide = 2.0 * self.distance - self.min_distance
        potential = self._ipc.BarrierPotential(wide, 1.0, True)
        return _entry_indices(self._exact_and_projected(potential, self._collisions(positions, wide), positions))

    def _hessians(self, positions: Array) -> list[Any]:
        """The exact and the convex one, found once for the same positions."""
        where, known = self._hessian_cache
        if where is not positions:
            known = self._exact_and_projected(self._potential, self._active_pairs(positions), positions)
            self._hessian_cache = positions, known
        return known

    def _exact_and_projected(self, potential: Any, near: Any, positions: Array) -> list[Any]:
        method, x = self._ipc.PSDProjectionMethod, np.asfortranarray(positions)
        return [potential.hessian(near, self._mesh, x, each) for each in (method.NONE, method.CLAMP)]

    def collision_free_fraction(self, positions: Array, target: Array) -> float:
        """How far the straight way to `target` (V, 3) is free, as a fraction of it; 1 for all of it."""
        way = (np.asfortranarray(x) for x in (positions, target))
        # additive, because its steps are safe however few they are; others may search for ever in flat sheets
        search = self._ipc.AdditiveCCD(max_iterations=MAX_CCD_ITERATIONS)
        return float(
            self._ipc.compute_collision_free_stepsize(self._mesh, *way, self.min_distance, narrow_phase_ccd=search)
        )

    def is_intersection_free(self, positions: Array) -> bool:
        """Nothing passes through anything or is too close to it."""
        free = not self._ipc.has_intersections(self._mesh, np.asfortranarray(positions))
        return free and bool(np.isfinite(self.energy(positions)))

    def pairs_and_gap(self, positions: Array) -> tuple[int, float]:
        """Number of pairs of vertices, edges and triangles in contact, and the least distance of any, mm."""
        near = self._active_pairs(positions)
        if len(near) == 0:
            return 0, float("inf")
        least = near.compute_minimum_distance(self._mesh, np.asfortranarray(positions))
        return len(near), float(np.sqrt(least))

    def _active_pairs(self, positions: Array) -> Any:
        where, near = self._collision_cache
        if where is not positions:
            near = self._collisions(positions, self._barrier_width)
            self._collision_cache = positions, near
        return near

    def _collisions(self, positions: Array, reach: float) -> Any:
        out = self._ipc.NormalCollisions()
        out.use_area_weighting = True
        out.build(self._mesh, np.asfortranarray(positions), reach, self.min_distance)
        return out


def _entry_indices(parts: list[Any]) -> tuple[Array, Array]:
    """Rows and columns of the entries of sparse matrices."""
    found = [part.tocoo() for part in parts]
    return np.concatenate([each.row for each in found]), np.concatenate([each.col for each in found])
