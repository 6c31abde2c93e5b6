"""Warnings of an exact shape, from its summary and its supports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.results.words import passing, star_numbers
from asterism.shape.design_warnings import pin_warnings, site_warnings, sizing_warnings

# edge length over the spacing of the stars, above which the radius of a free roll depends on the mesh of hinges
MAX_ROLL_EDGE_FACTOR = 0.03


def exact_warnings(summary: Mapping[str, Any], design: Design, layout: Layout) -> list[str]:
    """One line for each warning. `summary` holds every entry but `warnings`."""
    lines = []
    if not summary["converged"]:
        norm, tolerance = summary["gradient_norm"], summary["gradient_tolerance"]
        lines.append(f"not an equilibrium: gradient {norm:.1e} N is above {tolerance:.1e} N")
    elif not summary["is_minimum"]:
        eigenvalue = summary["smallest_eigenvalue"]
        lines.append(f"not a minimum: smallest eigenvalue {eigenvalue:.1e} N/mm is not positive")
    if pairs := summary["self_intersections"]:
        remedy = "; --contact prevents this" if summary.get("self_contact", {}) is None else ""
        lines.append(f"{passing(pairs)}{remedy}")
    lines += _mesh(summary)
    rolls = not layout.is_supported_in_plane and summary["roll_axis_deg"] is not None
    if rolls and design.fabric.bending_follows_mesh and summary["edge_mm"] > MAX_ROLL_EDGE_FACTOR * layout.spacing_mm:
        depends = "the radius of a free roll depends on the mesh"
        lines.append(
            f"{depends}: for the gallery's tube it differs by a quarter between edges of 2 mm and 0.5 mm (docs: mesh)"
        )
    of_design = [*site_warnings(layout), *sizing_warnings(design, layout), *pin_warnings(layout, design.gravity.on)]
    return [*lines, *off_branch(summary), *of_design]


def _mesh(summary: Mapping[str, Any]) -> Iterator[str]:
    """A search that ended at its largest mesh, above its tolerance."""
    error, tolerance = summary["mesh_error_percent"], summary["mesh_tolerance_percent"]
    ended = f"the search ended at {summary['vertices']} vertices"
    if tolerance is not None and error is not None and error > tolerance:
        yield f"the mesh error, about {error:.1f} %, is above the tolerance of {tolerance:g} %: {ended}"
    elif tolerance is not None and summary["mesh_forms_differ"]:
        change = summary["mesh_change_percent"]
        yield f"the last two meshes have different forms, {change:.1f} % of the diameter apart: {ended}"


def off_branch(summary: Mapping[str, Any]) -> Iterator[str]:
    """Yield a line if the summary of an exact shape lists such stars."""
    if off := summary["stars_off_branch"]:
        stars = f"{len(off)} of {summary['stars_total']} stars of the exact shape"
        yield f"{stars} are not on the side that the design asks for: {star_numbers(off)}"
