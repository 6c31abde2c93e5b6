"""The layout of a design: stars, arms, outline and supports in printed coordinates (mm on the stretched fabric)."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely
from jaxtyping import Float, Int

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.stars import ROD_SIZES, STAR_SIZES
from asterism.pattern.geometry.planar import clusters, inside, off_sheet_mm
from asterism.pattern.geometry.plane_lattice import PlaneLattice
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.layout.supports import PinSet, SupportSamples, all_points, sample_supports
from asterism.pattern.rods.graph import Rod, RodGraph


@dataclass(frozen=True)
class Layout:
    """All that is printed, and where the sheet is supported. It holds all geometry that later steps need."""

    outline: Float[np.ndarray, "B 2"]  # (B, 2) mm, simple polygon, counterclockwise, not closed
    pins: tuple[PinSet, ...]  # supports; empty for a free sheet
    # (2, 2) mm, rows, as of `Lattice.vectors`. Star centres are integer combinations of them plus `lattice_origin`. For
    # a drawing that does not repeat, those of a square lattice of the mean distance of rods.
    lattice_vectors: Float[np.ndarray, "2 2"]
    lattice_origin: Float[np.ndarray, " 2"]  # (2,) mm
    # (S, 2) mm, star centres. Stars without arms (length 0, removed) are left out.
    centres: Float[np.ndarray, "S 2"] = field(default_factory=lambda: np.empty((0, 2)))
    # (A,) the star of each arm; the arms of a star follow each other counterclockwise.
    arm_star: Int[np.ndarray, " A"] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    # (A, 2) mm, tip of each arm, after cutting at the outline.
    arm_tip: Float[np.ndarray, "A 2"] = field(default_factory=lambda: np.empty((0, 2)))
    # (A, 2, K) sections, in the order of `ROD_SIZES`, at the star's centre and at the tip, linear between.
    arm_sections: Float[np.ndarray, "A 2 K"] = field(default_factory=lambda: np.empty((0, 2, len(ROD_SIZES))))
    # (S,) side to which each star starts: 1 up, to the plastic's side (the default), -1 down, 0 flat.
    star_branch: Int[np.ndarray, " S"] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    # (S,) face of the fabric that carries each star: 1 above (the default), -1 below.
    star_side: Int[np.ndarray, " S"] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    # (S,) increasing, the number of each star in the design and in results.
    star_number: Int[np.ndarray, " S"] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    # (P, 2) all lattice sites of the sheet in the order of the stars' numbers, those of removed stars too.
    sheet_sites: Int[np.ndarray, "P 2"] = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    # (P, K + 1) `STAR_SIZES` of the stars there, before the outline cuts arms and before rounding; length 0 where a
    # star is removed.
    site_sizes_mm: Float[np.ndarray, "P L"] = field(default_factory=lambda: np.empty((0, len(STAR_SIZES))))
    # (k, 2) lattice sites off the sheet that `stars.override` names.
    ignored_sites: Int[np.ndarray, "k 2"] = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    # ends of arms closer than this are one point, at which the arms are bonded; 0 bonds no arms of different stars.
    meeting_mm: float = 0.0
    # all rods of a sheet with a drawing: the arms of its stars in their order, then the drawn rods; None for stars
    # alone.
    drawn: RodGraph | None = None
    rim: tuple[int, ...] = ()  # drawn rods that are the outline, in their order around it, all counterclockwise
    holes: tuple[Floats, ...] = ()  # (n, 2) mm each, edges of the holes in the sheet, in the order of `border.holes`
    # for each hole the drawn rods that are its edge, in their order; empty for a hole without a printed rim.
    hole_rims: tuple[tuple[int, ...], ...] = ()

    def __post_init__(self) -> None:
        for name in ("star_branch", "star_side"):
            if len(getattr(self, name)) == 0:
                object.__setattr__(self, name, np.ones(len(self.centres), dtype=np.int64))
        if len(self.star_number) == 0:
            object.__setattr__(self, "star_number", np.arange(len(self.centres)))

    @cached_property
    def graph(self) -> RodGraph:
        """All rods, and the nodes at which they meet: the drawing, or one rod an arm, in the order of the arms.

        Ends of arms of different stars that meet on one face are one node.
        """
        if self.drawn is not None:
            return self.drawn
        count, places = len(self.centres), np.concatenate([self.centres, self.arm_tip])
        node: Ints = np.arange(len(places))
        nodes = places
        if self.meeting_mm > 0.0:
            # plastic above and plastic below do not bond, see `apart_by_face`: they are at different heights
            height = np.concatenate([self.star_side, self.star_side[self.arm_star]])[:, None]
            node, nodes = clusters(np.hstack([places, height]), self.meeting_mm)
            nodes = nodes[:, :2]
        points = np.stack([self.centres[self.arm_star], self.arm_tip], axis=1)
        start, end = node[self.arm_star], node[count:]
        arms = zip(points, start.tolist(), end.tolist(), self.arm_sections, strict=True)
        star_of_arms = zip(arms, self.arm_star.tolist(), self.star_side[self.arm_star].tolist(), strict=True)
        rods = tuple(Rod(*arm, group=star, side=side) for arm, star, side in star_of_arms)
        touched = np.bincount(end, minlength=len(nodes)) > 0
        stars = np.bincount(node[:count], minlength=len(nodes))
        return RodGraph(nodes, rods, paired=np.flatnonzero((stars == 1) & ~touched))

    @cached_property
    def edges(self) -> SheetEdges:
        """All edges of the sheet: those of the outline, then those of the holes."""
        return SheetEdges.of(self.outline, self.holes)

    @property
    def area_mm2(self) -> float:
        """Area of the sheet without its holes."""
        return self.edges.area_mm2

    def is_on_sheet(self, points: Floats) -> np.ndarray:
        """(n,) bool, whether printed points (n, 2) mm are inside the outline and in no hole."""
        return inside(points, self.outline, self.holes)

    @property
    def lattice(self) -> PlaneLattice:
        """All places where stars can stand."""
        return PlaneLattice(self.lattice_vectors, self.lattice_origin)

    @property
    def sites(self) -> Ints:
        """(S, 2) lattice site of each star."""
        return self.lattice.nearest(self.centres)

    @property
    def star_sizes_mm(self) -> Floats:
        """(S, K + 1) `STAR_SIZES` of each star, as `site_sizes_mm`."""
        return self.site_sizes_mm[self.star_number]

    @cached_property
    def _sample_cells(self) -> Ints:
        """(n, 2) lattice cells at which shapes are compared: of the stars, or of a drawing those on the sheet."""
        if self.has_stars:
            return self.sites
        cells = self.lattice.cells_within(self.outline.min(axis=0), self.outline.max(axis=0))
        return cells[self.is_on_sheet(self.lattice.place(cells))]

    @cached_property
    def sample_points(self) -> Floats:
        """(n, 2) mm: the star centres; of a drawing without stars, the sites of its lattice on the sheet."""
        return self.lattice.place(self._sample_cells)

    @cached_property
    def sample_pairs(self) -> Ints:
        """(N, 2) pairs of neighbouring `sample_points`, see `PlaneLattice.neighbours`."""
        return self.lattice.neighbours(self._sample_cells)

    @property
    def has_stars(self) -> bool:
        """Whether any rods are arms of stars."""
        return len(self.arm_star) > 0

    @property
    def drawn_rods(self) -> tuple[Rod, ...]:
        """The drawn rods, without the arms of stars."""
        return () if self.drawn is None else self.drawn.rods[len(self.arm_star) :]

    @property
    def star_of_rods(self) -> Ints:
        """(rods,) number of the star of each rod of the graph; -1 for drawn rods."""
        return np.concatenate([self.star_number[self.arm_star], np.full(len(self.drawn_rods), -1)])

    @cached_property
    def rod_side(self) -> Ints:
        """(rods,) face of the fabric that carries each rod of the graph: 1 above, -1 below."""
        return np.array([rod.side for rod in self.graph.rods], dtype=np.int64)

    @property
    def compared_points(self) -> Floats:
        """(n, 2) mm, at which shapes are compared: star centres; of a sheet with a drawing, `points_on_rods`."""
        return self.centres if self.drawn is None else self.points_on_rods

    @cached_property
    def points_on_rods(self) -> Floats:
        """(n, 2) mm, points at equal parts of every drawn rod, at which shapes are compared."""
        parts = np.linspace(0.0, 1.0, 9)
        # shapes with more rods are compared at some of them
        rods = self.graph.rods[:: max(len(self.graph.rods) // 1000, 1)]
        return np.concatenate([rod.at(rod.points, parts) for rod in rods])

    @property
    def spacing_mm(self) -> float:
        """Distance of nearest neighbours: length of the shorter lattice vector; of a drawing, the scale of its rods."""
        return float(np.linalg.norm(self.lattice_vectors, axis=1).min())

    @property
    def diameter_mm(self) -> float:
        """Largest distance of two corners of the outline."""
        return float(np.linalg.norm(self.outline[:, None] - self.outline[None], axis=2).max())

    @property
    def arm_length(self) -> Floats:
        """(A,) mm."""
        return np.asarray(np.linalg.norm(self.arm_tip - self.centres[self.arm_star], axis=1))

    @property
    def arm_thickness(self) -> Floats:
        """(A, 2) mm, at the star's centre and at the tip."""
        return self.arm_sections[..., 0]

    @property
    def arm_width(self) -> Floats:
        """(A, 2) mm, at the star's centre and at the tip."""
        return self.arm_sections[..., 1]

    @property
    def pin_steps(self) -> tuple[int, ...]:
        """Steps at which supports take hold: 0, the release, then those of later pins in order."""
        return tuple(sorted({0, *(pin.step for pin in self.pins)}))

    @property
    def pin_points(self) -> Floats:
        """(P, 2) mm, the single points of all pins, one set after the other."""
        return all_points(self.pins)

    @property
    def in_plane_pin_points(self) -> Floats:
        """(P, 2) mm, the single points that are supported along x or y."""
        return all_points(tuple(pin for pin in self.pins if pin.holds_in_plane))

    @property
    def supported_edge_groups(self) -> list[tuple[int, ...]]:
        """Supported edges of the outline and of holes, one group for each pin set that has any."""
        return [pin.edges for pin in self.pins if pin.edges]

    @property
    def supported_edges(self) -> Ints:
        """(E,) numbers of the supported edges, see `edges`, one pin set after the other."""
        return np.array([edge for group in self.supported_edge_groups for edge in group], dtype=np.int64)

    @cached_property
    def support_samples(self) -> SupportSamples:
        """Places at which the supports act, see `pattern.layout.supports`."""
        return sample_supports(self.pins, self.edges)

    @property
    def is_supported_in_plane(self) -> bool:
        """Whether supports hold more than one place along x or y.

        A sheet that slides in the plane everywhere, or is held there at a single point, takes the shape of a free one.
        """
        in_plane = [pin for pin in self.pins if pin.holds_in_plane]
        return any(pin.edges for pin in in_plane) or sum(len(pin.points) for pin in in_plane) > 1

    @property
    def common_pin_scale(self) -> float | None:
        """The scale of all pins that have one; None if there are several, or pins with targets only."""
        scales = {pin.scale for pin in self.pins if pin.target_mm is None}
        return scales.pop() if len(scales) == 1 else None

    def is_supported(self, step: int) -> bool:
        """Whether any pin supports the sheet in a step."""
        return any(pin.is_active(step) for pin in self.pins)

    def distance_to_supports(self, points: Floats) -> Floats:
        """(n,) mm from printed points (n, 2) to the nearest supported place; infinite on a free sheet."""
        edges = self.supported_edges
        lines = shapely.linestrings(np.stack([self.edges.start[edges], self.edges.end[edges]], axis=1))
        supports = shapely.geometrycollections([*lines, *shapely.points(self.pin_points)])
        if shapely.is_empty(supports):
            return np.full(len(points), np.inf)
        shapely.prepare(supports)
        return np.asarray(shapely.distance(supports, shapely.points(points)))


def off_curves_mm(layout: Layout, vertices: int) -> float:
    """`off_sheet_mm` if the sheet has a printed rim or holes, which may be curved; else that of symmetric images."""
    if layout.rim or layout.holes:
        return off_sheet_mm(layout.area_mm2, vertices)
    # images of an outline under its symmetries are off it by less
    return 2e-6 * layout.spacing_mm
