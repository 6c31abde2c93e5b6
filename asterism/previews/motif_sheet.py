"""The sheet of a motif: fields of its law at the quadrature points, bare fabric around it, and its weight.

**Bare fabric** that rods hold is stretched by a third of its length and more. Where it forms a rim, its tension bends
the whole sheet: along the rim the fabric pulls, and the rods beside it resist. So it has the energy of
`fem.shell.hyperelastic`, with the strain from the released fabric along and across its grain.

**Rims.** In an endless pattern no place is farther from a rod than a certain reach: half the distance of parallel
lines. A rim is as wide as that, or narrower, wherever the outline cuts the pattern; it belongs to the motif, as the
fabric between rods does. Beyond, the fabric is bare; this is averaged over the neighbourhood, since the shell's mesh is
coarse.

**Gaussian modulus.** In a flat sheet the fabric is in tension, and its rods are in compression. Gaussian curvature K
does the work `-phi K` on these forces. Airy's stress function phi vanishes at the rim, and so does its slope.
From a side inwards, fabric of the tension N along the side raises phi to `N w^2/2` at the first rod, at the distance w.
The rods then balance the fabric midway to the next rod, if their distance is d. So the mean of phi over a cell beside
the side is

    Phi = N (mean of w^2/2 - d^2/12),

which is `N d^2/24` if the outline cuts the pattern midway between rods. The shell itself has the part `N s^2/2` of bare
fabric of the width s, which is taken off. At sides along which no rods run, Phi is zero in the mean. Smeared rods need
carry no other forces between the sides; so phi there is taken as the mean of the sides' values, weighted by length over
distance. The rim of a hole is a rim like the outer one. At each, phi is free up to a constant, whose work on K is one
on the geodesic curvature of the rim (Gauss and Bonnet). A hole smaller than a cell of the lattice has no rim along
which rods could run: there phi continues as in the sheet around.

Phi may exceed the bending stiffness. The membrane then keeps the sheet stable, because Gaussian curvature stretches it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
import shapely
from scipy.ndimage import gaussian_filter, map_coordinates

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.density import Density, EnergyTerm, gaussian_limits
from asterism.fem.shell.fields import FieldError, Fields
from asterism.fem.shell.hyperelastic import hyperelastic
from asterism.homogenize.cell.linear_response import voigt_turn
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.tensor_forms import TO_VOIGT, SheetTensors
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric
from asterism.pattern.design.rounding import rounded
from asterism.pattern.design.sizing.profiles import Profile, sample
from asterism.pattern.geometry.planar import distance_to_segment, polygon_area
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.rods.curves import polyline
from asterism.previews.point_pins import softened
from asterism.previews.print_sheet import PrintSheet


def to_grain(fabric: Fabric) -> Floats:
    """(3, 3) T, from strains 11, 22, 2 x 12 of the print to those of the released fabric along and across its grain."""
    return voigt_turn(fabric.axes.T * fabric.stretch_xy)


def bare_fabric(fabric: Fabric, metric: Floats, share: Floats) -> EnergyTerm:
    """Additional energy term of a shell whose strains count from a rest metric.

    `metric`: (T, Q, 3) rest metric of the shell; `share`: (T, Q) of bare fabric.
    """
    released = np.array([1.0 / stretch**2 for stretch in fabric.stretch_xy])
    reference = metric.reshape(-1, 3)
    already = np.stack(
        [0.5 * (reference[:, 0] - released[0]), 0.5 * (reference[:, 1] - released[1]), reference[:, 2]], axis=1
    )
    own = to_grain(fabric)
    amount = share.ravel() * fabric.thickness_mm * np.sqrt(released.prod())
    where = np.flatnonzero(amount)
    mu = fabric.shear_modulus * amount[where]
    lam = fabric.modulus * fabric.poisson / (1.0 - fabric.poisson**2) * amount[where]

    def term(e: Floats) -> tuple[Floats, Floats, Floats]:
        energy, gradient, hessian = np.zeros(len(e)), np.zeros((len(e), 6)), np.zeros((len(e), 6, 6))
        value, slope, curve = hyperelastic((e[where, :3] + already[where]) @ own.T, mu, lam, fabric.exponents)
        energy[where] = value
        gradient[where, :3] = slope @ own
        hessian[where, :3, :3] = own.T @ curve @ own
        return energy, gradient, hessian

    return term


def fabric_tension(fabric: Fabric, metric: Floats) -> Floats:
    """(..., 3) N/mm, tension 11, 22, 12 in printed coordinates of fabric on a metric (..., 3)."""
    places = metric.reshape(1, -1, 3)
    term = bare_fabric(fabric, places, np.ones(places.shape[:2]))
    return term(np.zeros((places.shape[1], 6)))[1][:, :3].reshape(metric.shape)


@dataclass(frozen=True, eq=False)
class MotifSheetValues:
    """The law of a design's motif, with the sizes that the rods have at each place."""

    tensors: SheetTensors  # at the quadrature points, arrays (T, Q, ...)
    # one line for each compared place on rods whose sizes the law replaces by the nearest ones
    outside: tuple[str, ...]
    places: int  # number of these compared places
    is_uniform: bool  # whether all copies of the motif are equal
    has_tight_curls: ClassVar[bool] = False  # cells that are not scale-separated have no law


