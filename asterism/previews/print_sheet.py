"""The printed sheet of a design with its law, for any pattern: outline, mesh, supports, and the triangles to show.

`with_pattern` makes the sheet of an edited design; what the edit leaves as it is, is shared. Sheets of stars
(`asterism.previews.sheet`) and of motifs of rods (`asterism.previews.motifs.motif_sheet`) differ in their values of the
law, fields, weight and bumps, which subclasses give. All else, from supports to search and shape, is common to both.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from skfem import MeshTri

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris
from asterism.fem.elements.tabulation import Tabulation
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import QUADRATURE_ORDER, Shell
from asterism.fem.supports.conditions import ConditionError, impose_conditions
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.supports import PinSet
from asterism.pattern.layout.symmetries import Symmetry, symmetries
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.pattern.mesh.sheet_mesh import SheetMesh, sheet_mesh
from asterism.previews.model import PreviewModel
from asterism.previews.places import SheetLens, ShownSheet
from asterism.previews.point_pins import softness
from asterism.previews.supports import conditions

# edge length of the shell's mesh, in spacings of the lattice
EDGE_SPACINGS = 1.3
MIN_TRIANGLES = 24
# most triangles of the shell's mesh, unless the caller gives a number
MAX_TRIANGLES = 600


@dataclass(eq=False)
class PrintSheet(ABC):
    """A printed sheet with its law, its mesh and its finite elements. Once made, it does not change.

    Attributes
    ----------
    design, layout : of the print.
    law : of the design's material.
    model : constants of the preview.
    asked_triangles : number of triangles that the caller asked for; None for the default.
    mesh : coarse triangles of the shell.
    space : C1 quintic elements on these triangles.
    table : shape functions at the quadrature points.
    shells : for each step a shell of this print, and the pins of its supports. Sheets of one print share them.
    softnesses : around the supported points, for each edge of the exact model's mesh; shared likewise.
    shown_edge : least edge of the triangles to show, over the spacing of the lattice.
    """

    shown_edge: ClassVar[float]

    design: Design
    layout: Layout
    law: Any
    model: PreviewModel
    asked_triangles: int | None
    mesh: SheetMesh
    space: Argyris
    table: Tabulation
    shells: dict[int, tuple[tuple[PinSet, ...], Shell]] = field(default_factory=dict, kw_only=True)
    softnesses: dict[float, Floats | None] = field(default_factory=dict, kw_only=True)

    @property
    @abstractmethod
    def values(self) -> Any:
        """The law at the stars, or at the sizes of the rods; computed once.

        Raises
        ------
        LawError
            The law is for another material, or its values are impossible for a sheet.
        """

    @abstractmethod
    def fields(self, values: Any) -> Fields:
        """Rest metric, rest curvature and stiffness at the quadrature points, from the values of the law."""

    @abstractmethod
    def loads(self) -> Floats:
        """(N, 3) N, the weight of fabric and plastic."""

    @abstractmethod
    def doubts(self) -> Iterator[str]:
        """Warnings about the pattern: what the law does not describe."""

    def lens(self, points: Floats) -> SheetLens:
        """Computes the positions of printed points (n, 2) mm."""
        return SheetLens(self, points)

    def with_pattern(self, design: Design, layout: Layout, law: Any) -> Self:
        """The same sheet with the pattern of another design, its layout and law; `is_same_print` must hold."""
        new = replace(self, design=design, layout=layout, law=law)
        new._follow(self)
        return new

    def _follow(self, before: Self) -> None:
        """Take over what the new pattern leaves as it is: the triangles to show, if a shape was asked for."""
        if "shown" in vars(before) and before.has_rods_of(self.layout) and before.design.mesh == self.design.mesh:
            self.shown = replace(before.shown, lens=before.shown.lens.renewed(self))

    @abstractmethod
    def has_rods_of(self, layout: Layout) -> bool:
        """Whether another layout of this sheet has its rods at the same positions; thickness and width may differ."""

    def is_same_print(self, design: Design, layout: Layout) -> bool:
        """Whether a design differs from this one only in its stars, or in the sizes of its rods, in its material and
        in the positions of its pins in space.

        Outline, holes, lattice, gravity and supported points are the same.
        """
        return (
            (design.rods is None) == (self.design.rods is None)
            and layout.edges.equals(self.layout.edges)
            and len(layout.pins) == len(self.layout.pins)
            # a pin beside a rod is moved onto the rod, so that it depends on the pattern
            and all(new.holds_as(old) for new, old in zip(layout.pins, self.layout.pins, strict=True))
            and design.lattice == self.design.lattice
            and design.gravity == self.design.gravity
        )

    def has_pins_of(self, layout: Layout) -> bool:
        """Whether another layout of this print has its pins at the same positions in space."""
        return _stand_alike(layout.pins, self.layout.pins)

    @cached_property
    def symmetries(self) -> list[Symmetry]:
        """Motions of the print that map the design to itself."""
        return symmetries(self.design, self.layout)

    @cached_property
    def shown(self) -> ShownSheet:
        """Triangles to show, with rods along their edges, and the lens of their vertices.

        Edges have the length of the design's, but at least `shown_edge` spacings.
        """
        design = self.design
        edge = max(design.usual_edge_mm, self.shown_edge * design.lattice.spacing_mm)
        mesh = mesh_layout(self.layout, edge, design.mesh.kind, design.mesh.seed, draft=True)
        return ShownSheet(mesh, self.lens(mesh.points))

    @property
    def pin_softness(self) -> Floats | None:
        """(T, Q) softness around supported points; None if the sheet has none."""
        pins, edge = self.layout.in_plane_pin_points, self.design.usual_edge_mm
        if edge not in self.softnesses:
            pulls = self.layout.is_supported_in_plane and len(pins) > 0
            self.softnesses[edge] = softness(self.mesh, pins, self.table.points, edge, self.model) if pulls else None
        return self.softnesses[edge]

    def shell(self, fields: Fields, step: int) -> Shell:
        """The shell with the supports up to a step.

        Raises
        ------
        DesignError
            The supports contradict each other.
        """
        # a sheet without supports would fall: gravity acts only from the step of the first supports on
        is_carried = self.layout.is_supported(step)
        loads = self.loads() if self.design.gravity.on and is_carried else np.zeros((self.space.size, 3))
        if step in self.shells and _stand_alike(self.layout.pins, self.shells[step][0]):
            return self.shells[step][1].with_fields(fields, loads)
        try:
            shell = Shell(self.space, fields, conditions(self.layout, self.mesh, self.space.mesh, step), loads)
        except ConditionError as error:
            raise DesignError("pins", f"cannot all hold: {error}") from None
        self.shells[step] = self.layout.pins, shell
        return shell

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


def _stand_alike(pins: tuple[PinSet, ...], others: tuple[PinSet, ...]) -> bool:
    """Whether pins of one print hold it at the same positions in space."""
    return all(one.stands_as(other) for one, other in zip(pins, others, strict=True))


def elements_of(layout: Layout, usual: float, triangles: int | None) -> tuple[SheetMesh, Argyris, Tabulation]:
    """Mesh, elements and shape functions of the sheet of a layout.

    Parameters
    ----------
    usual : number of triangles if `triangles` is None.

    Raises
    ------
    MeshError
        The outline cannot be meshed.
    """
    edge = float(np.sqrt(layout.area_mm2 / (triangles or usual) / equilateral_area(1.0)))
    mesh = sheet_mesh(layout.outline, edge, layout.pin_points, layout.supported_edge_groups, layout.holes)
    space = Argyris(MeshTri(np.ascontiguousarray(mesh.points.T), np.ascontiguousarray(mesh.triangles.T)))
    return mesh, space, space.tabulate(QUADRATURE_ORDER)


def usual_triangles(layout: Layout, edge_mm: float, most: int = MAX_TRIANGLES) -> float:
    """Number of triangles with edges of about a length in mm, within limits."""
    return float(np.clip(layout.area_mm2 / equilateral_area(edge_mm), MIN_TRIANGLES, most))


def equilateral_area(edge: float) -> float:
    """mm^2, area of an equilateral triangle."""
    return float(np.sqrt(3.0) / 4.0 * edge**2)
