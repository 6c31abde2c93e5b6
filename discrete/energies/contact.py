"""Self-contact of the sheet: a barrier between parts of its middle surface that come close.

The barrier is that of incremental potential contact (Li et al. 2020), computed by the IPC Toolkit, weighted by area and
in physical units (Li et al. 2023): the modulus times a sum over pairs of vertices, edges and triangles, weighted by
their areas. All kinds of pairs count, so layers that lie triangle on triangle are stiffer than shifted layers. The
barrier begins at one thickness between two middle surfaces and is infinite at half a thickness, since fabric is soft.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Array
from asterism.pattern.design.errors import DesignError
from asterism.pattern.mesh.mesh import Mesh

# 1: printed distance up to which two parts are neighbours, over the longest edge plus the contact distance
NEIGHBOUR_DISTANCE_FACTOR = 1.5


def ipc_toolkit() -> Any:
    """The package `ipctk`. Raises `DesignError` if the package is not installed."""
    try:
        import ipctk
    except ImportError:
        raise DesignError("solver.contact", "needs the package ipctk: pip install ipctk") from None
    ipctk.set_logger_level(ipctk.critical)  # otherwise it writes to standard output
    ipctk.set_num_threads(1)  # several threads add in any order, and results would differ in their last digits
    return ipctk


class ContactBarrier:
    """Barrier between all parts of a sheet that are not neighbours.

    Parts are neighbours if their printed distance is below NEIGHBOUR_DISTANCE_FACTOR times the longest edge plus the
    contact distance. Neighbours are never in contact: the mesh may be finer than the fabric is thick, and bending alone
    governs folds with a radius of about one thickness.

    Parameters
    ----------
    mesh : mesh of the printed sheet.
    distance : mm, distance of the middle surfaces at which contact begins.
    stretch : largest stretch of the print.
    modulus : MPa, Young's modulus of the fabric: it scales the pressure.
    """

    def __init__(self, mesh: Mesh, distance: float, stretch: float, modulus: float) -> None:
        self._ipc = ipc_toolkit()
        # mm, distance of two middle surfaces at which the energy is infinite
        self.distance, self.min_distance = distance, 0.5 * distance
        self._barrier_width = distance - self.min_distance
        triangles = mesh.triangles.astype(np.int32)
        edges = self._ipc.edges(triangles).astype(np.int32)
        printed = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
        longest = float(np.linalg.norm(printed[edges[:, 1]] - printed[edges[:, 0]], axis=1).max())
        # mm, printed distance below which parts are neighbours
        self.neighbour_distance = NEIGHBOUR_DISTANCE_FACTOR * (longest + stretch * distance)
        self._mesh = self._ipc.CollisionMesh(*(np.asfortranarray(a) for a in (printed, edges, triangles)))
        pairs = np.sort(cKDTree(mesh.points).query_pairs(self.neighbour_distance, output_type="ndarray"), axis=1)
        number = np.arange(len(mesh.points)).astype(object)  # pairs share one object for each vertex, to save memory
        excluded = dict.fromkeys(zip(*number[pairs.T], strict=True), False)
        self._mesh.can_collide = self._ipc.make_sparse_filter(excluded, True)
        self._potential = self._ipc.BarrierPotential(self._barrier_width, modulus, True)
        # energy, gradient and Hessian are evaluated one after the other at the same positions
        self._collision_cache: tuple[Array | None, Any] = None, None
        self._hessian_cache: tuple[Array | None, list[Any]] = None, []

    def energy(self, positions: Array) -> float:
        """N mm, at positions (V, 3) mm; infinite if parts are closer than `min_distance`."""
        if not np.isfinite(positions).all():
            return float("inf")
        return float(self._potential(self._active_pairs(positions), self._mesh, np.asfortranarray(positions)))

    def gradient(self, positions: Array) -> Array:
        """(3 V,) N, gradient at positions (V, 3) mm."""
        return np.asarray(
            self._potential.gradient(self._active_pairs(positions), self._mesh, np.asfortranarray(positions))
        )

    def hessian(self, positions: Array, blend: float) -> tuple[Array, Array, Array]:
        """Rows, columns and values (K,) in N/mm of the Hessian over 3 V dofs.

        `blend` 0 is the exact Hessian, 1 the positive semidefinite one (each pair projected).
        """
        weighted = zip((1.0 - blend, blend), self._hessians(positions), strict=True)
        total = sum(weight * part for weight, part in weighted if weight > 0.0).tocoo()
        return total.row, total.col, total.data

    def hessian_pattern(self, positions: Array) -> tuple[Array, Array]:
        """Rows and columns of the entries of both Hessians; the toolkit leaves out different zeros of each."""
        return _entry_indices(self._hessians(positions))

    def hessian_pattern_nearby(self, positions: Array) -> tuple[Array, Array]:
        """Rows and columns of the entries as if contact began at twice the distance."""
        wide = 2.0 * self.distance - self.min_distance
        potential = self._ipc.BarrierPotential(wide, 1.0, True)
        return _entry_indices(self._exact_and_projected(potential, self._collisions(positions, wide), positions))

    def _hessians(self, positions: Array) -> list[Any]:
        """The exact and the positive semidefinite Hessian, computed once for the same positions."""
        cached_positions, hessians = self._hessian_cache
        if cached_positions is not positions:
            hessians = self._exact_and_projected(self._potential, self._active_pairs(positions), positions)
            self._hessian_cache = positions, hessians
        return hessians

    def _exact_and_projected(self, potential: Any, pairs: Any, positions: Array) -> list[Any]:
        method, x = self._ipc.PSDProjectionMethod, np.asfortranarray(positions)
        return [potential.hessian(pairs, self._mesh, x, each) for each in (method.NONE, method.CLAMP)]

    def collision_free_fraction(self, positions: Array, target: Array) -> float:
        """Largest fraction of the straight step to `target` (V, 3) mm without contact at `min_distance`; at most 1."""
        step = (np.asfortranarray(x) for x in (positions, target))
        # additive CCD (Li et al. 2021) is safe after any number of iterations; other methods may not end in flat sheets
        search = self._ipc.AdditiveCCD(max_iterations=1000)
        return float(
            self._ipc.compute_collision_free_stepsize(self._mesh, *step, self.min_distance, narrow_phase_ccd=search)
        )

    def is_intersection_free(self, positions: Array) -> bool:
        """No parts intersect, and no two are closer than `min_distance`."""
        free = not self._ipc.has_intersections(self._mesh, np.asfortranarray(positions))
        return free and bool(np.isfinite(self.energy(positions)))

    def pairs_and_gap(self, positions: Array) -> tuple[int, float]:
        """Number of pairs of vertices, edges and triangles in contact, and the smallest distance of a pair in mm."""
        pairs = self._active_pairs(positions)
        if len(pairs) == 0:
            return 0, float("inf")
        smallest_squared = pairs.compute_minimum_distance(self._mesh, np.asfortranarray(positions))
        return len(pairs), float(np.sqrt(smallest_squared))

    def _active_pairs(self, positions: Array) -> Any:
        """Pairs in contact, found once for the same positions."""
        cached_positions, pairs = self._collision_cache
        if cached_positions is not positions:
            pairs = self._collisions(positions, self._barrier_width)
            self._collision_cache = positions, pairs
        return pairs

    def _collisions(self, positions: Array, reach: float) -> Any:
        out = self._ipc.NormalCollisions()
        out.use_area_weighting = True
        out.build(self._mesh, np.asfortranarray(positions), reach, self.min_distance)
        return out


def _entry_indices(parts: list[Any]) -> tuple[Array, Array]:
    """Rows and columns of the entries of sparse matrices."""
    entries = [part.tocoo() for part in parts]
    return np.concatenate([each.row for each in entries]), np.concatenate([each.col for each in entries])
