"""The printed sheet of a design, ready for the fields of its stars: coarse mesh, smoothed cells, supports, weight.

A sheet is a value. `with_stars` makes the sheet of an edited design; what the edit leaves as it is, is shared.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from skfem import MeshTri

from asterism.previews.corrugation.arms import Arms
from asterism.previews.edges.free_rim import free_normals
from asterism.previews.edges.rim_arms import rim_curvature_share
from asterism.previews.fields.self_stress import gaussian_moduli
from asterism.previews.fields.sheet_fields import free_length_share, sheet_fields
from asterism.previews.fields.star_cells import Shares, StarCells
from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.supports.conditions import conditions, weight
from asterism.previews.supports.point_pins import softness, with_point_softness
from equilibrium.arrays import Floats
from fem.elements.argyris import Argyris
from fem.elements.tabulation import Tabulation
from fem.shell.fields import FieldError, Fields
from fem.shell.shell import QUADRATURE_ORDER, Shell
from fem.supports.conditions import ConditionError, impose_conditions
from fem.supports.loads import area_load
from homogenize.errors import LawError
from pattern.design.design import Design
from pattern.design.errors import DesignError
from pattern.geometry.planar import polygon_area
from pattern.layout.layout import Layout
from pattern.layout.symmetries import Symmetry, symmetries
from pattern.mesh.coarse.sheet_mesh import SheetMesh, sheet_mesh

# edge length of the shell's mesh, in spacings of the stars
EDGE_SPACINGS = 1.3
MIN_TRIANGLES = 24
# most triangles of the shell's mesh, unless the caller gives a number
MAX_TRIANGLES = 600
# attributes of a layout that determine the positions of its arms
ARM_PLACES = ("centres", "star_number", "arm_star", "arm_tip")


@dataclass(frozen=True)
class StarShares:
    """The shares of the stars at the quadrature points (n, 2) mm of a sheet, and the normals of its rim.

    Attributes
    ----------
    cells : smoothed cells of the stars.
    shares : shares of the stars at the points.
    along_arms : direction (2,) of each arm, and the shares half a spacing back along it.
    rim_normals : (n, 2) normals of free sides, from `asterism.previews.edges.free_rim.free_normals`.
    carried : (S, N), see `asterism.previews.edges.rim_arms.rim_curvature_share`; None for supported sheets.
    """

    cells: StarCells
    shares: Shares
    along_arms: tuple[tuple[Floats, Shares], ...]
    rim_normals: Floats
    carried: Floats | None

    @classmethod
    def at(cls, points: Floats, design: Design, layout: Layout, model: PreviewModel) -> StarShares:
        """The shares of a design's stars at printed points (n, 2) mm."""
        lattice, cells = design.lattice, StarCells(layout, design.lattice, model)
        shares = cells.shares(points)
        back = model.arm_setback * lattice.spacing_mm
        along = tuple((arm, cells.shares(points - back * arm)) for arm in lattice.arm_directions)
        normals, curls = free_normals(layout, points, model), model.has_rim_arms and not layout.is_supported_in_plane
        part = rim_curvature_share(layout, lattice.arm_directions, model) if curls else None
        return cls(cells, shares, along, normals, part)


