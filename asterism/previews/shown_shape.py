"""The shape that a preview shows, its summary, its estimated error, and its warnings.

The shape has triangles with rods along their edges, placed on the shell with the stars' bumps.

**Estimated error.** Nine of ten exact shapes of the preview's kind of sheet were found within it. The kinds differ by
how a sheet is held and by its number of stars. The numbers are measured (`python -m benchmarks.accuracy`), and nothing
is computed from the sheet itself: the exact model, a second later, is the answer. Heights differ by a share of the
diameter, also on sheets that are nearly flat.

**Overstretched stars.** Around them a preview is longer than its fabric can be, so that it is no shape of the sheet. A
cell of the released sheet can return to its printed lengths. So its fabric stores no more energy than in print, apart
from the bending of its arms, which is small beside it. Let q be the mean of `tr(F^T F)/2` over a cell, with the
gradient F from print, and s the stretch in print. The energy of the neo-Hookean fabric (`discrete.energies.membrane`)
per rest area is at least

    W(y) = mu (y - 1 - ln y) + lam/2 (ln y)^2    for    ln y < mu/lam,    mu (y - 1) - mu^2/(2 lam)    beyond,

at `tr C = 2 y`: the least over J, which is J = y as far as `ln y < mu/lam`. W is convex and grows for y above 1. By
Jensen's inequality, q is at most y/s^2 with W(y) equal to the energy in print. That is 1 up to `ln s^2 = mu/lam`, and a
little more for fabric that is stretched further. The incompressible fabric has the limit 1 at every stretch.

Supports at other distances than in print change the bound. If p > 1 is the largest ratio of the distances of two
supported points in space and in print, some shape meets the supports and has no length above p times the printed one
(Kirszbraun 1934). It takes the place of the print. Within a spacing of the supports there is no bound: fabric that is
pulled at points stretches further. Weight is not bounded in this way either.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.distance import pdist

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.search.mean_fields import mean_fields, side_of
from asterism.fem.search.relax import is_collapsing
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric
from asterism.pattern.design.stars import ROD_SIZE_KEYS
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.geometry.planar import triangle_areas
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.roll_axis import roll_axis_from_normals
from asterism.pattern.mesh.mesh import Mesh
from asterism.previews.search_minima import MIN_SIZE_RATIO
from asterism.previews.solve import EDIT_START, PreviewState, other_forms
from asterism.results.records.shape import LawOriginRecord, PreviewRecord, TrialRecord
from asterism.results.words import PlacedWarning, passing, star_numbers
from asterism.shape.measures import pin_warnings, sample_vertices, shape_numbers
from asterism.shape.shape import Shape
from asterism.shape.surface import cell_fields, deformation_gradients, meets_itself, self_intersections


def shown_shape(state: PreviewState) -> Shape:
    """The shape with bumps, without a summary; the principal axes of a free sheet lie along x, y and z.

    The field `bump_mm` holds the vectors from the smooth surface to the shape. Normals, curvatures and strains are
    those of the smooth surface.
    """
    layout, mesh, places = state.layout, state.sheet.shown_mesh, state.sheet.shown_lens(state.x)
    star = np.full(len(mesh.points), -1, dtype=np.int64)
    star[mesh.star_vertices] = layout.star_number
    shape = Shape(
        printed=mesh.points,
        positions=places.bumpy,
        triangles=mesh.triangles,
        star=star,
        rods=mesh.rods,
        star_vertices=mesh.star_vertices,
        point_fields={
            "bump_mm": places.bumps,
            "normal": places.normals,
            "mean_curvature_per_mm": places.mean_curvature,
            "gaussian_curvature_per_mm2": places.gaussian_curvature,
        },
        cell_fields=cell_fields(mesh.points, places.smooth, mesh.triangles, state.design.fabric.stretch_xy),
        rod_fields=_rod_fields(layout, mesh),
        held=bool(layout.pins),
        plan=layout,
    )
    return shape if shape.held else shape.aligned()


def _rod_fields(layout: Layout, mesh: Mesh) -> dict[str, np.ndarray]:
    """Fields of the rod edges: number of the rod, its star, and the sizes of its section at the middle of the edge."""
    rods = layout.graph.rods
    number, part = _parts_along([mesh.points[path] for path in mesh.rods])
    within = number[1:] == number[:-1]  # false for steps from one rod to the next
    number, middle = number[1:][within], 0.5 * (part[1:] + part[:-1])[within]
    # all rods on one line, each from its number to the next
    places, knots = number + middle, np.add(*_parts_along([rod.points for rod in rods]))
    sections = np.concatenate([rod.sections for rod in rods]).T
    fields: dict[str, np.ndarray] = {"arm": number, "star": layout.star_of_rods[number]}
    for key, values in zip(ROD_SIZE_KEYS, sections, strict=True):
        fields[key] = np.interp(places, knots, values)
    return fields | ({"side": layout.rod_side[number]} if (layout.rod_side < 0).any() else {})


def _parts_along(lines: Sequence[Floats]) -> tuple[Ints, Floats]:
    """(n,) number of its line for each of the points of all lines, and (n,) part of the line's length before it."""
    counts = np.array([len(line) for line in lines])
    number, first = np.repeat(np.arange(len(counts)), counts), np.cumsum(counts) - counts
    points = np.concatenate(lines)
    step = np.linalg.norm(np.diff(points, axis=0, prepend=points[:1]), axis=1)
    step[first] = 0.0
    length, total = np.cumsum(step), np.bincount(number, step)
    return number, (length - length[first][number]) / total[number]