@dataclass(eq=False)
class MotifSheet(PrintSheet):
    """A printed sheet of a motif."""

    shown_edge = 1 / 3
    most_triangles = 150  # motifs may be far finer than the sheet's form

    law: MotifLaw

    @cached_property
    def bare(self) -> Floats:
        """(T, Q) share of bare fabric at the quadrature points."""
        # width of the Gaussian over which bare fabric is smeared, over the side of a square with the area of a triangle
        smoothing = 0.2 * float(np.sqrt(self.layout.area_mm2 / len(self.mesh.triangles)))
        share = bare_share(self.layout, reach_mm(self.design), smoothing, self.points)
        return share.reshape(self.table.weights.shape)

    @cached_property
    def rims(self) -> Rims:
        """The sides of the sheet and of its holes, at which the tension of the fabric bends it."""
        return rims_of(self.design, self.layout, reach_mm(self.design))

    def _follow(self, before: Self) -> None:
        self.bare, self.rims = before.bare, before.rims
        super()._follow(before)

    @cached_property
    def values(self) -> MotifSheetValues:
        """The law at the sizes of the rods."""
        design, law, shape, on_rods = self.design, self.law, self.table.weights.shape, self.layout.points_on_rods
        at = law.evaluate_at(design, self.points)
        tensors = SheetTensors(
            at.metric.reshape(*shape, 3), at.stiffness.reshape(*shape, 6, 6), at.curvature.reshape(*shape, 3)
        )
        is_uniform = not any(isinstance(field, Profile) for field in law.plan.sources(design))
        return MotifSheetValues(tensors, law.evaluate_at(design, on_rods).outside, len(on_rods), is_uniform)

    def is_same_print(self, design: Design, layout: Layout) -> bool:
        """Whether a design differs only in sizes and faces of its rods, its material and the positions of its pins."""
        same = super().is_same_print(design, layout) and self.has_rods_of(layout)
        return same and _lines(design) == _lines(self.design)

    def has_rods_of(self, layout: Layout) -> bool:
        """Whether another layout of this sheet has its rods at the same positions; thickness and width may differ."""
        ours, theirs = self.layout.graph.rods, layout.graph.rods
        return len(ours) == len(theirs) and all(
            np.array_equal(one.points, other.points) for one, other in zip(ours, theirs, strict=True)
        )

    def fields(self, values: MotifSheetValues) -> Fields:
        """Rest metric, rest curvature and stiffness at the quadrature points.

        Raises LawError: the rest metric is not positive definite: the sizes of the rods differ too much from place to
        place.
        """
        metric, stiffness, curvature = values.tensors.metric, values.tensors.stiffness, values.tensors.curvature
        rods = self.design.required_rods
        if rods.face(rods.motif[0]) < 0:  # the mirror image of the law's cells
            mirror = np.repeat([1.0, -1.0], 3)
            stiffness, curvature = stiffness * mirror * mirror[:, None], -curvature
        density = Density(stiffness)
        if self.bare.any():
            stiffness, curvature = _beside_bare(stiffness, curvature, self.bare, self.design.fabric)
            density = Density(stiffness, term=bare_fabric(self.design.fabric, metric, self.bare))
        fields = softened(Fields(density, metric, curvature, self.gaussian(metric, stiffness)), self.pin_softness)
        try:
            fields.rest(self.table.points)
        except FieldError as error:
            (x, y) = error.place
            message = f"rods: the sizes differ too much near [{x:.1f}, {y:.1f}]: {error}"
            raise LawError(message, place_mm=(x, y), field="rods") from None
        return fields

    def gaussian(self, metric: Floats, stiffness: Floats) -> Floats:
        """(T, Q) N mm, Gaussian modulus on a metric (T, Q, 3) with a stiffness (T, Q, 6, 6)."""
        tension = fabric_tension(self.design.fabric, metric).reshape(-1, 3)
        modulus = self.rims.gaussian(tension, self.points).reshape(self.bare.shape)
        low, high = gaussian_limits(stiffness[..., 3:, 3:])
        # at the limits the bending energy becomes indefinite; only sheets with far wider rims have five times as much
        return np.asarray(np.clip(modulus, 5.0 * low, 5.0 * high))

    def doubts(self) -> Iterator[str]:
        """Rods that the law does not describe, and rims and holes that the preview describes roughly."""
        values = self.values
        if values.outside:
            share = 100.0 * len(values.outside) / values.places
            yield (
                f"{share:.0f} % of the rods are outside the law's range, such as {values.outside[0]}; the preview "
                "takes the nearest size in the range"
            )
        modulus = self.gaussian(values.tensors.metric, values.tensors.stiffness)
        low, high = gaussian_limits(values.tensors.stiffness[..., 3:, 3:])  # where the bending energy is indefinite
        # largest Gaussian modulus over the one at which bending becomes indefinite without a warning
        if np.maximum(modulus / low, modulus / high).max() > 1.5:
            yield (
                "the tension of the fabric at wide rims bends the sheet as much as its rods do, which the preview "
                "describes roughly; check with the exact model"
            )
        if cut := holes_within_cells(self.layout, self.design.border.tip_margin_mm):
            which = f"hole {cut[0]} is" if len(cut) == 1 else f"hole {cut[0]} and {len(cut) - 1} more are"
            yield (
                f"{which} smaller than a cell of the motif, with rods cut off there, which the preview describes "
                "roughly; check with the exact model"
            )

    def plastic_mm(self) -> Callable[[Floats], Floats]:
        """Mean height of the plastic: as much as is printed, where the motif is."""
        rods, area = self.design.required_rods, abs(float(np.linalg.det(np.asarray(self.design.lattice.vectors))))

        def of_motif(points: Floats) -> Floats:
            total = np.zeros(len(points))
            for line in rods.motif:
                length = np.linalg.norm(np.diff(polyline(line, rods.curve_mm), axis=0), axis=1).sum()
                sources = {key: rods.size_of(line, key) for key in ("thickness_mm", "width_mm")}
                thickness, width = (rounded(rods.rounding, key, sample(of, points)) for key, of in sources.items())
                total += thickness * width * length / area
            return total

        printed = sum(rod.volume_mm3 for rod in self.layout.graph.rods)
        share = printed / float(self.table.weights.ravel() @ of_motif(self.points))
        return lambda points: share * of_motif(points)


