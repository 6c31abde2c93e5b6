"""The sheet of a design with stars: the law at the stars, smoothed cells, fields, arms, weight and bumps.

Sweeps, fits and reports preview one print many times. Mesh, elements, supports and the triangles that are shown depend
on the print alone: `sheet_for` gives the sheet of one of the last prints in this process another pattern.

The points of the sheet stand over the smooth surface of the shell: by its bumps and by its arms.

**Bumps.** The law describes the heights of a cell over its mean surface by the amplitudes of a few waves of the lattice
(`homogenize.cell.corrugation_waves`): amplitudes of the flat cell, and their change as the sheet curls to its natural
tube. At a place shared by several stars, the amplitudes are averaged, so that the corrugation has no jumps. The bare
rim is as low as the tips of the arms beside it. A printed point moves by its height along the shell's normal.

**Between the flat and the natural cell.** Stars that hardly buckle in a flat sheet buckle soon after the sheet begins
to curl. In cells of long thin stars, seven tenths of the change are complete when a star turns by half a radian over
its spacing d, independently of its natural curvature kappa. The share of the change at a curvature k is

    s(k) = tanh(k d / t) / tanh(kappa d / t),    t = `BUMP_TURN_RAD`,

which is linear for stars of small natural curvature. In a sheet that is bent to the other side, s(k) is negative.

**Supports that stretch the sheet** flatten the bumps: the tension grows with the strain, and a bump is inversely
proportional to its stiffness. If lengths exceed those of the flat cell by the strain e, the height is divided by
`1 + e / 0.045`.

**At supports** the corrugation is zero, and it grows over the distance in which fabric follows a tip,
`FABRIC_BEYOND_TIP`.

**Arms** keep their length l where the sheet contracts to `lam l`, so that a tip lies `(1 - lam) l` further out on the
sheet. Arms that meet tip to tip are compressed a little. Fabric at the distance q from an arm follows the arm by
exp(-q/b). Supported points stay in place. The shares of an arm in the moves at fixed points depend on that arm alone,
so an edit that changes a few arms needs new shares of these only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.elements.argyris import Argyris
from asterism.fem.shell.fields import FieldError, Fields
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.plan import without_law
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import check_type
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.sheet_fields import free_normals, rim_curvature_share, sheet_fields
from asterism.previews.fields.star_cells import Shares, StarCells, beside, shared, stars_share
from asterism.previews.fields.star_values import StarPlaces, StarValues, star_values
from asterism.previews.model import PreviewModel
from asterism.previews.places import Places, SheetLens
from asterism.previews.print_sheet import PrintSheet
from asterism.results.words import PlacedWarning, star_numbers
from asterism.shape.measures import site_warnings, sizing_warnings


class StarLens(SheetLens):
    """Computes the positions of a fixed set of printed points (n, 2) mm with bumps, for shells of a sheet of stars."""

    def _follow(self, before: Any) -> None:
        sheet, layout = self.sheet, self.sheet.layout
        if before is None:
            far = layout.distance_to_supports(self.points)
            self._stays = np.minimum(far / (FABRIC_BEYOND_TIP * layout.spacing_mm), 1.0)
            self._tree = cKDTree(self.points)
        if before is None or sheet.law is not before.law:
            self._waves = sheet.law.waves(self.points - layout.lattice_origin)
        if before is None or sheet.stars is not before.stars:
            self._shares = Shares(sheet.stars.shares.cells, self.points)
            self._nearest = cKDTree(layout.centres).query(self.points)[1]
        if before is None or sheet.arms is not before.arms:
            known = None if before is None else (before.arms, self._arm_shares)
            self._arm_shares: sp.csc_matrix = arm_shares(sheet.arms, self._tree, known)

    def __call__(self, x: Floats) -> Places:
        """The positions of the points for degrees of freedom x (N, 3) of the shell."""
        smooth, sheet = super().__call__(x), self.sheet
        values, off = sheet.values, sheet.model.off
        if "bumps" in off:
            return smooth
        weights = self._shares(values.sizes[:, 0])
        rim = 2.0 * smooth.mean_curvature, self._nearest, sheet.layout.spacing_mm
        heights = self._stays * corrugation_heights(self._waves, values, weights, *rim)
        if sheet.layout.pins:
            lam = np.maximum(beside(weights, values.value["lam"][:-1]), values.value["lam"].min())
            # half of a bump is left at a strain of 0.045: a fit to bumps of seven equal stars on held borders
            heights /= 1.0 + np.maximum(np.sqrt(smooth.area) / lam - 1.0, 0.0) / 0.045
        bumps = heights[:, None] * smooth.normals
        if "arms that keep their length" not in off:
            bumps += smooth.moved(self._arm_shares @ sheet.arms.moves(x))
        return replace(smooth, bumps=bumps)


# turn over a spacing in which bumps come most of the way from flat to natural: cells of long thin stars
BUMP_TURN_RAD = 0.55


def corrugation_heights(
    waves: Floats,
    values: StarValues,
    weights: sp.csr_matrix,
    curvature: Floats,
    nearest: Ints,
    spacing: float,
) -> Floats:
    """(n,) heights in mm over the smooth surface.

    `waves`: (n, W) the law's waves at the points; `values`: the law at the stars; `weights`: (n, S) share of each star
    at the points; `curvature`: (n,) 1/mm, sum of the shell's principal curvatures, positive where the plastic side is
    convex; `nearest`: (n,) nearest star of each point; `spacing`: mm, spacing of the stars.
    """
    flat, more = np.moveaxis(shared(weights, values.corrugation), 1, 0)
    bent = _bent(shared(weights, values.value["kappa"]), curvature, spacing)
    stars = np.einsum("nw,nw->n", flat + bent[:, None] * more, waves)
    near = beside(weights, values.value["kappa"][:-1], nearest)
    low, lower = beside(weights, values.tip_heights[:-1], nearest).T
    side = values.side[nearest]
    rim = side * np.minimum(side * (low + _bent(near, curvature, spacing) * lower), 0.0)
    return np.asarray(stars + (1.0 - stars_share(weights)) * rim)


def _bent(kappa: Floats, curvature: Floats, spacing: float) -> Floats:
    """(n,) `kappa s(k)` in 1/mm at curvatures k (n,): zero for a flat sheet, kappa at the natural curvature."""
    # smallest natural turn over one spacing in the formula for s(k), to avoid a division by zero
    own = np.maximum(np.abs(kappa) * spacing, 1e-4)
    return np.asarray(own / spacing * np.tanh(curvature * spacing / BUMP_TURN_RAD) / np.tanh(own / BUMP_TURN_RAD))


# spacings, in which the fabric beside an arm and beyond its tip follows it: b. Both follow from flat cells, as in
# pytest tests/asterism/previews/test_arms.py
FABRIC_BESIDE_ARM = 0.15
FABRIC_BEYOND_TIP = 0.25


class Arms:
    """The arms of a layout, for all shells on one mesh of the sheet.

    `layout`: as given; `centre`, `tip`: (A, 2) mm, both ends of the arms; `length`: (A,) mm; `room`: (A,) mm, distance
    of the tips from the supports; `direction`: (A, 2) unit vectors of the arms, from the centre to the tip.
    """

    def __init__(self, layout: Layout, space: Argyris) -> None:
        self.layout, self.tip = layout, layout.arm_tip
        self.centre = layout.centres[layout.arm_star]
        self.length = np.maximum(layout.arm_length, 1e-9)  # it divides
        self.direction = (self.tip - self.centre) / self.length[:, None]
        self.room = np.maximum(layout.distance_to_supports(self.tip), 1e-9)
        self._at_tips = space.locate(self.tip)

    def moves(self, x: Floats) -> Floats:
        """(A, 2) mm in print, how far the tips move along the sheet, for degrees of freedom x (N, 3) of the shell."""
        tangents = Places.at(self._at_tips, x).tangents
        stretch = np.linalg.norm(np.einsum("ai,aic->ac", self.direction, tangents), axis=1)
        # share of the distance to a support that a tip moves at most; origin unknown
        excess = np.clip((1.0 - stretch) * self.length, 0.0, 0.25 * self.room)
        return np.asarray((excess / np.maximum(stretch, 1e-9))[:, None] * self.direction)


def arm_shares(arms: Arms, tree: cKDTree, before: tuple[Arms, sp.csc_matrix] | None = None) -> sp.csc_matrix:
    """(n, A) shares of all arms, at the points (n, 2) mm of a tree, in the moves of the tips along the sheet.

    `before`: other arms, on a sheet with the same supported points, and their shares at these points. Those of arms
    that are the same are used again.
    """
    points = tree.data
    beside, beyond = (b * arms.layout.spacing_mm for b in (FABRIC_BESIDE_ARM, FABRIC_BEYOND_TIP))
    # fabric follows up to four times the length in which it does so by 1/e
    longest, pins = arms.length.max(), arms.layout.pin_points
    reach, known = 0.5 * float(longest) + 4.0 * beyond, np.zeros(len(arms.length), dtype=bool)
    if before is not None and len(before[0].length) == len(arms.length) and before[0].length.max() == longest:
        known = (before[0].centre == arms.centre).all(axis=1) & (before[0].tip == arms.tip).all(axis=1)
    new = np.flatnonzero(~known)
    middle = arms.centre[new] + 0.5 * arms.length[new, None] * arms.direction[new]
    pairs = cKDTree(middle).sparse_distance_matrix(tree, reach, output_type="ndarray")
    arm, point = new[pairs["i"]], np.ascontiguousarray(pairs["j"])
    offset, direction = points[point] - arms.centre[arm], arms.direction[arm]
    along = np.einsum("pc,pc->p", offset, direction)
    follows = along > 0.0  # the others are behind the centre of the star
    aside = (offset[:, 1] * direction[:, 0] - offset[:, 0] * direction[:, 1])[follows]
    arm, point, along = arm[follows], point[follows], along[follows]
    length = arms.length[arm]
    part, ahead = np.minimum(along / length, 1.0), np.maximum(along - length, 0.0)
    crease = 0.1  # over this multiple of b, the crease of exp(-q/b) on the arm is rounded
    near = np.exp(crease - np.sqrt(crease**2 + (aside / beside) ** 2 + (ahead / beyond) ** 2))
    near *= np.maximum(1.0 - np.sqrt(aside**2 + ahead**2) / arms.room[arm], 0.0)
    if len(pins):
        touched, where = np.unique(point, return_inverse=True)
        near *= np.minimum(cKDTree(pins).query(points[touched])[0] / beside, 1.0)[where]
    shares = sp.csc_matrix((part * near, (point, arm)), shape=(len(points), len(known)))
    if before is not None and known.any():
        shares = shares + before[1].multiply(known)
    return sp.csc_matrix(shares)


@dataclass(eq=False)
class Sheet(PrintSheet):
    """A printed sheet of stars."""

    shown_edge = 1 / 6
    most_triangles = 600

    law: StarLaw

    @cached_property
    def stars(self) -> StarPlaces:
        """The stars at the quadrature points; sheets with stars at the same places share them, whatever their law."""
        layout, lattice, model, points = self.layout, self.design.lattice, self.model, self.points
        # how far back along an arm its star is, in spacings: half way to the next one (`sheet_fields.rosette_metric`)
        cells, back = StarCells(layout, lattice, model), 0.5 * lattice.spacing_mm
        curls = not layout.is_supported_in_plane
        return StarPlaces(
            Shares(cells, points),
            self.table.weights.shape,
            self.values,
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
        # attributes of a layout that determine the positions of its arms
        return all(
            np.array_equal(getattr(layout, name), getattr(self.layout, name))
            for name in ("centres", "star_number", "arm_star", "arm_tip")
        )

    @cached_property
    def arms(self) -> Arms:
        """Arms of the stars, for shells of this sheet."""
        return Arms(self.layout, self.space)

    def fields(self, values: StarValues) -> Fields:
        """Rest metric, rest curvature and stiffness at the quadrature points.

        Raises LawError: the rest metric is not positive definite: adjacent stars contract too differently.
        """
        has_grain = self.design.fabric.is_orthotropic
        fields = sheet_fields(replace(self.stars, values=values, softness=self.pin_softness, has_grain=has_grain))
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


# the last one used is at the end
_kept: list[PrintSheet] = []


def preview_layout(design: Design) -> Layout:
    """The layout of a design that has a preview.

    Raises DesignError: the design cannot be printed; or its lines have no law, which is found before anything is
    computed.
    Raises TypeError: `design` is not a `Design`.
    """
    check_type(design, Design, "load_design reads one from a file")
    if design.rods is not None and (refused := without_law(design)) is not None:
        raise refused
    return layout(design)


def sheet_for(design: Design, plan: Layout, law: Any, triangles: int | None, model: PreviewModel) -> PrintSheet:
    """The sheet of a design with its layout and law, on the mesh of a kept print if one serves; see `PrintSheet.of`.

    Raises MeshError: the outline cannot be meshed.
    Raises TypeError: the law is not one of such a pattern.
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
    """Keep the print of a sheet in place of the one used last but one; very fine sheets are not kept."""
    if sheet.space.mesh.nelements <= Sheet.most_triangles:
        same = kept_print(sheet.design, sheet.layout, sheet.asked_triangles, sheet.model)
        _kept[:] = [*(each for each in _kept if each is not same), sheet][-2:]  # a fine sheet takes about 30 MB


def kept_print(design: Design, plan: Layout, triangles: int | None, model: PreviewModel) -> PrintSheet | None:
    """The kept sheet with the mesh, elements and supported places that a preview of a design would have, or None."""
    alike = (each for each in reversed(_kept) if (triangles, model) == (each.asked_triangles, each.model))
    return next((each for each in alike if each.is_same_print(design, plan)), None)
