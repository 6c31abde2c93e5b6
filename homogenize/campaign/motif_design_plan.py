"""The plan of the law of one design's motif: unit cells around the sizes that its rods have."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.campaign.design_plan import HELD_OUT_CELLS, geometric_nodes
from asterism.homogenize.law.motif_plan import (
    ROD_SIZE_KEYS,
    MotifPlan,
    MotifSize,
    RodSizeKey,
    rounded,
    source_of,
    without_motif_law,
)
from asterism.homogenize.law.plan import MIN_CELL_EDGE_MM
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.rods import Rods
from asterism.pattern.design.sizing.field import SizingField, sample
from asterism.pattern.design.sizing.profile import Profile
from asterism.pattern.design.stars import THICKNESS_RANGE_MM, WIDTH_RANGE_MM
from asterism.pattern.layout.print_layout import print_layout

# largest ratio of adjacent nodes: bending changes with the cube of the thickness, and membrane with the width
MAX_NODE_RATIO: dict[RodSizeKey, float] = {"thickness_mm": 1.12, "width_mm": 1.26}
LIMITS_MM: dict[RodSizeKey, tuple[float, float]] = {"thickness_mm": THICKNESS_RANGE_MM, "width_mm": WIDTH_RANGE_MM}
# of the nodes of all sizes together
MAX_CELLS = 2000


def plan_for_motif(design: Design) -> MotifPlan:
    """The cells for the motif of a design, whose sizes enclose those of its rods.

    Each group of lines with one sizing field is an axis of the law. Lines whose size is a number of their own keep it.

    Raises
    ------
    DesignError
        The design has no motif alone, its fabric has no bending, or too many sizes vary.

    Examples
    --------
    >>> motif = [{"line_mm": [(0, 0), (10, 0)]}, {"line_mm": [(0, 0), (0, 10)]}]
    >>> thickness = {"profile": "radial", "from": 0.4, "to": 0.5, "over_mm": 30}
    >>> grid = Design.from_dict({
    ...     "rods": {"motif": motif, "thickness_mm": thickness}, "lattice": {"kind": "square", "spacing_mm": 10.0},
    ...     "border": {"rectangle_mm": (60, 60)},
    ... })
    >>> for size in plan_for_motif(grid).sizes:
    ...     print(size.key, size.lines, size.nodes)
    thickness_mm (0, 1) (0.4, 0.4472, 0.5)
    width_mm (0, 1) (1.2,)
    """
    if design.rods is None:
        raise DesignError("rods.motif", "is missing: the law of stars is another one")
    if (refused := without_motif_law(design)) is not None:
        raise DesignError(*refused)
    edge = design.usual_edge_mm
    if edge < MIN_CELL_EDGE_MM:
        raise DesignError("mesh.edge_mm", f"must be at least {MIN_CELL_EDGE_MM:g} for the cells of a law", edge)
    groups = _groups(design.rods)
    varies = any(isinstance(field, Profile) for _, field, _ in groups)
    places = _places(design) if varies else np.zeros((1, 2))
    sizes = tuple(
        MotifSize(key, lines, _nodes(key, rounded(design.rods, key, sample(field, places))))
        for key, field, lines in groups
    )
    if (count := int(np.prod([len(size.nodes) for size in sizes]))) > MAX_CELLS:
        fields = sum(size.varies for size in sizes)
        raise DesignError("rods.motif", f"has {fields} sizes that vary, and its law {count} cells; {MAX_CELLS} at most")
    held_out = HELD_OUT_CELLS if any(size.varies for size in sizes) else 0
    return MotifPlan(_cell(design, design.rods, sizes), sizes, edge, held_out)


def _groups(rods: Rods) -> list[tuple[RodSizeKey, SizingField, tuple[int, ...]]]:
    """Key, sizing field and lines of each size of the law: the common one, and each profile of single lines."""
    groups: list[tuple[RodSizeKey, SizingField, tuple[int, ...]]] = []
    for key in ROD_SIZE_KEYS:
        left = [n for n, line in enumerate(rods.motif) if _is_free(rods, n, key) or getattr(line, key) is None]
        while left:
            field = source_of(rods, rods.motif[left[0]], key)
            alike = tuple(n for n in left if source_of(rods, rods.motif[n], key) == field)
            groups.append((key, field, alike))
            left = [n for n in left if n not in alike]
    return groups


def _is_free(rods: Rods, number: int, key: RodSizeKey) -> bool:
    return isinstance(source_of(rods, rods.motif[number], key), Profile)


def _places(design: Design) -> Floats:
    """(n, 2) mm, printed points at which sizes are sampled: along the rods, and the corners of the outline."""
    layout = print_layout(design)
    return np.concatenate([layout.outline, *(rod.points for rod in layout.graph.rods)])


def _nodes(key: RodSizeKey, values: Floats) -> tuple[float, ...]:
    low, high = LIMITS_MM[key]
    return tuple(geometric_nodes(np.clip(values, low, high), MAX_NODE_RATIO[key]))


def _cell(design: Design, rods: Rods, sizes: tuple[MotifSize, ...]) -> Design:
    """A design with the motif alone, each of whose lines has numbers as its own sizes."""
    data = design.to_dict()
    lines: list[dict[str, Any]] = data["rods"]["motif"]
    for line, drawn in zip(lines, rods.motif, strict=True):
        for key in ROD_SIZE_KEYS:
            field = source_of(rods, drawn, key)
            if not isinstance(field, Profile):
                line[key] = float(rounded(rods, key, np.array([field]))[0])
    for size in sizes:
        for number in size.lines:
            lines[number][size.key] = size.nodes[0]
    side = 3.0 * design.lattice.spacing_mm
    rest = {key: data["rods"][key] for key in ("curve_mm", "join_mm")}
    return Design.from_dict(
        {
            "name": design.name,
            "fabric": data["fabric"],
            "plastic": data["plastic"],
            "lattice": {key: value for key, value in data["lattice"].items() if key != "origin_mm"},
            "rods": {"motif": lines, **rest},
            "border": {"rectangle_mm": [side, side]},
        }
    )