def _lines(design: Design) -> object:
    """All of the motif but for its sizes and faces."""
    of_rods = {"name", "thickness_mm", "width_mm", "side"}  # not of their places
    return [line.model_dump(mode="json", exclude=of_rods) for line in design.required_rods.motif]


def _beside_bare(stiffness: Floats, curvature: Floats, bare: Floats, fabric: Fabric) -> tuple[Floats, Floats]:
    """Stiffness (..., 6, 6) and rest curvature (..., 3) of a motif beside bare fabric, which bends by its own.

    The membrane of the fabric is left to `bare_fabric`.
    """
    share = bare[..., None, None]
    # a part of the motif's stiffness remains on bare fabric, so that no direction is without any
    mixed = np.maximum(1.0 - share, 1e-3) * stiffness
    moment = np.einsum("...ij,...j->...i", mixed[..., 3:, 3:], curvature * TO_VOIGT)
    mixed[..., 3:, 3:] += share * fabric_bending(fabric)
    return mixed, np.linalg.solve(mixed[..., 3:, 3:], moment[..., None])[..., 0] / TO_VOIGT


def fabric_bending(fabric: Fabric) -> Floats:
    """(3, 3) N mm, bending stiffness of bare fabric per printed area."""
    d11, d12, d22, d66 = fabric.bending_tensor
    own = to_grain(fabric)
    stiffness = own.T @ [[d11, d12, 0.0], [d12, d22, 0.0], [0.0, 0.0, d66]] @ own
    return np.asarray(stiffness / np.prod(fabric.stretch_xy))


