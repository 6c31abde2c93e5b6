"""A preview as the page shows it: one mesh of the printed sheet, and the arrays of each stage on it."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from asterism.previews.session import Preview
from asterism.shape.blank_sheet import blank_sheet
from asterism.shape.pose import upright_rotation
from asterism.studio.messages import Frame, ShownMesh
from pattern.design.design import Design
from pattern.geometry.arrays import Floats, Ints
from pattern.geometry.planar import is_in_sorted, polygon_area
from pattern.layout.layout import Layout
from pattern.mesh.meshing import mesh_layout

COARSE_EDGE_SPACINGS = 1 / 6  # edges of the triangles while the sheet moves
FINE_EDGE_SPACINGS = 1 / 12  # and at rest
MAX_VERTICES_SHOWN = 30_000
STATIONS = 5  # along the ribbon of an arm
NEEDLE_SPACING = 1.0  # of the needles along supported edges, over that of the stars
CANDIDATE_TRIANGLES = 8  # with the nearest centroids, of which one holds a point


class SheetView:
    """The shown mesh of a print, and where the stages of a preview take it.

    Parameters
    ----------
    is_fine : with the edges for a sheet at rest.

    Attributes
    ----------
    rotation : (3, 3) from the pose of the shell to that shown.
    """

    def __init__(self, preview: Preview, is_fine: bool) -> None:
        self._number, self._is_fine = 0, is_fine
        self._arm_site = np.empty(0, dtype=np.uint32)
        layout, design = preview.sheet.layout, preview.design
        spacings = FINE_EDGE_SPACINGS if is_fine else COARSE_EDGE_SPACINGS
        shortest = float(np.sqrt(abs(polygon_area(layout.outline)) / (np.sqrt(0.75) * MAX_VERTICES_SHOWN)))
        edge = max(spacings * layout.spacing_mm, shortest)
        mesh = mesh_layout(layout, edge, design.mesh.kind, design.mesh.seed, draft=True)
        self.printed, self.triangles = mesh.points, mesh.triangles
        self._print = layout.outline, design.lattice
        self._follow(preview)

    def _follow(self, preview: Preview) -> None:
        """See the sheet of a preview that has the same outline and lattice."""
        self._space = preview.sheet.space
        self._lens = preview.lens(self.printed)
        self._arms_of: Layout | None = None
        self.rotation = np.eye(3)

    def shows(self, preview: Preview) -> bool:
        """Whether the mesh is one of the preview's sheet."""
        outline, lattice = self._print
        if preview.sheet.space is self._space:
            return True
        if lattice != preview.design.lattice or not np.array_equal(outline, preview.sheet.layout.outline):
            return False
        self._follow(preview)
        return True

    def has_arms_of(self, layout: Layout) -> bool:
        """Whether the mesh was numbered for a layout with arms at the same sites."""
        return self._number > 0 and np.array_equal(layout.star_number[layout.arm_star], self._arm_site)

    def numbered(self, number: int, layout: Layout) -> ShownMesh:
        """The message with the mesh, under a new number."""
        self._number, self._arm_site = number, layout.star_number[layout.arm_star].astype(np.uint32)
        return ShownMesh(
            mesh=number,
            printed=self.printed.astype(np.float32),
            triangles=self.triangles.astype(np.uint32),
            outline=outline_of(self.triangles).astype(np.uint32),
            arm_site=self._arm_site,
            is_fine=self._is_fine,
        )

    def stand_up(self, preview: Preview, x: Floats | None = None) -> None:
        """Choose the pose of a free sheet anew: principal axes along x, y and z. Later stages keep it."""
        self.rotation = np.eye(3)
        if preview.sheet.layout.pins:
            return
        positions = self._lens(x).bumpy
        self.rotation = upright_rotation(
            self.printed, positions, self._weights, self._triangle_normals(positions).sum(axis=0)
        )

    def frame(self, preview: Preview, seq: int, stage: str, x: Floats | None = None) -> Frame:
        """The arrays of a stage with positions x (N, 3) of the shell's dofs; by default what the preview shows."""
        layout, fabric = preview.sheet.layout, preview.design.fabric
        places = self._lens(x)
        positions = places.bumpy
        if not layout.pins:
            positions = (positions - self._weights @ positions) @ self.rotation.T
            positions[:, 2] -= positions[:, 2].min()
        normals = _unit(self._beside @ self._triangle_normals(positions))
        arms, arm_normals = self._ribbons(layout, positions, normals)
        stretch_x, stretch_y = fabric.stretch_xy
        small = np.float32
        return Frame(
            seq=seq,
            mesh=self._number,
            stage=stage,
            positions=positions.astype(small),
            normals=normals.astype(small),
            curvature=places.surface.mean_curvature.astype(small),
            strain=(places.surface.area * stretch_x * stretch_y - 1.0).astype(small),
            arms=arms.astype(small),
            arm_normals=arm_normals.astype(small),
            needles=self._needles(layout, positions).astype(small),
            is_minimum=preview.equilibrium.is_minimum,
            height_mm=float(np.ptp(positions[:, 2])),
        )

    def _ribbons(self, layout: Layout, positions: Floats, normals: Floats) -> tuple[Floats, Floats]:
        """(A, K, 2, 3) left and right upper edges of the arms, and (A, K, 3) normals."""
        if self._arms_of is None or not _has_same_arms(layout, self._arms_of):
            share = np.linspace(0.0, 1.0, STATIONS)[:, None]
            start = layout.centres[layout.arm_star][:, None]
            points = start + share * (layout.arm_tip[:, None] - start)
            self._stations, self._arms_of = self._interpolation(points.reshape(-1, 2)), layout
        shape = len(layout.arm_star), STATIONS, 3
        middle = (self._stations @ positions).reshape(shape)
        normal = _unit((self._stations @ normals).reshape(shape))
        across = _unit(np.cross(normal, np.gradient(middle, axis=1)))
        width, thickness = (_along(ends) for ends in (layout.arm_width, layout.arm_thickness))
        top = middle + thickness * normal
        return np.stack([top + 0.5 * width * across, top - 0.5 * width * across], axis=2), normal

    def _needles(self, layout: Layout, positions: Floats) -> Floats:
        """(N, 2, 3) foot on the ground and tip in the sheet; along supported edges one in each spacing."""
        printed = [layout.pin_points]
        for edge in layout.supported_edges.tolist():
            start, end = layout.outline[edge], layout.outline[(edge + 1) % len(layout.outline)]
            count = max(int(np.linalg.norm(end - start) / (NEEDLE_SPACING * layout.spacing_mm)), 1)
            printed.append(start + np.arange(count)[:, None] / count * (end - start))
        points = np.concatenate(printed)
        if not len(points):
            return np.empty((0, 2, 3))
        tips = self._interpolation(points) @ positions
        feet = tips.copy()
        feet[:, 2] = min(0.0, float(tips[:, 2].min()))
        return np.stack([feet, tips], axis=1)

    def _interpolation(self, points: Floats) -> sp.csr_matrix:
        """(n, V) linear interpolation from the vertices to printed points (n, 2)."""
        near = self._tree.query(points, k=min(CANDIDATE_TRIANGLES, len(self.triangles)))[1].reshape(len(points), -1)
        offset = points[:, None] - self.printed[self.triangles[near, 0]]
        rest = np.einsum("nkab,nkb->nka", self._inverse[near], offset)
        weights = np.concatenate([1.0 - rest.sum(axis=-1, keepdims=True), rest], axis=-1)
        best = weights.min(axis=-1).argmax(axis=1)
        row = np.arange(len(points))
        found = np.maximum(weights[row, best], 0.0)  # of points that lie a little outside
        found /= found.sum(axis=1, keepdims=True)
        corners = self.triangles[near[row, best]]
        return sp.csr_matrix(
            (found.ravel(), corners.ravel(), np.arange(0, 3 * len(points) + 1, 3)), (len(points), len(self.printed))
        )

    def _triangle_normals(self, positions: Floats) -> Floats:
        """(T, 3) normals, as long as twice the area."""
        a, b, c = positions[self.triangles].swapaxes(0, 1)
        return np.cross(b - a, c - a)

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.printed[self.triangles].mean(axis=1))

    @cached_property
    def _inverse(self) -> Floats:
        """(T, 2, 2) from a printed offset to two of the barycentric coordinates."""
        a, b, c = self.printed[self.triangles].swapaxes(0, 1)
        return np.linalg.inv(np.stack([b - a, c - a], axis=-1))

    @cached_property
    def _beside(self) -> sp.csr_matrix:
        """(V, T) ones where a vertex is a corner of a triangle."""
        count = len(self.triangles)
        entries = np.ones(3 * count), (self.triangles.ravel(), np.repeat(np.arange(count), 3))
        return sp.csr_matrix(entries, shape=(len(self.printed), count))

    @cached_property
    def _weights(self) -> Floats:
        """(V,) share of the printed sheet that each vertex stands for."""
        a, b, c = self.printed[self.triangles].swapaxes(0, 1)
        (ux, uy), (vx, vy) = (b - a).T, (c - a).T
        areas = self._beside @ (ux * vy - uy * vx)
        return np.asarray(areas / areas.sum())