@dataclass(frozen=True, eq=False)
class Sheet:
    """A printed sheet with its mesh and finite elements; made by `sheet_of`.

    Attributes
    ----------
    design, layout, model : inputs of `sheet_of`.
    mesh : coarse triangles of the shell.
    space : C1 quintic elements on these triangles.
    table : shape functions at the quadrature points.
    stars : shares of the stars at the quadrature points.
    """

    design: Design
    layout: Layout
    model: PreviewModel
    mesh: SheetMesh
    space: Argyris
    table: Tabulation
    stars: StarShares

    def with_stars(self, design: Design, layout: Layout) -> Sheet:
        """The same sheet with the stars of another design and its layout; `is_same_print` must hold."""
        stars = self.stars
        if not np.array_equal(layout.centres, self.layout.centres):
            stars = StarShares.at(self.table.points.reshape(-1, 2), design, layout, self.model)
        sheet = replace(self, design=design, layout=layout, stars=stars)
        if design.mesh.edge_mm == self.design.mesh.edge_mm and "_pin_softness" in self.__dict__:
            sheet.__dict__["_pin_softness"] = self._pin_softness
        if "arms" in self.__dict__:
            arms = (
                self.arms.with_layout(layout)
                if self.has_arms_of(layout)
                else self.arms.with_lengths(layout, self.space)
            )
            if arms is not None:
                sheet.__dict__["arms"] = arms
        return sheet

    def has_arms_of(self, layout: Layout) -> bool:
        """Whether another layout of this sheet has its arms at the same positions; thickness and width may differ."""
        return all(np.array_equal(getattr(layout, name), getattr(self.layout, name)) for name in ARM_PLACES)

    def is_same_print(self, design: Design, layout: Layout) -> bool:
        """Whether a design differs from this one only in its stars, its material and the positions of its pins in
        space.

        Outline, lattice, gravity and supported points are the same.
        """
        return (
            np.array_equal(layout.outline, self.layout.outline)
            and len(layout.pins) == len(self.layout.pins)
            # a pin beside an arm is moved onto the arm, so that it depends on the stars
            and all(new.holds_as(old) for new, old in zip(layout.pins, self.layout.pins, strict=True))
            and design.lattice == self.design.lattice
            and design.gravity == self.design.gravity
        )

    def has_pins_of(self, layout: Layout) -> bool:
        """Whether another layout of this print has its pins at the same positions in space."""
        return all(new.stands_as(old) for new, old in zip(layout.pins, self.layout.pins, strict=True))

    @property
    def outline(self) -> Floats:
        """(R, 2) mm, corners of the outline of the mesh."""
        return np.asarray(self.mesh.points[self.mesh.rim[:, 0]])

    @cached_property
    def arms(self) -> Arms:
        """Arms of the stars, for shells of this sheet."""
        return Arms(self.layout, self.space, self.model)

    @cached_property
    def symmetries(self) -> list[Symmetry]:
        """Motions of the print that map the design to itself."""
        return symmetries(self.design, self.layout)

    @cached_property
    def _pin_softness(self) -> Floats | None:
        """(T, Q) softness around supported points; None if the sheet has none."""
        pins = self.layout.in_plane_pin_points
        pulls = self.layout.is_supported_in_plane and len(pins) > 0
        return softness(self.mesh, pins, self.table.points, self.design.mesh.edge_mm, self.model) if pulls else None

    def fields(self, values: StarValues) -> Fields:
        """Rest metric, rest curvature and stiffness at the quadrature points.

        Raises
        ------
        LawError
            The rest metric is not positive definite: adjacent stars contract too differently.
        """
        stars, length, spacing, model = self.stars, values.sizes[:, 0], self.layout.spacing_mm, self.model
        arms = [(along, shares(length)) for along, shares in stars.along_arms]
        shares = stars.shares(length)
        early: float | Floats = model.supported_length_share
        if not self.layout.is_supported_in_plane:
            early = free_length_share(values, spacing, model)
        gaussian, shape = gaussian_moduli(values, spacing, model), self.table.weights.shape
        fields = sheet_fields(
            shares, values, shape, arms, stars.rim_normals, early, stars.carried, gaussian, spacing, model
        )
        if self._pin_softness is not None:
            bare = 1.0 - np.asarray(shares.sum(axis=1)).reshape(self._pin_softness.shape)
            fields = with_point_softness(fields, self._pin_softness, bare, model)
        try:
            fields.rest(self.table.points)
        except FieldError as error:
            star = int(np.linalg.norm(self.layout.centres - error.place, axis=1).argmin())
            (x, y), lam = self.layout.centres[star], values.value["lam_n"][star]
            place = f"star {self.layout.star_number[star]} at [{x:.1f}, {y:.1f}]"
            message = f"{place}: lam_n = {lam:.4g} is too far from its neighbours': {error}"
            raise LawError(message, [self.layout.star_number[star]], (x, y)) from None
        return fields

    def loads(self) -> Floats:
        """(N, 3) N, the weight of fabric and plastic."""
        # the outline cuts the cells near it: the weight of a star is distributed over the rest of its cell
        covered = self.stars.shares.wide.T @ self.table.weights.ravel()

        def weights(points: Floats) -> Floats:
            return weight(self.design, self.layout, self.stars.cells.shares(points).wide, covered)

        return area_load(self.space, weights)

    def shell(self, fields: Fields, step: int) -> Shell:
        """The shell with the supports up to a step.

        Raises
        ------
        DesignError
            The supports contradict each other.
        """
        # a sheet without supports would fall: gravity acts only from the step of the first supports on
        is_carried = self.layout.is_supported(step)
        loads = self.loads() if self.design.gravity.on and is_carried else None
        try:
            return Shell(self.space, fields, conditions(self.layout, self.mesh, self.space.mesh, step), loads)
        except ConditionError as error:
            raise DesignError("pins", f"cannot all hold: {error}") from None

    def support_target(self) -> Floats:
        """(3N,) mm, target of all supports, for `Shell.with_target`.

        Raises
        ------
        DesignError
            The supports contradict each other.
        """
        held = conditions(self.layout, self.mesh, self.space.mesh, self.layout.pin_steps[-1])
        try:
            return impose_conditions(self.space, held).target
        except ConditionError as error:
            raise DesignError("pins", f"cannot all hold: {error}") from None


def sheet_of(
    design: Design, layout: Layout, triangles: int | None = None, model: PreviewModel = PREVIEW_MODEL
) -> Sheet:
    """The sheet of a design and its layout.

    Parameters
    ----------
    triangles : approximate number of triangles; by default the edges are `EDGE_SPACINGS` spacings long.

    Raises
    ------
    DesignError
        The sheet has holes.
    MeshError
        The outline cannot be meshed.
    """
    if layout.holes:
        raise DesignError("border.holes", "must be empty for a preview; asterism simulate computes sheets with holes")
    area = polygon_area(layout.outline)
    usual = np.clip(area / _equilateral(EDGE_SPACINGS * design.lattice.spacing_mm), MIN_TRIANGLES, MAX_TRIANGLES)
    edge = float(np.sqrt(area / (triangles or usual) / _equilateral(1.0)))
    mesh = sheet_mesh(layout.outline, edge, layout.pin_points, layout.supported_edge_groups)
    space = Argyris(MeshTri(np.ascontiguousarray(mesh.points.T), np.ascontiguousarray(mesh.triangles.T)))
    table = space.tabulate(QUADRATURE_ORDER)
    stars = StarShares.at(table.points.reshape(-1, 2), design, layout, model)
    return Sheet(design, layout, model, mesh, space, table, stars)


def _equilateral(edge: float) -> float:
    """mm^2, area of an equilateral triangle."""
    return float(np.sqrt(3.0) / 4.0 * edge**2)