# relative: places at the reach but for rounding belong to the pattern
REACH_TOLERANCE = 1e-3


def reach_mm(design: Design) -> float:
    """Largest distance of a place of the endless pattern from its nearest rod."""
    vectors = np.asarray(design.lattice.vectors)
    steps = np.arange(-2, 3)  # of the copies of the motif around a cell
    shifts = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2) @ vectors
    lines = [polyline(line, design.required_rods.curve_mm) for line in design.required_rods.motif]
    drawn = shapely.MultiLineString([line + shift for shift in shifts for line in lines])
    parts = np.arange(40) / 40
    places = np.stack(np.meshgrid(parts, parts, indexing="ij"), axis=-1).reshape(-1, 2) @ vectors
    return float(shapely.distance(drawn, shapely.points(places)).max())


def small_holes(layout: Layout) -> list[int]:
    """Numbers of the holes that are smaller than a cell of the lattice."""
    cell = abs(float(np.linalg.det(layout.lattice_vectors)))
    return [k for k, ring in enumerate(layout.edges.rings[1:]) if -polygon_area(ring) < cell]


def holes_within_cells(layout: Layout, tip_margin_mm: float) -> list[int]:
    """Numbers of the holes that are smaller than a cell of the lattice and cut off rods."""
    ends = shapely.multipoints(np.concatenate([rod.points[[0, -1]] for rod in layout.graph.rods]))
    reach = (1.0 + REACH_TOLERANCE) * tip_margin_mm
    return [k for k in small_holes(layout) if shapely.distance(shapely.Polygon(layout.holes[k]), ends) <= reach]


def bare_share(layout: Layout, reach: float, smoothing: float, points: Floats) -> Floats:
    """(n,) from 0 in the pattern to 1 on bare fabric, at printed points (n, 2) mm.

    `reach`: mm, from `reach_mm`; places farther from all rods are bare; `smoothing`: mm, standard deviation of the
    Gaussian over which that is averaged on the sheet.
    """
    low, high = layout.outline.min(axis=0), layout.outline.max(axis=0)
    # points of the grid along the longer side of a sheet, at most
    step = max(min(reach / 5.0, 0.5 * smoothing), float((high - low).max()) / 600)
    x, y = (np.arange(a - 0.5 * step, b + step, step) for a, b in zip(low, high, strict=True))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    on_sheet = layout.is_on_sheet(grid.reshape(-1, 2)).reshape(grid.shape[:2])
    drawn = shapely.MultiLineString([rod.points for rod in layout.graph.rods])
    shapely.prepare(drawn)  # unlike distances, this question uses it
    is_bare = np.zeros(on_sheet.shape)
    is_bare[on_sheet] = ~shapely.dwithin(drawn, shapely.points(grid[on_sheet]), (1.0 + REACH_TOLERANCE) * reach)
    if not is_bare.any():
        return np.zeros(len(points))
    bare, whole = (gaussian_filter(each, smoothing / step, mode="constant") for each in (is_bare, on_sheet * 1.0))
    share = np.divide(bare, whole, out=np.zeros_like(bare), where=whole > 1e-9)
    at = (points - [x[0], y[0]]) / step
    return np.clip(map_coordinates(share, at.T, order=1, mode="nearest"), 0.0, 1.0)


