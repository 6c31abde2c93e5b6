"""What to know of an exact shape before trusting it, from its summary and its pins."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from asterism.pin_warnings import pin_warnings
from asterism.self_intersections import passing
from asterism.star_sides import off_branch
from pattern.layout import Layout


def exact_warnings(summary: Mapping[str, Any], layout: Layout) -> list[str]:
    """One line each; `summary` has everything but them."""
    lines = []
    if not summary["converged"]:
        reached, wanted = summary["gradient_norm"], summary["gradient_tolerance"]
        lines.append(f"not an equilibrium: gradient {reached:.1e} N is above {wanted:.1e} N")
    elif not summary["is_minimum"]:
        least = summary["smallest_eigenvalue"]
        lines.append(f"not an equilibrium: smallest eigenvalue {least:.1e} N/mm is not positive")
    if pairs := summary["self_intersections"]:
        lines.append(passing(pairs) + ("" if summary["self_contact"] else "; --contact keeps it apart"))
    return [*lines, *off_branch(summary), *pin_warnings(layout, summary["design"]["gravity"]["on"])]
