"""The numbers of a preview's summary.json, and what a reader should know before trusting them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from asterism import __version__
from asterism.exact.star_sides import few
from asterism.laws.directions_line import directions_line
from asterism.laws.error_lines import coarse_line, mesh_line, pleats_line
from asterism.previews.search.equilibria import EDIT, NARROW
from asterism.previews.uncertainty.expected import (
    UNSURE,
    amplitudes_percent,
    another_form_is_near,
    buckling,
    close_form,
    expected_rms_percent,
    share_of,
)
from asterism.previews.uncertainty.expected_height import HeightDoubts, expected_height_percent
from asterism.previews.uncertainty.other_forms import OtherForm, other_forms
from asterism.shape.contraction import contraction
from asterism.shape.diameter import diameter
from asterism.shape.pin_warnings import pin_warnings
from asterism.shape.self_intersections import meets_itself, passing, self_intersections
from asterism.shape.shape import Shape
from asterism.shape.tube import roll_radius
from fem.search.mean_fields import mean_fields
from fem.search.sides import side_of
from homogenize.cell.directions import is_threefold, left_out
from pattern.geometry.planar import polygon_area
from pattern.layout.likeness import rolled_about
from pattern.mesh.mesh import Mesh

if TYPE_CHECKING:
    from asterism.previews.session import Preview

# the softest motion is called neutral if the next one is this many times stiffer
NEUTRAL = 5.0
SAME_AXIS_DEG = 2.0
# times the width that its stars want, and height over diameter: held wider, so flat a sheet has no length for a rise
WIDE, FLAT = 1.1, 0.03
# part of the energy at stake by which one buckled form may be above another, and yet be the right one
BUCKLES = 0.5
FOREIGN = 0.1  # part of the stars: with more of them outside the law, or uneven, nothing is known of the error


def summary(
    preview: Preview,
    shape: Shape,
    mesh: Mesh,
    doubts: HeightDoubts | None,
    depends: float,
    seconds: dict[str, float],
) -> dict[str, Any]:
    """Keys as in a simulation's summary where they mean the same; `depends`: mm, see `contrast`."""
    found, layout, law = preview.equilibrium, preview.sheet.layout, preview.law
    axis = _roll_axis(preview, shape)
    sheet = shape.positions, shape.triangles
    through = self_intersections(*sheet) if meets_itself(shape.printed, *sheet) else 0
    size = polygon_area(layout.border), diameter(shape.positions)
    others = other_forms(preview, size[1])
    amplitudes = amplitudes_percent(found.soft_modes, found.absolute_energy, *size)
    unequal = 100.0 * depends / size[1]
    held = layout.is_pulled
    wants = mean_fields(preview.shell) if held else None
    width = wants.chord / wants.stretch if wants else np.inf
    # held sheets are not asked for their symmetries
    share = share_of(held, () if held else preview.symmetries)
    tight = len(preview.values.tight) / len(layout.centres)
    # what is expected was found with three-armed stars within their law's range, and holds for others with stable cells
    down = int(np.count_nonzero(layout.star_branch < 0))
    foreign = max(len(preview.values.outside), len(preview.values.uneven), down)
    turned = is_threefold(preview.design.lattice) and left_out(preview.design.lattice)
    known = not (turned or mesh_line(law) or pleats_line(law))
    known = known and foreign <= FOREIGN * len(layout.centres)
    return {
        "model": "preview",
        "converged": found.converged,
        "is_minimum": found.is_minimum,
        "gradient_norm": found.gradient_norm,
        "gradient_tolerance": found.tolerance,
        "energy_n_mm": found.energy,
        "energy_parts_n_mm": found.energies,
        "soft_modes_n_mm3": [float(value) for value in found.soft_modes],
        "soft_amplitudes_percent": [float(value) for value in amplitudes],
        "contrast_percent": unequal,
        "stars": len(layout.centres),
        "roll_axis_deg": axis,
        "equivalent_axes_deg": _equivalent_axes(preview, axis),
        "roll_radius_mm": None if axis is None else roll_radius(shape, layout.lattice_vectors),
        "side": preview.side,
        "start": found.guess,
        "starts": [
            {name: getattr(trial, name) for name in ("name", "energy", "is_minimum", "iterations")}
            for trial in found.trials
        ],
        "other_forms": [vars(form) for form in others],
        "law": {
            "material": law.material.name,
            "stretch": law.check(preview.design).stretch,
            "edge_mm": law.edge_mm,
            "made_by": law.made.get("command"),
        },
        "expected_rms_percent": expected_rms_percent(amplitudes, others, share, held, tight, width, unequal)
        if known
        else None,
        "expected_height_percent": expected_height_percent(doubts, share) if known and doubts else None,
        "height_doubts_mm": vars(doubts) if doubts else None,
        "law_in_range": not preview.values.outside,
        "stars_outside_law": list(preview.values.outside),
        "stars_tight": list(preview.values.tight),
        "stars_uneven": list(preview.values.uneven),
        "smoothing_mm": preview.sheet.cells.width_mm,
        "shell_triangles": preview.sheet.space.mesh.nelements,
        "dofs": preview.shell.reduction.map.shape[1],
        "vertices": len(mesh.points),
        "triangles": len(mesh.triangles),
        "mesh": mesh.kind,
        "iterations": found.iterations,
        "factorisations": found.factorisations,
        "saddles_left": found.saddles_left,
        "load_steps": found.load_steps,
        "wall_s": sum(seconds.values()),
        "wall_s_by_stage": seconds,
        "height_mm": shape.height_mm,
        "extent_mm": list(shape.extent_mm),
        "contraction": contraction(preview.sheet.layout, shape),
        "self_intersections": through,
        "warnings": warnings(
            preview, axis, another_form_is_near(amplitudes, held), others, through, width, shape.height_mm / size[1]
        ),
        "version": __version__,
        "design": preview.design.to_dict(),
    }


