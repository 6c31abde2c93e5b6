"""The summary of a preview."""

from __future__ import annotations

import numpy as np

from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.roll_axis import roll_axis_from_normals
from asterism.previews.expected_error import expected_error
from asterism.previews.other_forms import other_forms
from asterism.previews.state import PreviewState
from asterism.previews.warnings import overstretched_stars, preview_warnings
from asterism.results.records.preview import LawOriginRecord, PreviewRecord, TrialRecord
from asterism.shape.measures import sample_vertices, shape_numbers
from asterism.shape.self_intersections import meets_itself, self_intersections
from asterism.shape.shape import Shape

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
