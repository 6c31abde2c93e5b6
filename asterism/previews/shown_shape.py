"""The shape that a preview shows, its summary, and its estimated error.

The shape has triangles with rods along their edges, placed on the shell with the stars' bumps.

**Estimated error.** Nine of ten exact shapes of the preview's kind of sheet were found within it. The kinds differ by
how a sheet is held and by its number of stars. The numbers are measured (`python -m benchmarks.accuracy`), and nothing
is computed from the sheet itself: the exact model, a second later, is the answer. Heights differ by a share of the
diameter, also on sheets that are nearly flat.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.roll_axis import roll_axis_from_normals
from asterism.pattern.mesh.mesh import Mesh
from asterism.previews.other_forms import other_forms
from asterism.previews.solve import PreviewState
from asterism.previews.warnings import overstretched_stars, preview_warnings
from asterism.results.records.preview import LawOriginRecord, PreviewRecord, TrialRecord
from asterism.shape.measures import sample_vertices, shape_numbers
from asterism.shape.self_intersections import meets_itself, self_intersections
from asterism.shape.shape import Shape
from asterism.shape.surface_fields import cell_fields


def shown_shape(state: PreviewState) -> Shape:
    """The shape with bumps, without a summary; the principal axes of a free sheet lie along x, y and z.

    The field `bump_mm` holds the vectors from the smooth surface to the shape. Normals, curvatures and strains are
    those of the smooth surface.
    """
    layout, mesh, places = state.layout, state.sheet.shown.mesh, state.sheet.shown.lens(state.x)
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
    """Fields of the rod edges: number of the rod, its star, and thickness and width at the middle of the edge."""
    rods = layout.graph.rods
    number, part = _parts_along([mesh.points[path] for path in mesh.rods])
    within = number[1:] == number[:-1]  # false for steps from one rod to the next
    number, middle = number[1:][within], 0.5 * (part[1:] + part[:-1])[within]
    # all rods on one line, each from its number to the next
    places, knots = number + middle, np.add(*_parts_along([rod.points for rod in rods]))
    thickness, width = (np.concatenate([getattr(rod, name) for rod in rods]) for name in ("thickness", "width"))
    fields = {
        "arm": number,
        "star": layout.star_of_rods[number],
        "thickness_mm": np.interp(places, knots, thickness),
        "width_mm": np.interp(places, knots, width),
    }
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


# axes that differ by a smaller angle count as one
EQUAL_AXES_DEG = 2.0


def summary(state: PreviewState, shape: Shape, seconds: dict[str, float]) -> PreviewRecord:
    """The record of a preview's shape. Keys that it shares with the record of an exact shape have the same meaning."""
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
        expected_rms_percent=error and error.distance,
        expected_height_percent=error and error.height * across / height if height else None,
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
        mesh=state.sheet.shown.mesh.kind,
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
        if all(abs((image - known + 90.0) % 180.0 - 90.0) > EQUAL_AXES_DEG for known in axes):
            axes.append(image)
    return sorted(axes)


class ExpectedError(NamedTuple):
    """In % of the diameter; nine of ten exact shapes are nearer.

    Attributes
    ----------
    distance : rms distance to the exact shape.
    height : difference of the heights.
    """

    distance: float
    height: float


# without supports that act along the print
FREE = ExpectedError(4.0, 3.3)
# held, and under weight
HEAVY = ExpectedError(5.0, 6.0)
# held, of at most FEW_STARS, and of more
HELD_FEW = ExpectedError(5.0, 3.0)
HELD_MANY = ExpectedError(1.3, 2.1)
FEW_STARS = 24
# motifs of drawn rods, free or held: nets roll up about another axis than their previews, or hardly
MOTIF = ExpectedError(17.0, 5.5)
# share of the stars or rods: with more of them unlike those of the measured sheets, nothing is stated
MAX_FOREIGN_SHARE = 0.1


def expected_error(state: PreviewState) -> ExpectedError | None:
    """The estimated error of a state; None with many stars or rods that its law does not describe.

    A sheet that slides on all of its supports counts as free.

    Examples
    --------
    >>> from asterism.pattern import gallery
    >>> from asterism.previews.session import Preview
    >>> expected_error(Preview(gallery.load("dome")).state) is HELD_MANY
    True
    """
    layout, values = state.layout, state.sheet.values
    if not layout.has_stars:
        return MOTIF if len(values.outside) <= MAX_FOREIGN_SHARE * values.places else None
    inverted = int(np.count_nonzero(layout.star_branch < 0))
    stars = len(layout.centres)
    if max(len(values.outside), len(values.strongly_anisotropic), inverted) > MAX_FOREIGN_SHARE * stars:
        return None
    if not state.is_supported:
        return FREE
    if state.design.gravity.on:
        return HEAVY
    return HELD_FEW if stars <= FEW_STARS else HELD_MANY
