"""The printed sheet of a design with its law, for any pattern: outline, mesh, supports, and the triangles to show.

`with_pattern` makes the sheet of an edited design; what the edit leaves as it is, is shared. Sheets of stars
(`asterism.previews.sheet`) and of motifs of rods (`asterism.previews.motif_sheet`) differ in their values of the
law, fields, weight and bumps, which subclasses give. All else, from mesh and supports to search and shape, is common.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, ClassVar, Self

import numpy as np
from skfem import MeshTri

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris, Tabulation, area_load
from asterism.fem.elements.deformation import affine
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import QUADRATURE_ORDER, Shell
from asterism.fem.supports.conditions import (
    Condition,
    ConditionError,
    EdgeSupport,
    PointSupport,
    impose_conditions,
    vertices_at,
)
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.supports import PinSet
from asterism.pattern.layout.symmetries import Symmetry, symmetries
from asterism.pattern.mesh.mesh import Mesh
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.pattern.mesh.sheet_mesh import SheetMesh, sheet_mesh
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.places import SheetLens
from asterism.previews.point_pins import softness


@dataclass(eq=False)
class PrintSheet(ABC):
    """A printed sheet with its law, its mesh and its finite elements; made by `of`. Once made, it does not change."""

    shown_edge: ClassVar[float]  # least edge of the triangles to show, over the spacing of the lattice
    most_triangles: ClassVar[int]  # of the shell's mesh, unless the caller gives a number

    design: Design
    layout: Layout
    law: Any  # of the design's material
    model: PreviewModel  # constants of the preview
    asked_triangles: int | None  # number of triangles that the caller asked for; None for the default
    mesh: SheetMesh  # coarse triangles of the shell
    space: Argyris  # C1 quintic elements on these triangles
    table: Tabulation  # shape functions at the quadrature points
    # for each step the pins of its supports, and a shell of this print. Sheets of one print share them.
    shells: dict[int, tuple[tuple[PinSet, ...], Shell]] = field(default_factory=dict, kw_only=True)

    @classmethod
    def of(
        cls, design: Design, layout: Layout, law: Any, triangles: int | None = None, model: PreviewModel = PREVIEW_MODEL
    ) -> Self:
        """The sheet of a design with its layout and its law.

        `triangles`: approximate number of triangles; by default the edges are 1.3 spacings long, within limits of the
        number of triangles.

        Raises MeshError: the outline cannot be meshed.
        """
        equilateral = 0.25 * 3.0**0.5  # area of a triangle over its squared edge
        usual = layout.area_mm2 / (equilateral * (1.3 * design.lattice.spacing_mm) ** 2)
        count = triangles or np.clip(usual, 24, cls.most_triangles)
        edge = float(np.sqrt(layout.area_mm2 / count / equilateral))
        mesh = sheet_mesh(layout.outline, edge, layout.pin_points, layout.supported_edge_groups, layout.holes)
        space = Argyris(MeshTri(np.ascontiguousarray(mesh.points.T), np.ascontiguousarray(mesh.triangles.T)))
        return cls(design, layout, law, model, triangles, mesh, space, space.tabulate(QUADRATURE_ORDER))

    @property
    def points(self) -> Floats:
        """(T Q, 2) mm, the quadrature points."""
        return self.table.points.reshape(-1, 2)

    @property
    @abstractmethod
    def values(self) -> Any:
        """The law at the stars, or at the sizes of the rods; computed once.

        Raises LawError: the law is for another material, or its values are impossible for a sheet.
        """

    @abstractmethod
    def fields(self, values: Any) -> Fields:
        """Rest metric, rest curvature and stiffness at the quadrature points, from the values of the law."""

    @abstractmethod
    def plastic_mm(self) -> Callable[[Floats], Floats]:
        """Mean height in mm of the plastic at printed points (n, 2) mm, as a function that gives (n,)."""

    def loads(self) -> Floats:
        """(N, 3) N, the weight of fabric and plastic."""
        design, plastic_mm = self.design, self.plastic_mm()
        direction = np.asarray(design.gravity.direction, dtype=float)
        pull = design.gravity.acceleration_m_s2 * direction / np.linalg.norm(direction)

        def weights(points: Floats) -> Floats:
            plastic = 1e-9 * design.plastic.density_kg_m3 * plastic_mm(points)
            return np.asarray((design.fabric.printed_mass + plastic)[:, None] * pull)

        return area_load(self.space, weights)

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
        """Take over what the new pattern leaves as it is, such as the triangles to show, if a shape was asked for."""
        meshes = [(each.mesh, each.usual_edge_mm) for each in (before.design, self.design)]
        if meshes[0] == meshes[1]:
            self.pin_softness = before.pin_softness
            if "shown_lens" in vars(before) and before.has_rods_of(self.layout):
                self.shown_mesh, self.shown_lens = before.shown_mesh, before.shown_lens.renewed(self)

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

    @cached_property
    def symmetries(self) -> list[Symmetry]:
        """Motions of the print that map the design to itself."""
        return symmetries(self.design, self.layout)

    @cached_property
    def shown_mesh(self) -> Mesh:
        """Triangles to show, with rods along edges as long as the design's, but at least `shown_edge` spacings."""
        design = self.design
        edge = max(design.usual_edge_mm, self.shown_edge * design.lattice.spacing_mm)
        return mesh_layout(self.layout, edge, design.mesh.kind, design.mesh.seed, draft=True)

    @cached_property
    def shown_lens(self) -> SheetLens:
        """The lens of the vertices of these triangles."""
        return self.lens(self.shown_mesh.points)

    @cached_property
    def pin_softness(self) -> Floats | None:
        """(T, Q) softness around supported points; None if the sheet has none."""
        pins, edge = self.layout.in_plane_pin_points, self.design.usual_edge_mm
        pulls = self.layout.is_supported_in_plane and len(pins) > 0
        return softness(self.mesh, pins, self.table.points, edge) if pulls else None

    def shell(self, fields: Fields, step: int) -> Shell:
        """The shell with the supports up to a step.

        Raises DesignError: the supports contradict each other.
        """
        # a sheet without supports would fall: gravity acts only from the step of the first supports on
        is_carried = self.layout.is_supported(step)
        loads = self.loads() if self.design.gravity.on and is_carried else np.zeros((self.space.size, 3))
        held, pins = partial(conditions, self.layout, self.mesh, self.space.mesh, step), self.layout.pins
        try:
            if step not in self.shells:
                shell = Shell(self.space, fields, held(), loads)
            else:
                before, shell = self.shells[step]
                shell = shell.with_fields(fields, loads)
                if not all(one.stands_as(other) for one, other in zip(pins, before, strict=True)):
                    shell = shell.with_target(impose_conditions(self.space, held()).target)
        except ConditionError as error:
            raise DesignError("pins", f"cannot all hold: {error}") from None
        self.shells[step] = pins, shell
        return shell


def conditions(layout: Layout, sheet: SheetMesh, mesh: MeshTri, step: int) -> list[Condition]:
    """Conditions of the shell from the pins that are active at a step of the release.

    `sheet`, `mesh`: the coarse mesh of the sheet, and the same mesh as a `MeshTri`.
    """
    active: list[Condition] = []
    facet_of = {tuple(ends): number for number, ends in enumerate(np.sort(mesh.facets, axis=0).T.tolist())}
    facets = np.array([facet_of[tuple(ends)] for ends in np.sort(sheet.rim, axis=1).tolist()])
    for number, pin in enumerate(layout.pins):
        if not pin.is_active(step):
            continue
        directions, name = pin.directions, f"pins[{number}]"
        if len(pin.points):
            active.append(PointSupport(vertices_at(mesh, pin.points), pin.places(pin.points), directions, name))
        if pin.edges:
            placement, shift = affine(*pin.affine_motion), None if pin.curve is None else pin.curve.shift
            its = facets[np.isin(sheet.side, pin.edges)]
            active.append(EdgeSupport(its, placement, directions, shift=shift, name=name))
    return active
