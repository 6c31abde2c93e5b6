"""What of a preview does not depend on the sizes of its stars: the printed sheet, its coarse mesh, what holds it."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from skfem import MeshTri

from asterism.previews.corrugation.arms import Arms
from asterism.previews.edges.free_rim import free_normals
from asterism.previews.edges.rim_arms import carried
from asterism.previews.fields.self_stress import gaussian_moduli
from asterism.previews.fields.sheet_fields import EARLY, free_early, sheet_fields
from asterism.previews.fields.star_arms import BACK
from asterism.previews.fields.star_cells import StarCells
from asterism.previews.fields.star_values import StarValues
from asterism.previews.supports.conditions import conditions, held_sides, pinned_points, weight
from asterism.previews.supports.point_pins import giving_way, softness
from fem.elements.argyris import Argyris
from fem.elements.tabulation import Floats
from fem.shell.fields import FieldError, Fields
from fem.shell.shell import QUADRATURE_ORDER, Shell
from fem.supports.conditions import ConditionError
from fem.supports.loads import area_load
from homogenize.errors import LawError
from pattern.design.design import Design
from pattern.design.errors import DesignError
from pattern.geometry.planar import polygon_area
from pattern.layout.build import layout
from pattern.layout.layout import Layout
from pattern.mesh.coarse.sheet_mesh import sheet_mesh

# mesh edges over the spacing of the stars, and how many triangles there are at least and at most, about
EDGE, FEWEST, MOST = 1.3, 24, 600
# where the arms of a layout are
PLACES = ("centres", "star_number", "arm_star", "arm_tip")


class Sheet:
    """A printed sheet, ready for fields.

    Parameters
    ----------
    triangles : about how many the mesh is to have; by default edges of 1.3 times the spacing of the stars.

    Attributes
    ----------
    layout : of the design that the sheet was made for.
    space : C1 quintic functions on its mesh.
    cells : of its stars.
    """

    def __init__(self, design: Design, plan: Layout | None = None, triangles: int | None = None) -> None:
        self.layout = plan if plan is not None else layout(design)
        area = polygon_area(self.layout.border)
        count = triangles or np.clip(area / _equilateral(EDGE * design.lattice.spacing_mm), FEWEST, MOST)
        edge = float(np.sqrt(area / count / _equilateral(1.0)))
        self._mesh = sheet_mesh(self.layout.border, edge, self.layout.pin_points, held_sides(self.layout))
        mesh = MeshTri(np.ascontiguousarray(self._mesh.points.T), np.ascontiguousarray(self._mesh.triangles.T))
        self.space = Argyris(mesh)
        self._table = self.space.tabulate(QUADRATURE_ORDER)
        self._spread(design, self.layout)
        self._pin(design, self.layout)

    def set_stars(self, design: Design, plan: Layout) -> None:
        """Take another layout of the same sheet (`holds`)."""
        if not np.array_equal(plan.centres, self.layout.centres):
            self._spread(design, plan)
        self._pin(design, plan)
        self.layout = plan
        vars(self).pop("arms", None)

    def has_arms(self, plan: Layout) -> bool:
        """Whether the arms of another layout of the same sheet are where its own are; they may be thicker or wider."""
        return all(np.array_equal(getattr(plan, name), getattr(self.layout, name)) for name in PLACES)

    @property
    def outline(self) -> Floats:
        """(R, 2) mm, that of the mesh."""
        return np.asarray(self._mesh.points[self._mesh.rim[:, 0]])

    @cached_property
    def arms(self) -> Arms:
        """Of its stars, on its shells."""
        return Arms(self.layout, self.space)

    def _spread(self, design: Design, plan: Layout) -> None:
        """The shares of its stars at the quadrature points."""
        self.cells = StarCells(plan, design.lattice)
        points, lattice = self._table.points.reshape(-1, 2), design.lattice
        self._shares = self.cells.shares(points)
        back = BACK * lattice.spacing_mm
        self._arm_shares = [(along, self.cells.shares(points - back * along)) for along in lattice.arm_directions]
        self._normals = free_normals(plan, points)
        self._carried = None if plan.is_pulled else carried(plan, lattice.arm_directions)

    def _pin(self, design: Design, plan: Layout) -> None:
        """How soft the sheet is around single points that pull at it; None without any."""
        pins = pinned_points(plan)
        pulls = plan.is_pulled and len(pins) > 0
        self._soft = softness(self._mesh, pins, self._table.points, design.mesh.edge_mm) if pulls else None

    def holds(self, design: Design, plan: Layout, before: Design) -> bool:
        """Whether a design that follows `before` has the same print but for its stars and material."""
        places = zip(plan.pins, self.layout.pins, strict=False)
        return (
            np.array_equal(plan.border, self.layout.border)
            and design.pins == before.pins
            # those beside an arm are on it, and move with it
            and all(np.array_equal(one.points, other.points) for one, other in places)
            and design.lattice == before.lattice
            and design.gravity == before.gravity
        )

    def fields(self, values: StarValues) -> Fields:
        """What the sheet wants to be, at the quadrature points.

        Raises
        ------
        LawError
            No sheet can be that: neighbours contract too differently.
        """
        length = values.sizes[:, 0]
        arms = [(along, shares(length)) for along, shares in self._arm_shares]
        shares = self._shares(length)
        spacing = self.layout.spacing_mm
        early = EARLY if self.layout.is_pulled else free_early(values, spacing)
        gaussian = gaussian_moduli(values, spacing)
        shape = self._table.weights.shape
        fields = sheet_fields(shares, values, shape, arms, self._normals, early, self._carried, gaussian, spacing)
        if self._soft is not None:
            bare = 1.0 - np.asarray(shares.sum(axis=1)).reshape(self._soft.shape)
            fields = giving_way(fields, self._soft, bare)
        try:
            fields.rest(self._table.points)
        except FieldError as error:
            star = int(np.linalg.norm(self.layout.centres - error.place, axis=1).argmin())
            (x, y), lam = self.layout.centres[star], values.value["lam_n"][star]
            number = self.layout.star_number[star]
            told = f"star {number} at [{x:.1f}, {y:.1f}]: lam_n = {lam:.4g} is too far from its neighbours'"
            raise LawError(f"{told}: {error}") from None
        return fields

    def loads(self, design: Design) -> Floats:
        """(N, 3) N, the weight."""
        # cells at the outline reach over it, and share what is left
        covered = self._shares.wide.T @ self._table.weights.ravel()

        def pulls(points: Floats) -> Floats:
            return weight(design, self.layout, self.cells.shares(points).wide, covered)

        return area_load(self.space, pulls)

    def shell(self, design: Design, fields: Fields, step: int) -> Shell:
        """The shell with the pins up to a step; `DesignError` if they contradict each other."""
        # what nothing holds yet would fall: it lies somewhere until its first pins take hold
        carried = any(pins.step <= step for pins in self.layout.pins)
        loads = self.loads(design) if design.gravity.on and carried else None
        try:
            held = conditions(self.layout, self._mesh, self.space.mesh, step)
            return Shell(self.space, fields, held, loads)
        except ConditionError as error:
            raise DesignError("pins", f"cannot all hold: {error}") from None


def _equilateral(edge: float) -> float:
    return float(np.sqrt(3.0) / 4.0 * edge**2)
