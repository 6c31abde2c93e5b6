"""Distance of two shapes of one design, at the same printed points.

Supported sheets are compared as their supports hold them in space. Only rigid motions that the supports leave free are
taken out: all of them for a free sheet, the rotations about a single point, none where supports fix three points.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.geometry.normals import triangle_normals, vertex_normals
from asterism.pattern.geometry.planar import distance_to_outline
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.free_motions import free_motions
from asterism.pattern.layout.layout import Layout, off_curves_mm
from asterism.pattern.layout.roll_axis import roll_axis_from_normals
from asterism.pattern.layout.supports import SupportSamples
from asterism.pattern.layout.symmetries import Symmetry
from asterism.results.record import keys_of
from asterism.results.records.verification import DifferenceRecord
from asterism.shape.cell_mean import CellMean
from asterism.shape.measures import sample_vertices, tube_radius
from asterism.shape.shape import Shape
from asterism.shape.surface_fields import border_of


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

    @cached_property
    def record(self) -> DifferenceRecord:
        """The numbers of the comparison: errors of the other shape relative to the reference; None if undefined."""
        pairs = {
            "height_error_percent": self.heights_mm,
            "mean_height_error_percent": self.mean_heights_mm,
            "rise_error_percent": self.rises_mm,
            "volume_error_percent": self.volumes_mm3,
            "roll_radius_error_percent": self.roll_radii_mm,
        }
        known: dict[str, Any] = {name: pair and _relative(*pair) for name, pair in pairs.items()}
        known["mirrored"] = self.symmetry.mirrors
        others = {name: getattr(self, name) for name in keys_of(DifferenceRecord) if name not in known}
        return DifferenceRecord.from_json(known | others)

    @property
    def rms_mm(self) -> float:
        """Root mean square over the printed area of the distance of the cell means."""
        return math.sqrt(self.reference.weights @ self.distance_mm**2)

    @property
    def max_mm(self) -> float:
        """Largest distance of the cell means."""
        return float(self.distance_mm.max())

    @property
    def rms_percent(self) -> float:
        """`rms_mm` in % of the diameter."""
        return self._percent(self.rms_mm)

    @property
    def max_percent(self) -> float:
        """`max_mm` in % of the diameter."""
        return self._percent(self.max_mm)

    @cached_property
    def rms_after_motion_percent(self) -> float:
        """`rms_percent` after the best of all rigid motions: of one form that has swung on its supports it is small."""
        weights = self.reference.weights
        rotation, shift = rigid_fit(self.other_mean, self.reference_mean, weights)
        gaps = self.other_mean @ rotation.T + shift - self.reference_mean
        return self._percent(math.sqrt(weights @ (gaps**2).sum(axis=1)))

    @property
    def rms_stars_percent(self) -> float:
        """Root mean square over the star centres."""
        return self._percent(np.sqrt((self.star_distance_mm**2).mean()))

    @property
    def max_stars_percent(self) -> float:
        """Largest distance of two star centres."""
        return self._percent(self.star_distance_mm.max())

    @cached_property
    def heights_mm(self) -> tuple[float, float]:
        """Extents along z of the whole shapes, bumps and all."""
        return float(np.ptp(self.reference.positions[:, 2])), float(np.ptp(self.other.positions[:, 2]))

    @cached_property
    def rises_mm(self) -> tuple[float, float] | None:
        """From the mean level of what is held to the furthest point on the reference's higher side, bumps and all.

        None where nothing is held, or a single point.
        """
        held = _held(self.layout)
        if len(held) < 2:
            return None
        level = self._at(self.reference, held)[:, 2].mean()
        own = self.reference.positions[:, 2] - level
        side = 1.0 if own.max() >= -own.min() else -1.0
        others = self.other.positions[:, 2] - self._at(self.other, held)[:, 2].mean()
        return float((side * own).max()), float((side * others).max())

    @cached_property
    def mean_heights_mm(self) -> tuple[float, float]:
        """Extents along z of the cell means."""
        return float(np.ptp(self.reference_mean[:, 2])), float(np.ptp(self.other_mean[:, 2]))

    @cached_property
    def relief_error_percent(self) -> float | None:
        """Root mean square of the distance of the two reliefs, what the cell means leave of the surfaces, in % of that
        of the reference's own; over the printed area whose cells are not cut. None without a relief."""
        weights, own = self.reference.weights * self.whole, self.reference.positions - self.reference_mean
        size = float((weights @ own**2).sum())
        if size == 0.0:
            return None
        other = self._at(self.other, self.reference.printed) - self.other_mean
        return float(100.0 * np.sqrt((weights @ (other - own) ** 2).sum() / size))

    @cached_property
    def roll_axes_deg(self) -> tuple[float | None, float | None]:
        """Axes about which the sheets are rolled in print coordinates; None: not rolled.

        Beside one that is, a sheet that is almost rolled counts as rolled: where that begins must not part two alike.
        """
        axes = [roll_axis_from_normals(self.layout, normals) for normals in self._normals]
        nearly = None in axes and axes != [None, None]
        one, other = (
            roll_axis_from_normals(self.layout, normals, almost=True) if nearly and axis is None else axis
            for normals, axis in zip(self._normals, axes, strict=True)
        )
        return one, other

    @cached_property
    def _normals(self) -> tuple[Floats, Floats]:
        """(S, 3) of the cell means, at the stars."""
        one, other = self._vertex_normals
        return one[self._star_vertices], other[self._star_vertices]

    @cached_property
    def _vertex_normals(self) -> tuple[Floats, Floats]:
        """(V, 3) of the cell means."""
        triangles = self.reference.triangles
        return vertex_normals(self.reference_mean, triangles), vertex_normals(self.other_mean, triangles)

    @cached_property
    def roll_radii_mm(self) -> tuple[float, float] | None:
        """Radii of the tubes nearest to the star centres' cell means; None unless both are rolled, and are tubes."""
        if None in self.roll_axes_deg:
            return None
        one, other = (
            tube_radius(mean[self._star_vertices], normals)
            for mean, normals in zip((self.reference_mean, self.other_mean), self._normals, strict=True)
        )
        return None if one is None or other is None else (one, other)

    @cached_property
    def volumes_mm3(self) -> tuple[float, float] | None:
        """Between the cell means and the level of their outlines; None where a sheet is rolled."""
        if self.roll_axes_deg != (None, None):
            return None
        return self._volume(self.reference_mean), self._volume(self.other_mean)

    @cached_property
    def normals_rms_deg(self) -> float:
        """Root mean square angle of the normals of the cell means, over the printed area."""
        one, other = self._vertex_normals
        # the arc cosine would lose all digits for small angles
        angle = 2.0 * np.arctan2(np.linalg.norm(one - other, axis=1), np.linalg.norm(one + other, axis=1))
        return float(np.degrees(np.sqrt(self.reference.weights @ angle**2)))

    @cached_property
    def _star_vertices(self) -> Ints:
        return sample_vertices(self.layout, self.reference)

    def _at(self, shape: Shape, printed: Floats) -> Floats:
        return shape.at(printed, off_curves_mm(self.layout, len(shape.printed)))

    def _percent(self, length: float) -> float:
        return float(100.0 * length / self.diameter_mm)

    def _volume(self, mean: Floats) -> float:
        triangles = self.reference.triangles
        on_outline = border_of(triangles, len(mean))
        if self.layout.holes:
            rims = [distance_to_outline(self.reference.printed, ring) for ring in self.layout.edges.rings]
            on_outline &= np.argmin(rims, axis=0) == 0
        level = mean[on_outline, 2].mean()
        over_ground = triangle_normals(mean, triangles)[:, 2] / 2
        return float((mean[triangles, 2].mean(axis=1) - level) @ over_ground)


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

    Raises
    ------
    ValueError
        If the other shape does not cover the reference's printed points.

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


def _held(layout: Layout) -> Floats:
    """(n, 2) mm, printed points that are held, and the ends of held sides."""
    sides = layout.supported_edges
    ends = np.unique(np.concatenate([sides, layout.edges.following[sides]]))
    return np.concatenate([layout.pin_points, layout.edges.start[ends]])


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