@dataclass(frozen=True)
class Rims:
    """The sides of a sheet."""

    start: Floats  # (B, 2) mm, of each side of the outline, and of holes that are larger than a cell
    end: Floats  # (B, 2) mm
    along: Floats  # (B, 2) unit vectors along them
    moment_mm2: Floats  # (B,) Phi over N

    def gaussian(self, tension: Floats, points: Floats) -> Floats:
        """(n,) N mm, Gaussian modulus -phi at printed points (n, 2) mm with the tension (n, 3) N/mm of flat fabric."""
        x, y = self.along.T
        across = np.stack([x * x, y * y, 2.0 * x * y])  # of the tension along each side
        length = np.linalg.norm(self.end - self.start, axis=1)
        away = distance_to_segment(points[:, None], self.start, self.end)
        weight = length / np.maximum(away, 1e-3 * length.max())
        return -np.asarray((weight * (tension @ across) * self.moment_mm2).sum(axis=1) / weight.sum(axis=1))


def rims_of(design: Design, layout: Layout, reach: float) -> Rims:
    """The sides of the sheet of a motif.

    `reach`: mm, from `reach_mm`.
    """
    small = small_holes(layout)
    edges = SheetEdges(tuple(ring for k, ring in enumerate(layout.edges.rings) if k - 1 not in small))
    start, end = edges.start, edges.end
    length = np.linalg.norm(end - start, axis=1)
    along = (end - start) / length[:, None]
    inwards = np.column_stack([-along[:, 1], along[:, 0]])
    spacing = design.lattice.spacing_mm
    rods = shapely.STRtree([shapely.LineString(rod.points) for rod in layout.graph.rods])
    moment = np.zeros(len(start))
    for side, normal in enumerate(inwards):
        distance = _distance_along(design, normal)
        if not np.isfinite(distance):
            continue
        # distance of the places of a side at which rims are measured, in spacings of the lattice
        count = max(int(np.ceil(length[side] / (0.05 * spacing))), 2)
        places = start[side] + (np.arange(count) + 0.5)[:, None] / count * (end - start)[side]
        # how far inwards rods are looked for, in their mean distances
        width = to_first_rod(places, normal, rods, 3.0 * distance)
        met = np.isfinite(width)
        # with fewer places of a side that have a rod inwards, rods end at this side and lie along no part of it
        if met.mean() < 0.8:
            continue
        square = float((width[met] ** 2).mean())
        away = rods.query_nearest(shapely.points(places), all_matches=False, return_distance=True)[1]
        bare = np.maximum(away - reach, 0.0)
        moment[side] = 0.5 * (square - float((bare**2).mean())) - distance**2 / 12.0
    return Rims(start, end, along, _mean_along(edges, moment, spacing))


def _mean_along(edges: SheetEdges, moment: Floats, width: float) -> Floats:
    """(B,) mean of the moments (B,) of sides whose middles are within a width (mm) along the rim: of curved rims."""
    length = np.linalg.norm(edges.end - edges.start, axis=1)
    mean = np.empty_like(moment)
    for ring in range(len(edges.rings)):
        its = edges.numbers(ring)
        middle = np.cumsum(length[its]) - 0.5 * length[its]
        gap = np.abs(middle[:, None] - middle)
        weight = length[its] * (np.minimum(gap, length[its].sum() - gap) <= 0.5 * width)
        mean[its] = weight @ moment[its] / weight.sum(axis=1)
    return mean


def _distance_along(design: Design, direction: Floats) -> float:
    """mm, mean distance of the rods of the endless pattern along a line of a direction (2,)."""
    area = abs(float(np.linalg.det(np.asarray(design.lattice.vectors))))
    rods = design.required_rods
    crossed = sum(
        float(np.abs(np.diff(polyline(line, rods.curve_mm), axis=0) @ [-direction[1], direction[0]]).sum())
        for line in rods.motif
    )
    return area / crossed if crossed > 0.0 else np.inf


def to_first_rod(places: Floats, direction: Floats, rods: shapely.STRtree, most: float) -> Floats:
    """(n,) mm, distance from places (n, 2) to the first rod along a direction (2,); inf without one within `most`."""
    rays = shapely.linestrings(np.stack([places, places + most * direction], axis=1))
    ray, rod = rods.query(rays, predicate="intersects")
    hits = shapely.intersection(rays[ray], rods.geometries[rod])
    first = np.full(len(places), np.inf)
    np.minimum.at(first, ray, shapely.distance(hits, shapely.points(places[ray])))
    return first
