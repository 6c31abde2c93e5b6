"""The shape of a sheet in space, with the summary of its computation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from io import BytesIO
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.normals import triangle_normals
from asterism.pattern.geometry.planar import off_sheet_mm, polygon_area
from asterism.pattern.geometry.point_location import locate
from asterism.pattern.layout.build import layout, sheet_outline
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.sheet_mesh import sheet_mesh
from asterism.results.records.exact import ExactRecord
from asterism.results.records.shape import PreviewRecord
from asterism.shape.surface import surface_triangle_areas, upright_rotation

if TYPE_CHECKING:
    from PIL import Image

    from asterism.draw.scene import View

AnyShapeRecord = ExactRecord | PreviewRecord


def shape_record(data: Mapping[str, Any]) -> AnyShapeRecord:
    """The record of a shape's summary; without the key `model` it counts as the exact model's."""
    if isinstance(data, ExactRecord | PreviewRecord):
        return data
    kind = PreviewRecord if data.get("model") == PreviewRecord.model_name else ExactRecord
    return kind.from_json(data)


class ShapeMesh(NamedTuple):
    """A sheet in space, in mm, as plain lists.

    Attributes
    ----------
    vertices : three coordinates each.
    faces : three numbers of vertices each, counterclockwise from the plastic side.
    arms : a polyline for each arm or drawn rod: points from the centre of the star to the tip.
    """

    vertices: list[list[float]]
    faces: list[list[int]]
    arms: list[list[list[float]]]


@dataclass(frozen=True)
class Shape:
    """A sheet in space, computed by the exact model or the preview.

    Attributes
    ----------
    printed : (V, 2) mm, printed coordinates of the vertices, on the stretched fabric.
    positions : (V, 3) mm, positions of the vertices in space.
    triangles : (T, 3), counterclockwise in print, so that normals point to the plastic side.
    star : (V,) number of the star whose centre is this vertex, -1 elsewhere.
    rods : for each arm an array of vertices, from the centre of the star to the tip.
    star_vertices : (S,) vertex at the centre of each star.
    point_fields : arrays (V,) or (V, 3) by name; three columns are a vector in space and turn with the sheet.
    cell_fields : arrays (T,) or (T, m) by name.
    rod_fields : arrays (R,) by name over the edges of all rods, in the order of `rod_edges`;
        `thickness_mm`, `width_mm`, `arm` and `star` among them.
    summary : record of `summary.json`; empty if the shape was read without it. A plain mapping becomes a record.
    others : further minima of the same design, if `simulate` ran with several starts.
    held : whether pins support the sheet. Then z points up. A free sheet is shown as its `aligned()` copy.
    plan : layout of the computation; None for shapes from files, see `layout`.
    """

    printed: Float[np.ndarray, "V 2"]
    positions: Float[np.ndarray, "V 3"]
    triangles: Int[np.ndarray, "T 3"]
    star: Int[np.ndarray, " V"]
    rods: tuple[Int[np.ndarray, " _"], ...]
    star_vertices: Int[np.ndarray, " S"]
    point_fields: Mapping[str, np.ndarray] = field(default_factory=dict)
    cell_fields: Mapping[str, np.ndarray] = field(default_factory=dict)
    rod_fields: Mapping[str, np.ndarray] = field(default_factory=dict)
    summary: AnyShapeRecord = field(default_factory=lambda: shape_record({}))
    others: tuple[Shape, ...] = ()
    held: bool = False
    plan: Layout | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "summary", shape_record(self.summary))
        count, triangles = len(self.printed), np.asarray(self.triangles)
        if np.shape(self.printed) != (count, 2) or np.shape(self.positions) != (count, 3):
            raise DesignError("positions", "must have the shape (V, 3), and printed (V, 2)")
        if triangles.shape[1:] != (3,) or not np.issubdtype(triangles.dtype, np.integer):
            raise DesignError("triangles", "must be whole numbers of the shape (T, 3)")
        if triangles.size and not 0 <= triangles.min() <= triangles.max() < count:
            raise DesignError("triangles", f"must be numbers of vertices from 0 to {count - 1}")

    @cached_property
    def layout(self) -> Layout | None:
        """The layout of the shape's design; None if the summary holds no design, or if its layout fails."""
        if self.plan is not None:
            return self.plan
        try:
            return layout(Design.from_dict(self.summary["design"]))
        except (KeyError, TypeError, DesignError):  # a shape made by hand, or whose image of sizes is missing
            return None

    @property
    def rod_edges(self) -> Ints:
        """(R, 2) vertices at the ends of each rod edge, rod by rod, from centre to tip."""
        edges = [np.column_stack([path[:-1], path[1:]]) for path in self.rods]
        return np.concatenate(edges) if edges else np.empty((0, 2), dtype=np.int64)

    @property
    def is_preview(self) -> bool:
        """Whether the preview computed the shape, not the exact model."""
        return isinstance(self.summary, PreviewRecord)

    @property
    def made_by(self) -> str:
        """The model that computed the shape: `by the preview` or `by the exact model`."""
        return "by the preview" if self.is_preview else "by the exact model"

    @property
    def height_mm(self) -> float:
        """Extent along z. For a free sheet, use the height of its `aligned()` copy."""
        return float(np.ptp(self.positions[:, 2]))

    @property
    def extent_mm(self) -> tuple[float, float, float]:
        """Size of the bounding box, in mm.

        For a supported sheet along x, y and z. For a free sheet along the axes of `aligned()`, the largest first, so
        that the result is independent of its pose.
        """
        if self.held:
            sizes = np.ptp(self.positions, axis=0)
        else:
            sizes = np.sort(np.ptp(self.positions @ self.upright.T, axis=0))[::-1]
        return float(sizes[0]), float(sizes[1]), float(sizes[2])

    def mesh(self) -> ShapeMesh:
        """The sheet as plain lists of numbers, for programs that draw meshes.

        Examples
        --------
        >>> corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        >>> rods = (np.array([0, 1]),)
        >>> shape = Shape(corners, np.eye(3), np.array([[0, 1, 2]]), np.full(3, -1), rods, np.array([0]))
        >>> shape.mesh().faces, shape.mesh().arms
        ([[0, 1, 2]], [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
        """
        arms = [self.positions[rod].tolist() for rod in self.rods]
        return ShapeMesh(self.positions.tolist(), self.triangles.tolist(), arms)

    def at(self, printed_points: Floats, off_sheet_mm: float = 0.0) -> Floats:
        """Positions in space of printed points, interpolated linearly within each triangle.

        Parameters
        ----------
        printed_points : (n, 2) mm, on the printed sheet.
        off_sheet_mm : points off the triangles by less are taken to them: a curved outline has chords.

        Returns
        -------
        (n, 3) mm.

        Raises
        ------
        ValueError
            A point is outside of the sheet.
        """
        points = np.atleast_2d(np.asarray(printed_points, dtype=float))
        triangle, weights = locate(self.printed, self.triangles, points, off_sheet_mm)
        return np.asarray(np.einsum("nk,nki->ni", weights, self.positions[self.triangles[triangle]]))

    def at_edges(self, printed_points: Floats) -> Floats:
        """(n, 3) mm, as `at`, of printed points (n, 2) mm that may be on edges: those off chords are taken to them."""
        area = float(surface_triangle_areas(self.printed, self.triangles).sum())
        return self.at(printed_points, off_sheet_mm(area, len(self.printed)))

    def picture(
        self,
        view: View = "oblique",
        size_px: tuple[int, int] = (1600, 1000),
        pixels_per_mm: float | None = None,
        plain: bool = False,
    ) -> Image.Image:
        """One view of the sheet as an image; parameters and errors as of `asterism.draw.picture.view_image`."""
        from asterism.draw.picture import view_image  # takes time, which most shapes do without

        return view_image(self, view, size_px, pixels_per_mm, plain, self._name)

    def _repr_png_(self) -> bytes:
        """What a notebook shows: the picture of `shape.png`."""
        from asterism.draw.picture import draw_shape

        stream = BytesIO()
        draw_shape(self, self._name, stream)
        return stream.getvalue()

    @property
    def _name(self) -> str:
        """Name of the design; empty if the summary holds none."""
        return str(self.summary.get("design", {}).get("name", ""))

    def aligned(self) -> Shape:
        """A copy with its centre at the origin and its principal axes along x, y, z, largest first, plastic side up."""
        rotation, weights = self.upright, self.weights
        turned = {
            name: values @ rotation.T if values.ndim == 2 and values.shape[1] == 3 else values
            for name, values in self.point_fields.items()
        }
        moved = (self.positions - weights @ self.positions) @ rotation.T
        return replace(self, positions=moved, point_fields=turned)

    @cached_property
    def upright(self) -> Floats:
        """(3, 3) rotation of `aligned()`; its rows are the principal axes."""
        plastic_side = triangle_normals(self.positions, self.triangles).sum(axis=0)
        return upright_rotation(self.printed, self.positions, self.weights, plastic_side)

    @cached_property
    def weights(self) -> Floats:
        """(V,) share of each vertex in the printed area; the sum is 1."""
        third = np.repeat(surface_triangle_areas(self.printed, self.triangles) / 3, 3)
        areas = np.bincount(self.triangles.ravel(), weights=third, minlength=len(self.printed))
        return np.asarray(areas / areas.sum())


def blank_sheet(design: Design) -> Shape:
    """The flat fabric of a design, released and free of its pins; its stars do not count.

    The shape has no summary. The edges of its triangles have about the spacing of the stars.

    Raises DesignError: the outline is not one of a sheet.

    Examples
    --------
    >>> design = Design.from_dict({"stars": {"length_mm": 0}, "border": {"rectangle_mm": [54, 27]}})
    >>> np.ptp(blank_sheet(design).positions, axis=0).round(1).tolist()
    [40.0, 20.0, 0.0]
    """
    corners = sheet_outline(design)
    shortest = float(np.sqrt(polygon_area(corners) / 20_000))
    edge = max(design.lattice.spacing_mm, shortest)
    mesh = sheet_mesh(corners, edge, np.empty((0, 2)), [])
    count = len(mesh.points)
    flat = np.column_stack([mesh.points / design.fabric.stretch_xy, np.zeros(count)])
    star = np.full(count, -1, dtype=np.int64)
    return Shape(mesh.points, flat, mesh.triangles, star, rods=(), star_vertices=np.empty(0, dtype=np.int64))
