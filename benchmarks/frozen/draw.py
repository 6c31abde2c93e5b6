"""The frozen designs as they were drawn, with fixed seeds: the two halves of the first set, and two later sets.

python -m benchmarks.frozen.draw [--second | --third]

Six kinds: free sheets and supported sheets with the outlines of `benchmarks.accuracy.held_designs`, canopies on four
to six needles, ribbons, held edges under weight, and stars of four to six arms. The command writes the designs into
benchmarks/results. The other commands read them from there, so that a later change of what can be printed does not
draw other ones; for the same reason the command does not replace other designs. The second set has the same kinds and
counts as both halves together. It was drawn when both halves had judged a preview model, and judges the next one. The
third set has half as many designs of each kind, but all of the unlike stars; it was drawn when the second was open.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.build import layout
from benchmarks.accuracy.designs import EDGE_MM, size_field
from benchmarks.accuracy.held_designs import OUTLINES, drawn_supports
from benchmarks.accuracy.printable import printable
from benchmarks.report import RESULTS, markdown, write_report

WORKING, SEALED = HALVES = ("working", "sealed")
SECOND, THIRD = LATER = ("second", "third")
GROUPS = (*HALVES, *LATER)
CHOSEN_ON = (*HALVES, SECOND)  # models may be chosen on these; the third set only judges
FREE, SUPPORTED, CANOPY, RIBBON, WEIGHT, ARMS = KINDS = (
    "free", "supported", "canopy", "ribbon", "weight", "arms",
)  # fmt: skip
COUNTS = {FREE: 20, SUPPORTED: 20, CANOPY: 16, RIBBON: 8, WEIGHT: 8, ARMS: 8}
LATER_COUNTS = {SECOND: COUNTS, THIRD: {FREE: 10, SUPPORTED: 10, CANOPY: 8, RIBBON: 4, WEIGHT: 4, ARMS: 8}}
STARS = (12, 130)  # fewest and most
# fewest and most stars that the area of an outline is drawn for
AIMED_STARS = {FREE: (14, 80), SUPPORTED: (14, 80), CANOPY: (40, 125), WEIGHT: (14, 60), ARMS: (14, 40)}
CELL_MM2 = DEFAULT_SPACING_MM**2 * np.sqrt(3.0) / 2.0
SEED, SPLIT_SEED = 38, 3838
LATER_SEEDS = {SECOND: 39, THIRD: 40}
# lattice, arms, turn in degrees
OTHER_STARS = [("square", 4, 0), ("triangular", 5, 0), ("square", 6, 0), ("triangular", 4, 30)]

NAME = "frozen.draw"

Data = dict[str, Any]


def main() -> int:
    """Write all designs of a set; exit status 1 if other ones are there."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.frozen.draw")
    which = parser.add_mutually_exclusive_group()
    for each in LATER:
        which.add_argument(f"--{each}", dest="later", action="store_const", const=each)
    later = parser.parse_args().later
    groups = {later: later_designs(later)} if later else drawn_designs()
    name = _name(later)
    rows: list[Data] = [
        {"half": group, "kind": kind, "stars": len(layout(design).centres), "design": design.to_dict()}
        for group, designs in groups.items()
        for kind, design in designs
    ]
    file = RESULTS / f"{name}.json"
    if file.exists() and json.loads(file.read_text(encoding="utf-8"))["rows"] != rows:
        print(f"{file} holds other designs: they were drawn by other code, and stay", file=sys.stderr)
        return 1
    stars = {(kind, group): list[str]() for kind in KINDS for group in groups}
    for row in rows:
        stars[row["kind"], row["half"]].append(str(row["stars"]))
    lines = [[kind, *(" ".join(stars[kind, group]) for group in groups)] for kind in KINDS]
    flag = f" --{later}" if later else ""
    header = ["kind", *(f"stars, {group} {'set' if group in LATER else 'half'}" for group in groups)]
    write_report(name, rows, markdown(header, lines), command=f"python -m benchmarks.frozen.draw{flag}")
    return 0


def frozen(group: str) -> list[tuple[str, Design]]:
    """The designs of a half, or of a later set, as they were written, each with its kind."""
    content = json.loads((RESULTS / f"{_name(group)}.json").read_text(encoding="utf-8"))
    return [(row["kind"], Design.from_dict(row["design"])) for row in content["rows"] if row["half"] == group]