def summary(state: PreviewState, shape: Shape, seconds: dict[str, float]) -> PreviewRecord:
    """The record of a preview's shape; keys that the record of an exact shape has too have the same meaning."""
    equilibrium, layout, error = state.equilibrium, state.layout, expected_error(state)
    law, values = state.sheet.law, state.sheet.values
    axis = roll_axis_from_normals(layout, shape.point_fields["normal"][sample_vertices(layout, shape)])
    across, height = diameter(shape.positions), shape.height_mm
    surface = shape.positions, shape.triangles
    crossings = self_intersections(*surface) if meets_itself(shape.printed, *surface) else 0
    overstretched = overstretched_stars(shape, state.design, layout).tolist()
    numbers = shape_numbers(layout, shape, equilibrium, axis)
    numbers["is_minimum"] = equilibrium.is_minimum and not overstretched
    if not layout.has_stars:
        numbers["rods_total"] = len(layout.graph.rods)
    return PreviewRecord(
        model=PreviewRecord.model_name,
        **numbers,
        soft_modes_n_mm3=[float(value) for value in equilibrium.soft_modes],
        stars=len(layout.centres),
        equivalent_axes_deg=equivalent_axes_deg(state, axis),
        side=state.side,
        start=equilibrium.guess,
        starts=[
            TrialRecord(**{name: getattr(trial, name) for name in ("name", "energy", "is_minimum", "iterations")})
            for trial in equilibrium.trials
        ],
        other_forms=[form for form, _ in (other_forms(state) if equilibrium.trials else ())],
        expected_rms_percent=error and error[0],
        expected_height_percent=error and error[1] * across / height if height else None,
        law=LawOriginRecord(
            material=law.plan.design.name,
            stretch=float(state.design.fabric.stretch_xy[0]),
            edge_mm=law.edge_mm,
            made_by=law.made.get("command"),
        ),
        law_in_range=not values.outside,
        stars_outside_law=list(values.outside) if layout.has_stars else [],
        stars_overstretched=overstretched,
        stars_tight=list(values.not_scale_separated) if layout.has_stars else [],
        stars_uneven=list(values.strongly_anisotropic) if layout.has_stars else [],
        shell_triangles=state.sheet.space.mesh.nelements,
        dofs=state.shell.reduction.map.shape[1],
        mesh=state.sheet.shown_mesh.kind,
        load_steps=equilibrium.load_steps,
        wall_s=sum(seconds.values()),
        wall_s_by_stage=seconds,
        diameter_mm=across,
        self_intersections=crossings,
        warnings=list(preview_warnings(state, shape, crossings, overstretched)),
        design=state.design.to_dict(),
    )


