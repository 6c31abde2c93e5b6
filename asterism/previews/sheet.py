"""The sheet of a design with stars: the law at the stars, smoothed cells, fields, arms, weight and bumps.

Sweeps, fits and reports preview one print many times. Mesh, elements, supports and the triangles that are shown depend
on the print alone: `sheet_for` gives the sheet of one of the last prints in this process another pattern.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.fields import FieldError, Fields
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.plan import without_law
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import check_type
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.rim_arms import free_normals, rim_curvature_share
from asterism.previews.fields.sheet_fields import sheet_fields
from asterism.previews.fields.star_cells import Shares, StarCells
from asterism.previews.fields.star_values import StarPlaces, StarShares, StarValues, star_values
from asterism.previews.model import PreviewModel
from asterism.previews.print_sheet import PrintSheet
from asterism.previews.star_lens import Arms, StarLens
from asterism.results.words import PlacedWarning, star_numbers
from asterism.shape.design_warnings import site_warnings, sizing_warnings

# how far back along an arm its star is, in spacings: half way to the next one (`sheet_fields.rosette_metric`)
ARM_SETBACK = 0.5
# attributes of a layout that determine the positions of its arms
ARM_PLACES = ("centres", "star_number", "arm_star", "arm_tip")


@dataclass(eq=False)
class Sheet(PrintSheet):
    """A printed sheet of stars."""

    shown_edge = 1 / 6
    most_triangles = 600

    law: StarLaw

    @cached_property
    def stars(self) -> StarShares:
        """The stars at the quadrature points."""
        layout, lattice, model, points = self.layout, self.design.lattice, self.model, self.points
        cells, back = StarCells(layout, lattice, model), ARM_SETBACK * lattice.spacing_mm
        curls = not layout.is_supported_in_plane
        return StarShares(
            Shares(cells, points),
            self.table.weights.shape,
            lattice.arm_directions,
            [Shares(cells, points - back * arm) for arm in lattice.arm_directions],
            free_normals(layout, points),
            rim_curvature_share(layout, lattice.arm_directions, model) if curls else None,
            layout.spacing_mm,
            model,
        )

    @cached_property
    def values(self) -> StarValues:
        """The law at the stars."""
        return star_values(self.design, self.layout, self.law, self.model)

    def lens(self, points: Floats) -> StarLens:
        """Computes the positions of printed points (n, 2) mm, with bumps."""
        return StarLens(self, points)

    def _follow(self, before: Self) -> None:
        if np.array_equal(self.layout.centres, before.layout.centres):
            self.stars = before.stars
        if before.has_rods_of(self.layout):
            self.arms = before.arms
        super()._follow(before)

    def has_rods_of(self, layout: Layout) -> bool:
        """Whether another layout of this sheet has its arms at the same positions; thickness and width may differ."""
        return all(np.array_equal(getattr(layout, name), getattr(self.layout, name)) for name in ARM_PLACES)

    @cached_property
    def arms(self) -> Arms:
        """Arms of the stars, for shells of this sheet."""
        return Arms(self.layout, self.space)

    def fields(self, values: StarValues) -> Fields:
        """Rest metric, rest curvature and stiffness at the quadrature points.

        Raises
        ------
        LawError
            The rest metric is not positive definite: adjacent stars contract too differently.
        """
        places = StarPlaces(self.stars, values, self.pin_softness, self.design.fabric.is_orthotropic)
        fields = sheet_fields(places)
        try:
            fields.rest(self.table.points)
        except FieldError as error:
            star = int(np.linalg.norm(self.layout.centres - error.place, axis=1).argmin())
            (x, y), lam = self.layout.centres[star], values.value["lam_n"][star]
            place = f"star {self.layout.star_number[star]} at [{x:.1f}, {y:.1f}]"
            message = f"{place}: lam_n = {lam:.4g} is too far from its neighbours': {error}"
            raise LawError(message, [self.layout.star_number[star]], (x, y)) from None
        return fields

    def plastic_mm(self) -> Callable[[Floats], Floats]:
        """Mean height of the plastic. Where the outline cuts a star's cell, it is spread over the rest of the cell."""
        covered = self.stars.shares.wide.T @ self.table.weights.ravel()
        volume = np.bincount(self.layout.arm_star, [rod.volume_mm3 for rod in self.layout.graph.rods], len(covered))
        return lambda points: np.asarray(Shares(self.stars.shares.cells, points).wide @ (volume / covered))

    def doubts(self) -> Iterator[str]:
        """Stars that the law does not describe."""
        values, count = self.values, len(self.layout.centres)
        if len(values.outside) > 1:
            yield PlacedWarning(
                f"{len(values.outside)} of {count} stars are outside the law's range, such as {values.outside[0]}; "
                "the preview takes the nearest star in the range",
                values.outside_stars,
            )
        else:
            yield from (PlacedWarning(line, values.outside_stars) for line in values.outside)
        yield from site_warnings(self.layout)
        yield from sizing_warnings(self.design, self.layout)
        graph, number = self.layout.graph, self.layout.star_number
        if graph.joints:  # the cells of the law have no bonds
            ends = [end for node in graph.joints for end in graph.ends_at[node]]
            stars = np.unique(number[[graph.rods[end.rod].group for end in ends]]).tolist()
            yield PlacedWarning(
                f"arms of different stars meet in {len(graph.joints)} place{'s' * (len(graph.joints) > 1)} and print "
                f"as one, but the law is of stars that do not touch; check with the exact model: {star_numbers(stars)}",
                stars,
            )
        tight, uneven = values.not_scale_separated, values.strongly_anisotropic
        if tight and not self.layout.is_supported_in_plane:  # supported sheets are as accurate with them
            yield PlacedWarning(
                f"{len(tight)} of {count} stars {'curls' if len(tight) == 1 else 'curl'} to a radius below two thirds "
                f"of their spacing, too tightly for a smooth sheet; check with the exact model: {star_numbers(tight)}",
                tight,
            )
        if uneven:
            yield PlacedWarning(
                f"{len(uneven)} of {count} stars {'curls' if len(uneven) == 1 else 'curl'} far more in some directions "
                f"than in others, which the law describes poorly; check with the exact model: {star_numbers(uneven)}",
                uneven,
            )


