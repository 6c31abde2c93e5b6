"""Distance of two shapes of one design, at the same printed points.

Supported sheets are compared as their supports hold them in space. Only rigid motions that the supports leave free are
taken out: all of them for a free sheet, the rotations about a single point, none where supports fix three points.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from asterism.equilibrium.arrays import Floats
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.geometry.normals import triangle_normals, vertex_normals
from asterism.pattern.geometry.planar import distance_to_outline
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.free_motions import free_motions
from asterism.pattern.layout.layout import Layout, off_curves_mm
from asterism.pattern.layout.roll_axis import roll_axis_from_normals
from asterism.pattern.layout.supports import SupportSamples
from asterism.pattern.layout.symmetries import Symmetry
from asterism.results.records.verification import DifferenceRecord
from asterism.shape.measures import CellMean, sample_vertices, tube_radius
from asterism.shape.shape import Shape
from asterism.shape.surface import border_of


@dataclass(frozen=True)
class Comparison:
    """A shape laid on a reference shape by the motions that its supports leave free, and the distances after these.

    The bumps of the stars are not part of a smooth surface. Therefore surfaces are compared by their means over a
    lattice cell (`CellMean`). Star centres are compared as they are.

    Attributes
    ----------
    reference : the shape that counts as right; lengths in % are of its diameter.
    other : the other shape's image under `symmetry`, laid on the reference, without fields of the sheet.
    layout : what was printed.
    symmetry : of the design; the compared shape stands for all its images, and this is the nearest one.
    reference_mean, other_mean : (V, 3) mm, cell means at the vertices of the reference.
    free_motions : number of independent rigid motions that the supports leave free, from 0 to 6.
    diameter_mm : of the reference, the largest distance of two of its points.
    whole : (V,) whether the cell around a vertex is not cut by the outline.
    mean : the cell means of the reference's mesh, for further comparisons with it.
    """

    reference: Shape
    other: Shape
    layout: Layout
    symmetry: Symmetry
    reference_mean: Floats
    other_mean: Floats
    free_motions: int
    diameter_mm: float
    whole: NDArray[np.bool_]
    mean: CellMean

    @cached_property
    def distance_mm(self) -> Floats:
        """(V,) between the cell means at the vertices of the reference."""
        return np.asarray(np.linalg.norm(self.other_mean - self.reference_mean, axis=1))

    @cached_property
    def star_distance_mm(self) -> Floats:
        """(S,) between star centres, or between the sites of a drawing's lattice."""
        centres, off = self.layout.sample_points, 0.0 if self.layout.has_stars else self.layout.spacing_mm
        return np.asarray(np.linalg.norm(self.other.at(centres, off) - self.reference.at(centres, off), axis=1))

    @property
    def rms_percent(self) -> float:
        """Root mean square over the printed area of the distance of the cell means, in % of the diameter."""
        return self._percent(math.sqrt(self.reference.weights @ self.distance_mm**2))

    @cached_property
    def record(self) -> DifferenceRecord:
        """The numbers of the comparison: errors of the other shape relative to the reference; None if undefined."""
        shapes, means = (self.reference, self.other), (self.reference_mean, self.other_mean)
        weights, stars = self.reference.weights, sample_vertices(self.layout, self.reference)
        normals = [vertex_normals(mean, self.reference.triangles) for mean in means]
        axes = _roll_axes(self.layout, [each[stars] for each in normals])
        radii: list[float | None] = [None]
        if None not in axes:
            radii = [tube_radius(mean[stars], each[stars]) for mean, each in zip(means, normals, strict=True)]
        heights = [float(np.ptp(shape.positions[:, 2])) for shape in shapes]
        volumes = [self._volume(mean) for mean in means] if axes == [None, None] else None
        pairs = {
            "height_error_percent": heights,
            "mean_height_error_percent": [float(np.ptp(mean[:, 2])) for mean in means],
            "rise_error_percent": self._rises(),
            "volume_error_percent": volumes,
            "roll_radius_error_percent": None if None in radii else radii,
        }
        rotation, shift = rigid_fit(self.other_mean, self.reference_mean, weights)
        gaps = self.other_mean @ rotation.T + shift - self.reference_mean
        # the arc cosine would lose all digits for small angles
        apart, along = (np.linalg.norm(normals[0] + sign * normals[1], axis=1) for sign in (-1, 1))
        angle = 2.0 * np.arctan2(apart, along)
        return DifferenceRecord.from_json(
            {name: pair and _relative(*pair) for name, pair in pairs.items()}
            | {
                "rms_mm": math.sqrt(weights @ self.distance_mm**2),
                "max_mm": float(self.distance_mm.max()),
                "rms_percent": self.rms_percent,
                "max_percent": self._percent(self.distance_mm.max()),
                "rms_after_motion_percent": self._percent(math.sqrt(weights @ (gaps**2).sum(axis=1))),
                "free_motions": self.free_motions,
                "rms_stars_percent": self._percent(np.sqrt((self.star_distance_mm**2).mean())),
                "max_stars_percent": self._percent(self.star_distance_mm.max()),
                "diameter_mm": self.diameter_mm,
                "heights_mm": heights,
                "relief_error_percent": self._relief_error_percent(),
                "rises_mm": pairs["rise_error_percent"],
                "volumes_mm3": volumes,
                "roll_radii_mm": pairs["roll_radius_error_percent"],
                "roll_axes_deg": axes,
                "normals_rms_deg": float(np.degrees(np.sqrt(weights @ angle**2))),
                "mirrored": self.symmetry.mirrors,
            }
        )

    def _rises(self) -> list[float] | None:
        """mm; None where nothing is held, or a single point."""
        sides = self.layout.supported_edges
        ends = np.unique(np.concatenate([sides, self.layout.edges.following[sides]]))
        held = np.concatenate([self.layout.pin_points, self.layout.edges.start[ends]])
        if len(held) < 2:
            return None
        own, others = (
            shape.positions[:, 2] - self._at(shape, held)[:, 2].mean() for shape in (self.reference, self.other)
        )
        side = 1.0 if own.max() >= -own.min() else -1.0
        return [float((side * own).max()), float((side * others).max())]

    def _relief_error_percent(self) -> float | None:
        """The relief is what the cell means leave of the surfaces, where cells are not cut; None without a relief."""
        weights, own = self.reference.weights * self.whole, self.reference.positions - self.reference_mean
        size = float((weights @ own**2).sum())
        if size == 0.0:
            return None
        other = self._at(self.other, self.reference.printed) - self.other_mean
        return float(100.0 * np.sqrt((weights @ (other - own) ** 2).sum() / size))

    def _at(self, shape: Shape, printed: Floats) -> Floats:
        return shape.at(printed, off_curves_mm(self.layout, len(shape.printed)))

    def _percent(self, length: float) -> float:
        return float(100.0 * length / self.diameter_mm)

    def _volume(self, mean: Floats) -> float:
        """mm^3 between a surface and the level of its outline."""
        triangles = self.reference.triangles
        on_outline = border_of(triangles, len(mean))
        if self.layout.holes:
            rims = [distance_to_outline(self.reference.printed, ring) for ring in self.layout.edges.rings]
            on_outline &= np.argmin(rims, axis=0) == 0
        level = mean[on_outline, 2].mean()
        over_ground = triangle_normals(mean, triangles)[:, 2] / 2
        return float((mean[triangles, 2].mean(axis=1) - level) @ over_ground)