def equivalent_axes_deg(state: PreviewState, axis_deg: float | None) -> list[float]:
    """The axes (0 to 180 deg) to which the symmetries of the design map the roll axis; empty if it is None."""
    if axis_deg is None:
        return []
    along = np.array([np.cos(np.radians(axis_deg)), np.sin(np.radians(axis_deg))])
    axes: list[float] = []
    for symmetry in state.sheet.symmetries:
        x, y = symmetry.turn @ along
        image = float(np.degrees(np.arctan2(y, x)) % 180.0)
        # axes that differ by a smaller angle count as one
        if all(abs((image - known + 90.0) % 180.0 - 90.0) > 2.0 for known in axes):
            axes.append(image)
    return sorted(axes)


def expected_error(state: PreviewState) -> tuple[float, float] | None:
    """In % of the diameter, the rms distance to the exact shape, and the difference of the heights.

    Nine of ten exact shapes are nearer. None with many stars or rods that the law does not describe. A sheet that
    slides on all of its supports counts as free.
    """
    layout, values = state.layout, state.sheet.values
    # share of the stars or rods: with more of them unlike those of the measured sheets, nothing is stated
    most_foreign = 0.1
    if not layout.has_stars:  # nets roll up about another axis than their previews, or hardly
        return (17.0, 5.5) if len(values.outside) <= most_foreign * values.places else None
    inverted = int(np.count_nonzero(layout.star_branch < 0))
    stars = len(layout.centres)
    if max(len(values.outside), len(values.strongly_anisotropic), inverted) > most_foreign * stars:
        return None
    if not state.is_supported:
        return 4.0, 3.3
    if state.design.gravity.on:
        return 5.0, 6.0
    return (5.0, 3.0) if stars <= 24 else (1.3, 2.1)


def overstretched_stars(shape: Shape, design: Design, layout: Layout) -> Ints:
    """Numbers of the stars around which a shape is longer than its fabric can be; none if the sheet has weight."""
    if design.gravity.on or not layout.has_stars:
        return np.empty(0, dtype=np.int64)
    far = np.ones(len(layout.centres), dtype=bool)
    if shape.held:
        far = layout.distance_to_supports(layout.centres) > layout.spacing_mm
    over = mean_square_stretch(shape, layout) > mean_square_limit(design.fabric, support_ratio(layout))
    return np.asarray(layout.star_number[over & far])


def mean_square_limit(fabric: Fabric, ratio: float = 0.0) -> float:
    """Upper bound of the mean square stretch from print, for a ratio of distances of supports in space and in print."""
    pull = max(1.0, ratio) ** 2
    square = pull * float(np.prod(fabric.stretch_xy))
    bend = 0.5 * (1.0 - fabric.poisson) / fabric.poisson if fabric.poisson else np.inf  # mu/lam
    if fabric.model != "neo-hookean" or np.log(square) <= bend:
        return pull
    energy = square - 1.0 - np.log(square) + 0.5 * np.log(square) ** 2 / bend
    return float(pull * (1.0 + 0.5 * bend + energy) / square)


def mean_square_stretch(shape: Shape, layout: Layout) -> Floats:
    """(S,) mean of `tr(F^T F)/2` over the printed area that is nearest to each star, F from print."""
    gradients = deformation_gradients(shape.printed, shape.positions, shape.triangles)
    area = triangle_areas(shape.printed, shape.triangles)
    star = cKDTree(layout.centres).query(shape.printed[shape.triangles].mean(axis=1))[1]
    square = 0.5 * np.einsum("tca,tca->t", gradients, gradients)
    count = len(layout.centres)
    # a star without a triangle of its own has nothing to stretch
    return np.asarray(np.bincount(star, area * square, count) / np.maximum(np.bincount(star, area, count), 1e-300))