def drawn_designs() -> dict[str, list[tuple[str, Design]]]:
    """The designs by half, each with its kind.

    A coin parts each pair of numbers that are half of the count of their kind apart: of free and supported sheets such
    a pair has the same outline and the same supports.
    """
    halves: dict[str, list[tuple[str, Design]]] = {half: [] for half in HALVES}
    for kind, count in COUNTS.items():
        coins = np.random.default_rng([SPLIT_SEED, KINDS.index(kind)]).integers(2, size=count // 2)
        for number in range(count):
            later = number >= count // 2
            half = HALVES[int(coins[number % (count // 2)]) ^ int(later)]
            halves[half].append((kind, drawn(kind, number)))
    return halves


def later_designs(group: str) -> list[tuple[str, Design]]:
    """The designs of a later set, each with its kind."""
    return [
        (kind, drawn(kind, number, LATER_SEEDS[group], group))
        for kind, count in LATER_COUNTS[group].items()
        for number in range(count)
    ]


def drawn(kind: str, number: int, seed: int = SEED, prefix: str = "frozen") -> Design:
    """Drawn again until it can be printed and its number of stars is within `STARS`."""
    rng = np.random.default_rng([seed, KINDS.index(kind), number])
    named = {"name": f"{prefix}-{kind}-{number:02d}", "mesh": {"edge_mm": EDGE_MM}}
    return printable(lambda: named | DRAWN[kind](rng, number), STARS)


def _free(rng: np.random.Generator, number: int) -> Data:
    outline = _outline(rng, number, FREE)
    return {"border": _polygon(outline), "stars": _stars(rng, outline)} | _fabric(rng)


def _supported(rng: np.random.Generator, number: int) -> Data:
    """Needles, lifted needles, or two edges moved together; weight is a kind of its own."""
    outline = _outline(rng, number, SUPPORTED)
    supports = drawn_supports(rng, outline, (number // len(OUTLINES) + number) % 4)
    return {"border": _polygon(outline), "stars": _stars(rng, outline)} | supports


def _weight(rng: np.random.Generator, number: int) -> Data:
    outline = _outline(rng, number, WEIGHT)
    return {"border": _polygon(outline), "stars": _stars(rng, outline)} | drawn_supports(rng, outline, 4)


def _canopy(rng: np.random.Generator, number: int) -> Data:
    """A polygon of four to six corners, of unequal radii, on a needle at each of them; equal stars."""
    corners = 4 + number % 3
    angle = 2.0 * np.pi * (np.arange(corners) + 0.5 + rng.uniform(-0.12, 0.12, corners)) / corners
    shape = rng.uniform(0.85, 1.15, corners)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    outline = _scaled(rng, shape * [1.0, rng.uniform(0.65, 1.0)], CANOPY)
    stars = {
        "length_mm": round(float(rng.uniform(6.0, 9.5)), 2),
        "thickness_mm": round(float(rng.uniform(0.28, 0.45)), 2),
    }
    scale = round(float(rng.uniform(0.6, 0.9)), 2)
    return {"border": _polygon(outline), "stars": stars, "pins": [{"where": "corners", "scale": scale}]}


def _ribbon(rng: np.random.Generator, number: int) -> Data:
    """Long rectangles, free, or held at one short side in a quarter of them; equal stars."""
    sides = [round(float(rng.uniform(*limits)), 1) for limits in ((150.0, 240.0), (30.0, 75.0))]
    stars = {
        "length_mm": round(float(rng.uniform(5.0, 9.5)), 2),
        "thickness_mm": round(float(rng.uniform(0.28, 0.45)), 2),
    }
    pins = [{"edges": [3], "scale": round(float(rng.uniform(0.72, 0.9)), 2)}] if number % 4 == 3 else []
    return {"border": {"rectangle_mm": sides}, "stars": stars, "pins": pins}


def _arms(rng: np.random.Generator, number: int) -> Data:
    """Four to six arms: free sheets, and sheets on needles."""
    kind, arms, turn = OTHER_STARS[number // 2 % len(OTHER_STARS)]
    outline = _outline(rng, number, ARMS)
    supports = drawn_supports(rng, outline, 1) if number % 2 else {}
    stars = {
        "length_mm": round(float(rng.uniform(5.5, 8.5)), 2),
        "thickness_mm": round(float(rng.uniform(0.28, 0.45)), 2),
    }
    lattice = {"kind": kind, "arms": arms, "orientation_deg": turn}
    return {"border": _polygon(outline), "stars": stars, "lattice": lattice} | supports


DRAWN: dict[str, Callable[[np.random.Generator, int], Data]] = {
    FREE: _free, SUPPORTED: _supported, CANOPY: _canopy, RIBBON: _ribbon, WEIGHT: _weight, ARMS: _arms,
}  # fmt: skip


def _outline(rng: np.random.Generator, number: int, kind: str) -> Floats:
    """(n, 2) mm, the outlines in turn, with an area for a number of stars."""
    return _scaled(rng, OUTLINES[number % len(OUTLINES)](rng), kind)


def _scaled(rng: np.random.Generator, outline: Floats, kind: str) -> Floats:
    fewest, most = AIMED_STARS[kind]
    area = CELL_MM2 * fewest * (most / fewest) ** rng.uniform()
    return np.asarray(outline * np.sqrt(area / polygon_area(outline)))


def _polygon(outline: Floats) -> Data:
    return {"polygon_mm": np.round(outline, 1).tolist()}


def _stars(rng: np.random.Generator, outline: Floats) -> Data:
    size = float(np.abs(outline).max())
    stars = {"length_mm": size_field(rng, 4.5, 10.5, size), "thickness_mm": size_field(rng, 0.26, 0.5, size)}
    return stars | ({"width_mm": round(float(rng.uniform(0.9, 1.5)), 2)} if rng.random() < 0.5 else {})


def _fabric(rng: np.random.Generator) -> Data:
    return {"fabric": {"stretch": 1.35 if rng.random() < 0.8 else 1.75}}


def _name(group: str | None) -> str:
    """Of the file in benchmarks/results that holds a group."""
    return f"{NAME}.{group}" if group in LATER else NAME


if __name__ == "__main__":
    sys.exit(main())