def blank_messages(design: Design, number: int, seq: int) -> tuple[ShownMesh, Frame]:
    """The flat sheet of a design without stars: its mesh under a number, and its frame."""
    shape = blank_sheet(design)
    count, small = len(shape.printed), np.float32
    mesh = ShownMesh(
        mesh=number,
        printed=shape.printed.astype(small),
        triangles=shape.triangles.astype(np.uint32),
        outline=outline_of(shape.triangles).astype(np.uint32),
        arm_site=np.empty(0, dtype=np.uint32),
        is_fine=True,
    )
    frame = Frame(
        seq=seq,
        mesh=number,
        stage="equilibrium",
        positions=shape.positions.astype(small),
        normals=np.tile(np.array([0.0, 0.0, 1.0], dtype=small), (count, 1)),
        curvature=np.zeros(count, dtype=small),
        strain=np.zeros(count, dtype=small),
        arms=np.empty((0, STATIONS, 2, 3), dtype=small),
        arm_normals=np.empty((0, STATIONS, 3), dtype=small),
        needles=np.empty((0, 2, 3), dtype=small),
        is_minimum=True,
    )
    return mesh, frame


def outline_of(triangles: Ints) -> Ints:
    """(R,) vertices around a sheet of triangles (T, 3), counterclockwise.

    Examples
    --------
    >>> outline_of(np.array([[0, 1, 2], [0, 2, 3]])).tolist()
    [0, 1, 2, 3]
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    size = int(edges.max()) + 1
    there: Ints = edges[:, 0] * size + edges[:, 1]
    back: Ints = edges[:, 1] * size + edges[:, 0]
    rim = edges[~is_in_sorted(there, np.sort(back))]
    following = dict(rim.tolist())
    ring = [min(following)]
    while (after := following[ring[-1]]) != ring[0] and len(ring) < len(following):
        ring.append(after)
    return np.array(ring)


def _unit(vectors: Floats) -> Floats:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(length == 0.0, 1.0, length))


def _along(ends: Floats) -> Floats:
    """(A, K, 1) values at the stations of arms with values (A, 2) at both ends."""
    share = np.linspace(0.0, 1.0, STATIONS)
    return np.asarray(ends[:, :1] + share * (ends[:, 1:] - ends[:, :1]))[..., None]


def _has_same_arms(one: Layout, other: Layout) -> bool:
    return np.array_equal(one.arm_tip, other.arm_tip) and np.array_equal(one.centres, other.centres)
