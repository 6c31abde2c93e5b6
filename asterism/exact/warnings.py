"""What to know of an exact shape before trusting it, from its summary and its pins."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from asterism.exact.star_sides import off_branch
from asterism.shape.pin_warnings import pin_warnings
from asterism.shape.self_intersections import passing
from asterism.shape.site_warnings import site_warnings
from pattern.layout.layout import Layout

# edges over the spacing of the stars from which on a free roll's radius is near that of finer meshes
FINE = 0.03


def exact_warnings(summary: Mapping[str, Any], layout: Layout) -> list[str]:
    """One line each; `summary` has everything but them."""
    lines = []
    if not summary["converged"]:
        reached, wanted = summary["gradient_norm"], summary["gradient_tolerance"]
        lines.append(f"not an equilibrium: gradient {reached:.1e} N is above {wanted:.1e} N")
    elif not summary["is_minimum"]:
        least = summary["smallest_eigenvalue"]
        lines.append(f"not an equilibrium: smallest eigenvalue {least:.1e} N/mm is not positive")
    lines += passes_through(summary)
    rolls = not layout.is_supported_in_plane and summary["roll_axis_deg"] is not None
    if rolls and summary["edge_mm"] > FINE * layout.spacing_mm:
        depends = "the radius of a free roll depends on the mesh"
        lines.append(f"{depends}: that of the gallery's tube by a quarter between edges of 2 and 0.5 mm (docs: mesh)")
    weighs = summary["design"]["gravity"]["on"]
    return [*lines, *off_branch(summary), *site_warnings(layout), *pin_warnings(layout, weighs)]


def passes_through(summary: Mapping[str, Any], sheet: str = "the sheet") -> Iterator[str]:
    """A line, if an exact shape passes through itself, from its summary; without contact, what keeps it apart."""
    if pairs := summary["self_intersections"]:
        yield passing(pairs, sheet) + ("; --contact keeps it apart" if summary.get("self_contact", {}) is None else "")