def warnings(
    preview: Preview,
    axis: float | None,
    soft_in_two_ways: bool = False,
    others: Sequence[OtherForm] = (),
    through: int = 0,
    width: float = np.inf,
    height: float = np.inf,
) -> list[str]:
    """One line each; `width` at which the sheet is held, over its own, and its `height` over its diameter."""
    found, values, layout = preview.equilibrium, preview.values, preview.sheet.layout
    lines = list(values.outside)
    if len(lines) > 1:
        lines = [f"{len(lines)} of {len(layout.centres)} stars are outside the law, such as {lines[0]}"]
    of_law = (line(preview.law) for line in (directions_line, coarse_line, mesh_line, pleats_line))
    lines += [line for line in of_law if line]
    if values.tight and not layout.is_pulled:  # held sheets are as near with them
        lines.append(
            f"{len(values.tight)} of {len(layout.centres)} stars curl to a radius below two thirds of their spacing, "
            f"where a smooth sheet says little: {few(values.tight)}"
        )
    if values.uneven:
        lines.append(
            f"{len(values.uneven)} of {len(layout.centres)} stars curl far more in some directions than in others, of "
            f"which the law knows little: {few(values.uneven)}"
        )
    lines += pin_warnings(layout, preview.design.gravity.on)
    if WIDE < width < np.inf and height < FLAT:
        scales = {pin.scale for pin in layout.pins if pin.target_mm is None}
        narrower = f": a scale of about {scales.pop() / width:.2g} lets it rise" if len(scales) == 1 else ""
        lines.append(f"the pins hold the sheet {width:.2f} times as wide as its stars want it, nearly flat{narrower}")
    down = layout.star_number[layout.star_branch < 0].tolist()
    if down:
        lines.append(f"the law's stars bump up, but {len(down)} of the design start down: {few(down)}")
    if preview.side != "auto" and (side := side_of(preview.shell, found.x)) not in ("auto", preview.side):
        lines.append(f"the edges were asked to go {preview.side}, but no such form was reached: they go {side}")
    if width < NARROW and not soft_in_two_ways:
        buckles = "held narrower than it would be, the sheet may buckle in several ways"
        if found.guess == EDIT:
            lines.append(f"{buckles}: a new preview looks for lower ones")
        elif buckling(width) == 1.0 or any(form.gap < BUCKLES for form in others):
            lines.append(f"{buckles}, and the law cannot tell which is lowest: the exact model may take another form")
    elif found.guess == EDIT and not layout.is_pulled:
        lines.append("the edit went on from the form before it: a new preview looks for lower ones")
    if not found.converged:
        lines.append(f"not an equilibrium: gradient {found.gradient_norm:.1e} N, above {found.tolerance:.1e} N")
    elif not found.definite:
        lines.append("an equilibrium that is not stable")
    if soft_in_two_ways:
        lines.append("soft in more than one way: the sheet may rest in another form")
    if (other := close_form(others)) is not None:
        energy = f"nearly the same energy ({100.0 * other.gap:+.1f} %): the exact model may take that one"
        if other.gap < -UNSURE:
            energy = f"{-100.0 * other.gap:.0f} % less energy: the exact model will likely take that one"
        lines.append(f"another form, {other.distance_percent:.0f} % of the diameter away, has {energy}")
    if through:
        lines.append(f"{passing(through)}; the exact model can keep it apart (solver.contact, --contact)")
    soft = found.soft_modes
    if axis is not None and len(soft) > 1 and soft[1] > NEUTRAL * soft[0]:
        softer = f"one motion is {soft[1] / soft[0]:.0f} times softer than all others"
        even = f"an even sheet hardly prefers the axis about which it rolls ({axis:.0f} deg)"
        lines.append(f"{softer}: {'small changes move it far' if layout.is_pulled else even}")
    return lines


def _roll_axis(preview: Preview, shape: Shape) -> float | None:
    """Axis of a rolled sheet in print coordinates, 0 to 180 deg from the x axis; None for other shapes."""
    return rolled_about(preview.sheet.layout, shape.point_fields["normal"][shape.star_vertices])


def _equivalent_axes(preview: Preview, axis: float | None) -> list[float]:
    """Axes about which the design might as well have rolled, by its symmetries; the one taken among them."""
    if axis is None:
        return []
    along = np.array([np.cos(np.radians(axis)), np.sin(np.radians(axis))])
    found: list[float] = []
    for symmetry in preview.symmetries:
        x, y = symmetry.turn @ along
        other = float(np.degrees(np.arctan2(y, x)) % 180.0)
        if all(abs((other - known + 90.0) % 180.0 - 90.0) > SAME_AXIS_DEG for known in found):
            found.append(other)
    return sorted(found)
