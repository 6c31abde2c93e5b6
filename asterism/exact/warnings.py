"""Warnings of an exact shape, from its summary and its supports."""

from __future__ import annotations

from collections.abc import Iterator

from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.results.records.exact import ExactRecord
from asterism.results.words import passing, star_numbers
from asterism.shape.design_warnings import pin_warnings, site_warnings, sizing_warnings


def exact_warnings(record: ExactRecord, design: Design, layout: Layout) -> list[str]:
    """One line for each warning. The record holds every entry but `warnings`."""
    lines = []
    if not record.converged:
        gradient = f"gradient {record.gradient_norm:.1e} N is above {record.gradient_tolerance:.1e} N"
        lines.append(f"not an equilibrium: {gradient}")
    elif not record.is_minimum:
        lines.append(f"not a minimum: smallest eigenvalue {record.smallest_eigenvalue:.1e} N/mm is not positive")
    if pairs := record.self_intersections:
        remedy = "; --contact prevents this" if record.self_contact is None else ""
        lines.append(f"{passing(pairs)}{remedy}")
    # a search that ended at its largest mesh, above its tolerance
    error, tolerance = record.mesh_error_percent, record.mesh_tolerance_percent
    ended = f"the search ended at {record.vertices} vertices"
    if tolerance is not None and error is not None and error > tolerance:
        lines.append(f"the mesh error, about {error:.1f} %, is above the tolerance of {tolerance:g} %: {ended}")
    elif tolerance is not None and record.mesh_forms_differ:
        change = f"{record.mesh_change_percent:.1f} % of the diameter apart"
        lines.append(f"the last two meshes have different forms, {change}: {ended}")
    rolls = not layout.is_supported_in_plane and record.roll_axis_deg is not None
    # edge length over the spacing of the stars, above which the radius of a free roll depends on the mesh of hinges
    if rolls and design.fabric.bending_follows_mesh and record.edge_mm > 0.03 * layout.spacing_mm:
        depends = "the radius of a free roll depends on the mesh"
        lines.append(
            f"{depends}: for the gallery's tube it differs by a quarter between edges of 2 mm and 0.5 mm (docs: mesh)"
        )
    of_design = [*site_warnings(layout), *sizing_warnings(design, layout), *pin_warnings(layout, design.gravity.on)]
    return [*lines, *off_branch(record), *of_design]


def off_branch(record: ExactRecord) -> Iterator[str]:
    """Yield a line if an exact shape has such stars."""
    if off := record.stars_off_branch:
        stars = f"{len(off)} of {record.stars_total} stars of the exact shape {'is' if len(off) == 1 else 'are'}"
        yield f"{stars} not on the side that the design asks for: {star_numbers(off)}"
