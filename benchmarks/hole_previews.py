"""Previews of sheets with holes against the exact model: one half of the sheets to work with, the other to report.

python -m benchmarks.hole_previews [working | held_out]
"""

from __future__ import annotations

import sys
from functools import partial
from typing import Any

import numpy as np

from asterism.pattern.design.design import Design
from benchmarks.motif_previews import EDGE_MM, HALVES, LARGEST_RATIO, measured, printable, table
from benchmarks.motif_shells import MOTIFS
from benchmarks.report import write_report

SEED = 2
HOLES = ("circle", "polygon", "spline")
# sides of the sheets, mm
MOTIF_SIDES_MM, STAR_SIDES_MM = (60.0, 90.0), (110.0, 140.0)
THICKNESS_MM, STAR_LENGTH_MM = (0.32, 0.5), (6.0, 9.0)
# radius of a hole over the shorter side of the sheet; its centre is at most so far from the middle, over each side
HOLE_RADIUS, HOLE_OFFSET = (0.1, 0.22), 0.15
CORNERS_OF_POLYGON, CORNERS_OF_SPLINE = 5, 8
# a drawn line with so many corners bulges by this part of its radius
BULGE = 0.15


def drawn_sheets() -> dict[str, list[tuple[str, Design]]]:
    """The sheets of both halves: of each pattern one free and one on needles, with a round, straight or curved hole."""
    rng = np.random.default_rng(SEED)
    halves: dict[str, list[tuple[str, Design]]] = {half: [] for half in HALVES}
    for number, name in enumerate(("grid", "lines", "stars")):
        for supported in (False, True):
            half = (number + supported) % 2
            words = ["on needles" if supported else "free", HOLES[(number + half) % len(HOLES)]]
            design = printable(partial(_drawn, rng, name, *words))
            halves[HALVES[half]].append((f"{name}, {', '.join(words)}", design))
    return halves


def _drawn(rng: np.random.Generator, name: str, support: str, kind: str) -> Design:
    sides = np.round(rng.uniform(*(STAR_SIDES_MM if name == "stars" else MOTIF_SIDES_MM), size=2))
    thickness = _linear(rng, sides, THICKNESS_MM)
    pattern: dict[str, Any]
    if name == "stars":
        pattern = {"stars": {"length_mm": round(rng.uniform(*STAR_LENGTH_MM), 1), "thickness_mm": thickness}}
    else:
        lines, lattice = MOTIFS[name]
        pattern = {"rods": {"motif": lines, "thickness_mm": thickness}, "lattice": lattice}
    hole = _hole(rng, sides, kind)
    scale = round(rng.uniform(0.85, 0.95), 3)
    return Design.from_dict(
        {
            "name": f"{name}-{support.replace(' ', '-')}-{kind}",
            **pattern,
            "border": {"rectangle_mm": sides.tolist(), "holes": [hole]},
            "pins": [] if support == "free" else [{"where": "corners", "scale": scale}],
            "mesh": {"edge_mm": EDGE_MM},
        }
    )


def _linear(rng: np.random.Generator, sides: np.ndarray, least: tuple[float, float]) -> dict[str, Any]:
    """A thickness that grows from one side of the sheet to the other, in any direction."""
    low, angle = round(rng.uniform(*least), 2), rng.uniform(0.0, np.pi)
    along = 0.4 * sides.min() * np.array([np.cos(angle), np.sin(angle)])
    high = round(low * rng.uniform(1.0, LARGEST_RATIO), 2)
    ends = {"start_mm": (-along).round(1).tolist(), "end_mm": along.round(1).tolist()}
    return {"profile": "linear", "from": low, "to": high, **ends}


def _hole(rng: np.random.Generator, sides: np.ndarray, kind: str) -> dict[str, Any]:
    centre = (rng.uniform(-HOLE_OFFSET, HOLE_OFFSET, size=2) * sides).round(1)
    radius = round(float(rng.uniform(*HOLE_RADIUS) * sides.min()), 1)
    if kind == "circle":
        return {"circle_mm": {"centre": centre.tolist(), "radius": radius}}
    count = CORNERS_OF_POLYGON if kind == "polygon" else CORNERS_OF_SPLINE
    angles = (np.arange(count) + rng.uniform()) / count * 2.0 * np.pi
    reach = radius * (1.0 + BULGE * rng.uniform(-1.0, 1.0, size=count))
    corners = (centre + reach[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])).round(2)
    return {f"{kind}_mm": corners.tolist()}


def without_holes(design: Design) -> Design:
    """The same sheet of whole fabric."""
    data = design.to_dict()
    data["border"].pop("holes")
    return Design.from_dict(data)


def main(halves: list[str]) -> None:
    sheets = drawn_sheets()
    parts, rows = [], []
    for half in halves:
        tables = []
        for holes in (True, False):
            of_half = [measured(name, design if holes else without_holes(design)) for name, design in sheets[half]]
            rows += [{"half": half, "holes": holes, **row} for row in of_half]
            tables.append(f"{'With' if holes else 'The same sheets without'} holes:\n\n{table(of_half)}")
        parts.append(f"## {half.replace('_', ' ').capitalize()} sheets\n\n" + "\n\n".join(tables))
    text = f"Previews of sheets with holes against the exact model, edges of {EDGE_MM:g} mm.\n\n" + "\n\n".join(parts)
    print(text)
    if halves == list(HALVES):
        write_report("hole_previews", rows, text)


if __name__ == "__main__":
    main(sys.argv[1:] or list(HALVES))