def _roll_axes(layout: Layout, normals: Sequence[Floats]) -> list[float | None]:
    """Axes in print coordinates about which two sheets are rolled; None: not rolled.

    Beside one that is, a sheet that is almost rolled counts as rolled: where that begins must not part two alike.
    """
    axes = [roll_axis_from_normals(layout, each) for each in normals]
    if None not in axes or axes == [None, None]:
        return axes
    return [
        roll_axis_from_normals(layout, each, almost=True) if axis is None else axis
        for each, axis in zip(normals, axes, strict=True)
    ]


def compare_shapes(
    reference: Shape,
    other: Shape,
    layout: Layout,
    symmetries: Sequence[Symmetry],
    gravity: Sequence[float] | None = None,
    mean: CellMean | None = None,
) -> Comparison:
    """Lay a shape on a reference: free motions, and the symmetry of the design that brings it nearest.

    Parameters
    ----------
    reference, other : two shapes of the same design, on any meshes.
    layout : of the design. Its supports say which rigid motions are free.
    symmetries : of the design, from `pattern.layout.symmetries`. Symmetries turn the print, and so a mirrored one
        reflects the other shape in space too; otherwise it is only ever turned and shifted.
    gravity : (3,) its direction if the sheet has weight: then no free motion changes how the sheet hangs.
    mean : cell means of another comparison, which saves their preparation if it is on the same mesh.

    Raises ValueError: if the other shape does not cover the reference's printed points.

    References
    ----------
    Kabsch 1976 for free sheets, weights: printed area; `pattern.layout.free_motions` for supported ones.
    """
    supports, off_sheet = layout.support_samples, off_curves_mm(layout, len(other.printed))
    symmetry = _nearest(reference, other, symmetries, supports, gravity, off_sheet)
    if mean is None or not mean.serves(reference.printed, reference.weights):
        mean = CellMean(reference.printed, reference.weights, layout.lattice_vectors)
    reference_mean = mean(reference.positions)
    near = image(other, symmetry)
    near_mean = mean(near.at(reference.printed, off_sheet))
    free = free_motions(supports, near.at(supports.printed, off_sheet), gravity)
    rotation, shift = free.fit(near_mean, reference_mean, reference.weights)
    # the outline cuts a cell if the cell's centroid is further than this from its point, in spacings
    return Comparison(
        reference,
        replace(near, positions=near.positions @ rotation.T + shift),
        layout,
        symmetry,
        reference_mean,
        near_mean @ rotation.T + shift,
        free.count,
        diameter(reference.positions),
        np.linalg.norm(mean(reference.printed) - reference.printed, axis=1) < 0.01 * layout.spacing_mm,
        mean,
    )