# prints that are kept, the last one used at the end: a fine sheet takes about 30 MB
KEPT_PRINTS = 2
_kept: list[PrintSheet] = []


def preview_layout(design: Design) -> Layout:
    """The layout of a design that has a preview.

    Raises
    ------
    DesignError
        The design cannot be printed; or its lines have no law, which is found before anything is computed.
    TypeError
        `design` is not a `Design`.
    """
    check_type(design, Design, "load_design reads one from a file")
    if design.rods is not None and (refused := without_law(design)) is not None:
        raise refused
    return layout(design)


def sheet_for(design: Design, plan: Layout, law: Any, triangles: int | None, model: PreviewModel) -> PrintSheet:
    """The sheet of a design with its layout and law, on the mesh of a kept print if one serves; see `PrintSheet.of`.

    Raises
    ------
    MeshError
        The outline cannot be meshed.
    TypeError
        The law is not one of such a pattern.
    """
    kind: type[PrintSheet] = Sheet
    if design.rods is None:
        check_type(law, StarLaw, "load_law reads one from a file")
    else:
        check_type(law, MotifLaw, "load_law reads the law of a motif from its file")
        from asterism.previews.motif_sheet import MotifSheet as kind  # designs of stars do without it
    kept = kept_print(design, plan, triangles, model)
    return kind.of(design, plan, law, triangles, model) if kept is None else kept.with_pattern(design, plan, law)


def keep_print(sheet: PrintSheet) -> None:
    """Keep the print of a sheet in place of the one that was used least recently; very fine sheets are not kept."""
    if sheet.space.mesh.nelements <= Sheet.most_triangles:
        same = kept_print(sheet.design, sheet.layout, sheet.asked_triangles, sheet.model)
        _kept[:] = [*(each for each in _kept if each is not same), sheet][-KEPT_PRINTS:]


def kept_print(design: Design, plan: Layout, triangles: int | None, model: PreviewModel) -> PrintSheet | None:
    """The kept sheet with the mesh, elements and supported places that a preview of a design would have, or None."""
    alike = (each for each in reversed(_kept) if (triangles, model) == (each.asked_triangles, each.model))
    return next((each for each in alike if each.is_same_print(design, plan)), None)