def support_ratio(layout: Layout) -> float:
    """The largest distance of two supported points in space over their distance in print; 0 with fewer than two."""
    printed, places, _ = layout.support_samples
    held = ~np.isnan(places[:, :2]).any(axis=1)
    if held.sum() < 2:
        return 0.0
    in_print, in_space = pdist(printed[held]), pdist(np.nan_to_num(places[held]))
    # supported points that are closer together in print, in spacings, are one point
    apart = in_print > 1e-3 * layout.spacing_mm
    return float((in_space[apart] / in_print[apart]).max(initial=0.0))


def preview_warnings(state: PreviewState, shape: Shape, crossings: int, overstretched: Sequence[int]) -> Iterator[str]:
    """The warnings, in the order of their causes: pattern, supports, equilibrium, shape.

    `crossings` pairs of triangles pass through each other; around the stars `overstretched` the shape is too long.
    """
    collapses = not state.layout.has_stars and is_collapsing(state.shell, state.equilibrium)
    if collapses:
        yield (
            "not an equilibrium: at wide rims the tension of the fabric bends the preview more than its rods resist; "
            "make the rods thicker or wider, or use the exact model: asterism simulate"
        )
    yield from state.sheet.doubts()
    yield from _about_supports(state, shape)
    if not collapses:
        yield from _about_equilibrium(state)
    if crossings:
        yield f"{passing(crossings)}; the exact model can prevent that (solver.contact, --contact)"
    if overstretched:
        yield PlacedWarning(
            f"not a shape of this sheet: around {len(overstretched)} of {len(state.layout.centres)} stars it is longer "
            f"than the fabric can stretch; use the exact model: {star_numbers(overstretched)}",
            overstretched,
        )


def size_ratio(state: PreviewState) -> float:
    """Size that the supports allow over the natural size; inf for a sheet that they do not hold along the print."""
    if not state.is_supported:
        return np.inf
    means = mean_fields(state.shell)
    return means.chord / means.stretch


def _about_supports(state: PreviewState, shape: Shape) -> Iterator[str]:
    """Pins that fix too little or stretch the sheet flat, inverted stars, and a requested side that was not reached."""
    layout, ratio = state.layout, size_ratio(state)
    yield from pin_warnings(layout, state.design.gravity.on)
    # its size over its natural size, and its height over its diameter: it is flat because of its pins
    if 1.1 < ratio < np.inf and shape.height_mm / diameter(shape.positions) < 0.03:
        scale = layout.common_pin_scale
        advice = "" if scale is None else f"; use a scale of about {scale / ratio:.2g} to let it rise"
        yield f"the pins stretch the sheet to {ratio:.2f} times its natural size, so that it is nearly flat{advice}"
    if inverted := layout.star_number[layout.star_branch < 0].tolist():
        yield PlacedWarning(
            f"{'1 star' if len(inverted) == 1 else f'{len(inverted)} stars'} of the design "
            f"{'is' if len(inverted) == 1 else 'are'} inverted (branch down), but the law describes bumps up; "
            f"check with the exact model: {star_numbers(inverted)}",
            inverted,
        )
    side = side_of(state.shell, state.equilibrium.x) if state.side != "auto" else "auto"
    if side not in ("auto", state.side):
        yield f"the edges go {side}: the preview reached no equilibrium with edges {state.side}, as requested"


def _about_equilibrium(state: PreviewState) -> Iterator[str]:
    """A form that an edit kept, and results that are not a stable equilibrium."""
    shown = state.equilibrium
    if shown.guess == EDIT_START and (not state.is_supported or size_ratio(state) < MIN_SIZE_RATIO):
        yield "the edit kept the form of the sheet before it; start a new preview to search for forms of lower energy"
    if not shown.converged:
        yield f"not an equilibrium: gradient {shown.gradient_norm:.1e} N is above {shown.tolerance:.1e} N"
    elif not shown.definite:
        yield "an unstable equilibrium: a real sheet leaves this shape; start a new preview to search for a minimum"
