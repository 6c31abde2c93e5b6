"""A periodic triangle mesh of a unit cell, unfolded to the points that its elements use.

**Elements** of the unfolded mesh are functions of the degrees of freedom of one cell. An unfolded point is
`R_u x_b + B (m1 p1 + m2 p2)`: its rotated base point, plus the macroscopic variables p1 and p2 for its lattice vectors.
On a flat cell R and B are identities, and p1, p2 are the images of the cell vectors. On a tube of given angles
(objective images) R_u rotates about the axis and B keeps the axial component: p1, p2 are axial shifts. The map is
linear, so the gradient of an element is `T^T g` and its Hessian `T^T H T`.

Rods are unfolded in one piece each, so their directors need no images. The joints at their ends do: an unfolded joint
has the frame `R_u F_j` of its base joint j, and spins by `R_u w` if that spins by w.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.spatial import Delaunay

from asterism.discrete.energies.elements import Elements
from asterism.equilibrium.arrays import Array, Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import mean_circumcentres, triangle_angles, triangle_areas

# of the spacing: ends of arms that are closer are one point
TOUCHING_TOLERANCE = 1e-6
# of the edge: points move by so much, to choose one of several Delaunay triangulations
TIE_BREAK_RATIO = 1e-6
# a cell and the eight around it, as numbers of lattice vectors; the cell itself is in the middle
CELLS_AROUND = np.array([[i, j] for i in (-1, 0, 1) for j in (-1, 0, 1)])


@dataclass(frozen=True)
class MeshPath:
    """A path over the points of a cell, along a rod."""

    point: Ints  # (n,) points
    image: Ints  # (n, 2) their images


def tiled(
    mesh: PeriodicTriangles, repeat: tuple[int, int], paths: list[MeshPath], surrounded: bool, of_stars: bool
) -> PeriodicMesh:
    """The mesh of n x m cells, with these arms on every star, or these rods in every cell; stars are at point 0.

    `surrounded`: with the triangles around, whose points are then unfolded too.
    """
    cells = np.array([[i, j] for i in range(repeat[0]) for j in range(repeat[1])])

    def in_all_cells(point: Ints, image: Ints) -> Ints:
        """(n m E, k, 3) base point and image of points (E, k) with images (E, k, 2)."""
        away, home = np.divmod(cells[:, None, None] + image, repeat)
        base = (home[..., 0] * repeat[1] + home[..., 1]) * len(mesh.points) + point
        return np.concatenate([base[..., None], away], axis=-1).reshape(-1, point.shape[1], 3)

    point, image = _pairs(mesh)
    # a hinge from either side is the same: that whose edge has the lower name
    there, back = mesh.edges()
    once = there < back
    from_base = image - image[:, :1]
    star = np.zeros((int(of_stars), 1), dtype=np.int64)
    parts = [(star, np.zeros((*star.shape, 2), dtype=np.int64)), (mesh.corner, mesh.image)]
    parts += [(point[once], from_base[once]), *((path.point[None], path.image[None]) for path in paths)]
    parts.append(_touching(mesh) if surrounded else (mesh.corner[:0], mesh.image[:0]))
    n_base = len(cells) * len(mesh.points)
    (stars, triangles, hinges, *rods, beside), base, away = _numbered([in_all_cells(*each) for each in parts], n_base)
    vectors = mesh.vectors * np.array(repeat)[:, None]
    points = (mesh.points + (cells @ mesh.vectors)[:, None]).reshape(-1, 2)
    return PeriodicMesh(
        points=points[base] + away @ vectors,
        base=base,
        image=away,
        triangles=triangles,
        around=new_triangles(beside, triangles),
        hinges=hinges,
        rods=tuple(rod for of_cell in zip(*rods, strict=True) for rod in of_cell),
        arm_star=np.repeat(np.arange(len(stars)), len(paths)),
        star_vertices=stars[:, 0],
        cell_vectors=vectors,
        n_base=n_base,
    )


def _touching(mesh: PeriodicTriangles) -> tuple[Ints, Ints]:
    """Points (M, 3) and images (M, 3, 2) of all triangles that share a point with a triangle of the cell."""
    at = mesh.corner.ravel()
    order = np.argsort(at, kind="stable")
    first = np.searchsorted(at[order], np.arange(len(mesh.points) + 1))
    count = np.diff(first)[at]
    own = np.repeat(np.arange(len(at)), count)  # a corner of the cell, once for each triangle at its point
    within = np.arange(len(own)) - np.repeat(np.cumsum(count) - count, count)
    other = order[first[at[own]] + within]
    step = mesh.image.reshape(-1, 2)[own] - mesh.image.reshape(-1, 2)[other]
    return mesh.corner[other // 3], mesh.image[other // 3] + step[:, None]


def _pairs(mesh: PeriodicTriangles) -> tuple[Ints, Ints]:
    """Points (3 T, 4) and images (3 T, 4, 2) of the edges of all triangles: two ends, left apex, right apex."""
    there, back = mesh.edges()
    order = np.argsort(there)
    twin = order[np.searchsorted(there[order], back)]
    turns = np.array([[0, 1, 2], [1, 2, 0], [2, 0, 1]])
    corner, image = mesh.corner[:, turns].reshape(-1, 3), mesh.image[:, turns].reshape(-1, 3, 2)
    # the twin's edge runs back: its second point is this one's first
    right = image[:, 0] + image[twin, 2] - image[twin, 1]
    return np.column_stack([corner, corner[twin, 2]]), np.concatenate([image, right[:, None]], axis=1)


@dataclass(frozen=True)
class PeriodicMesh:
    """A periodic mesh, unfolded: every point that an element uses is an image of a base point."""

    points: Floats  # (U, 2) mm of the print; the first `n_base` are the base points
    base: Ints  # (U,) base point of each point
    image: Ints  # (U, 2) numbers of cell vectors A1 and A2 from the base point to the point
    triangles: Ints  # (T, 3) counterclockwise, one of each class of images
    around: Ints  # (R, 3) images of triangles around those; none if the elements need no neighbours
    hinges: Ints  # (H, 4) edge, left apex, right apex; one of each class
    # paths of vertices along the arms, from the star's centre, each star in one piece; or along the rods of a motif,
    # cell by cell, each rod in one piece.
    rods: tuple[Ints, ...]
    arm_star: Ints  # (rods,) star of each arm; empty for a motif
    star_vertices: Ints  # (S,) centres of the stars; empty for a motif
    cell_vectors: Floats  # (2, 2) mm, rows
    n_base: int  # V

    @property
    def area(self) -> float:
        """mm^2 of the printed cell."""
        (a, b), (c, d) = self.cell_vectors
        return float(abs(a * d - b * c))


def _numbered(parts: list[Ints], n_base: int) -> tuple[list[Ints], Ints, Ints]:
    """Numbers of points that are given by base point and image (E, k, 3), part by part, and both by the number.

    The base points come first, then the images in the order in which the parts use them.
    """
    every = np.concatenate([part.reshape(-1, 3) for part in parts])
    is_image = every[:, 1:].any(axis=1)
    images, first, which = np.unique(every[is_image], axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    number = every[:, 0].copy()
    number[is_image] = n_base + np.argsort(order)[which.ravel()]
    base = np.concatenate([np.arange(n_base), images[order, 0]])
    away = np.pad(images[order, 1:], ((n_base, 0), (0, 0)))
    ends = np.cumsum([part.shape[0] * part.shape[1] for part in parts])[:-1]
    split = [own.reshape(part.shape[:2]) for own, part in zip(np.split(number, ends), parts, strict=True)]
    return split, base, away


def new_triangles(some: Ints, known: Ints) -> Ints:
    """The triangles (n, 3) of `some` that are not among the known ones, each once."""
    every = np.concatenate([known, some])
    first = np.unique(np.sort(every, axis=1), axis=0, return_index=True)[1]
    return every[np.sort(first[first >= len(known)])]


@dataclass(frozen=True)
class PeriodicTriangles:
    """One triangle of each class of images, counterclockwise."""

    points: Floats  # (N, 2) mm
    vectors: Floats  # (2, 2) mm, lattice vectors as rows
    corner: Ints  # (T, 3) points
    image: Ints  # (T, 3, 2) numbers of lattice vectors to the image of each corner

    @cached_property
    def places(self) -> Floats:
        """(3 T, 2) mm, all corners."""
        return self.points[self.corner.ravel()] + self.image.reshape(-1, 2) @ self.vectors

    @cached_property
    def areas(self) -> Floats:
        """(T,) mm^2."""
        return triangle_areas(self.places, self._alone)

    @cached_property
    def angles(self) -> Floats:
        """(T, 3) degrees."""
        return triangle_angles(self.places, self._alone)

    @cached_property
    def circumcentres(self) -> Floats:
        """(T, 2) mm."""
        return mean_circumcentres(self.places, self._alone)[::3]

    @property
    def _alone(self) -> Ints:
        return np.arange(3 * len(self.corner)).reshape(-1, 3)

    def smoothed(self) -> Floats:
        """(N, 2) mm, mean circumcentre at each point (see `pattern.geometry.planar.mean_circumcentres`)."""
        centre = np.repeat(self.circumcentres, 3, axis=0) - self.image.reshape(-1, 2) @ self.vectors
        at, weight = self.corner.ravel(), np.repeat(self.areas, 3)
        total = np.bincount(at, weight, len(self.points))
        return np.column_stack([np.bincount(at, weight * x, len(self.points)) / total for x in centre.T])

    def edges(self) -> tuple[Ints, Ints]:
        """(3 T,) names of the edges 0-1, 1-2 and 2-0 of all triangles, and of the reversed edges.

        Raises `MeshError` if the triangles do not close to a torus: some edge lacks a triangle on one side.
        """
        a, b = self.corner, np.roll(self.corner, -1, axis=1)
        step = np.roll(self.image, -1, axis=1) - self.image
        there, back = self.name(a, b, step).ravel(), self.name(b, a, -step).ravel()
        if len(np.unique(there)) < len(there) or not np.isin(back, there).all():
            raise MeshError("the triangles do not close to a torus")
        return there, back

    def name(self, a: Ints, b: Ints, step: Ints) -> Ints:
        """Names of edges from point a to the image `step` (..., 2) of point b."""
        return np.asarray(((a * len(self.points) + b) * 9 + step[..., 0] + 4) * 9 + step[..., 1] + 4)


def periodic_delaunay(points: Floats, vectors: Floats, edge_mm: float, group: Floats) -> PeriodicTriangles:
    """Delaunay triangles of the points (N, 2) of one cell; N is at least 3.

    Of several Delaunay triangulations the result depends on the numbers of the points only. With a point group of more
    than one element it is a symmetric one, wherever that is possible. Raises `MeshError` if the points leave a hole of
    several edges.
    """
    inverse = np.linalg.inv(vectors)
    if len(group) == 1:
        tie = TIE_BREAK_RATIO * edge_mm * np.random.default_rng(0).normal(size=points.shape)
    else:
        tie = TIE_BREAK_RATIO * edge_mm * _symmetric_field(points, vectors, group)
    base = np.tile(np.arange(len(points)), len(CELLS_AROUND))
    image = np.repeat(CELLS_AROUND, len(points), axis=0)
    copies = points[base] + image @ vectors
    # margin around the cell from which images come, in edges
    margin = 4.0 * edge_mm * np.linalg.norm(inverse, axis=0)
    near = (np.abs(copies @ inverse - 0.5) < 0.5 + margin).all(axis=1)
    base, image, copies = base[near], image[near], copies[near]
    simplices = Delaunay(copies + tie[base]).simplices
    turned = triangle_areas(copies, simplices) < 0.0
    simplices[turned] = simplices[turned][:, ::-1]
    # of the images of a triangle, that whose first corner is a base point; first by number, then by image
    order = (base * 3 + image[:, 0] + 1) * 3 + image[:, 1] + 1
    first = simplices[np.arange(len(simplices)), order[simplices].argmin(axis=1)]
    own = simplices[(image[first] == 0).all(axis=1)]
    triangles = PeriodicTriangles(points, vectors, base[own], image[own])
    area = abs(np.linalg.det(vectors))
    if not (len(own) == 2 * len(points) and abs(triangles.areas.sum() - area) < 1e-9 * area):
        raise MeshError("the points of the cell leave a hole")
    return triangles


def _symmetric_field(points: Floats, vectors: Floats, group: Floats) -> Floats:
    """(N, 2) an irregular vector field that the lattice and the group map onto itself, at points (N, 2)."""
    fraction = np.einsum("gij,nj->gni", group, points) @ np.linalg.inv(vectors)
    phase = 2.0 * np.pi * fraction @ np.array([[3, 5, 7], [7, -4, 2]])
    waves = np.sin(phase + np.array([0.3, 1.7, 4.1]))
    field = waves @ np.random.default_rng(0).normal(size=(3, 2)) @ vectors / np.linalg.norm(vectors[0])
    return np.asarray(np.einsum("gji,gnj->ni", group, field))


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