def _relative(right: float, other: float) -> float | None:
    """Relative error in %; None if the reference value is zero."""
    return None if abs(right) < 1e-9 else 100.0 * (other - right) / right


def image(shape: Shape, symmetry: Symmetry) -> Shape:
    """The image of a shape under a symmetry of its design, on the same supports, without fields of the sheet."""
    # a shape need not have a vertex at every star
    star_vertices = shape.star_vertices[symmetry.star] if len(shape.star_vertices) else shape.star_vertices
    numbers = shape.star[shape.star_vertices]
    star = np.full(len(shape.printed), -1, dtype=np.int64)
    star[star_vertices] = numbers
    rod_fields = dict(shape.rod_fields)
    if "star" in rod_fields and len(star_vertices):  # whose arm an edge is now
        of = dict(zip(shape.star[star_vertices].tolist(), numbers.tolist(), strict=True))
        rod_fields["star"] = np.array([of[number] for number in rod_fields["star"].tolist()], dtype=np.int64)
    return Shape(
        printed=(shape.printed - symmetry.shift) @ symmetry.turn,
        positions=symmetry.in_space(shape.positions),
        triangles=shape.triangles[:, ::-1] if symmetry.mirrors else shape.triangles,
        star=star,
        rods=shape.rods,
        star_vertices=star_vertices,
        rod_fields=rod_fields,
        summary=shape.summary,
        held=shape.held,
        plan=shape.plan,
    )


def _nearest(
    reference: Shape,
    other: Shape,
    symmetries: Sequence[Symmetry],
    supports: SupportSamples,
    gravity: Sequence[float] | None,
    off_sheet_mm: float,
) -> Symmetry:
    """The symmetry whose image is nearest to the reference; all images have the same bumps, which need no mean."""
    # at most about twice this many vertices are used to choose the nearest symmetric image
    some = slice(None, None, max(len(reference.printed) // 500, 1))
    printed, places = reference.printed[some], reference.positions[some]

    def off(symmetry: Symmetry) -> float:
        there, supported = (
            symmetry.in_space(other.at(points @ symmetry.turn.T + symmetry.shift, off_sheet_mm))
            for points in (printed, supports.printed)
        )
        rotation, shift = free_motions(supports, supported, gravity).fit(there, places)
        return float(((there @ rotation.T + shift - places) ** 2).sum())

    return min(symmetries, key=off)
