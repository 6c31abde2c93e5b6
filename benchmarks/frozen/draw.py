"""The frozen designs as they were drawn, with fixed seeds: the two halves of the first set, and later sets.

python -m benchmarks.frozen.draw

Six kinds: free sheets and supported sheets with five kinds of outlines, canopies on four to six needles, ribbons, held
edges under weight, and stars of four to six arms. All designs stand in designs.json, from where the other commands read
them: a later change of what can be printed does not draw other ones. The command adds the newest set if it is not
there, and says if it draws others than those that are.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.build import layout
from asterism.results.files import write_file

WORKING, SEALED = HALVES = ("working", "sealed")
CHOSEN_ON = (*HALVES, "second", "third")  # models may be chosen on these; the newest set only judges
NEWEST, SEED = "fourth", 41  # another set gets another name and another seed
GROUPS = (*CHOSEN_ON, NEWEST)
FREE, SUPPORTED, CANOPY, RIBBON, WEIGHT, ARMS = KINDS = (
    "free", "supported", "canopy", "ribbon", "weight", "arms",
)  # fmt: skip
COUNTS = {FREE: 16, SUPPORTED: 16, CANOPY: 10, RIBBON: 6, WEIGHT: 6, ARMS: 6}
STARS = (12, 130)  # fewest and most
# fewest and most stars that the area of an outline is drawn for
AIMED_STARS = {FREE: (14, 80), SUPPORTED: (14, 80), CANOPY: (40, 125), WEIGHT: (14, 60), ARMS: (14, 40)}
# lattice, arms, turn in degrees
OTHER_STARS = [("square", 4, 0), ("triangular", 5, 0), ("square", 6, 0), ("triangular", 4, 30)]

FILE = Path(__file__).parent / "designs.json"

Data = dict[str, Any]


def main() -> int:
    """Draw all designs of the newest set; exit status 1 if other ones are there."""
    rows: list[Data] = json.loads(FILE.read_text(encoding="utf-8"))
    new = [(kind, drawn(kind, number)) for kind, count in COUNTS.items() for number in range(count)]
    if (known := frozen(NEWEST)) and known != new:
        print(f"{FILE} holds other designs: they were drawn by other code, and stay", file=sys.stderr)
        return 1
    if not known:
        rows += [{"group": NEWEST, "kind": kind, "design": _chosen(design)} for kind, design in new]
        write_file(FILE, "[\n" + ",\n".join(map(json.dumps, rows)) + "\n]\n")
    for kind in KINDS:
        stars = [str(len(layout(design).centres)) for each, design in new if each == kind]
        print(f"{NEWEST}, {kind}: {' '.join(stars)} stars")
    return 0


def frozen(group: str) -> list[tuple[str, Design]]:
    """The designs of a half, or of a later set, as they were written, each with its kind."""
    rows = json.loads(FILE.read_text(encoding="utf-8"))
    return [(row["kind"], Design.from_dict(row["design"])) for row in rows if row["group"] == group]


def _chosen(design: Design) -> Data:
    """The table of a design without the sections that have their defaults."""
    data, always = design.to_dict(), ("stars", "border", "fabric")
    default = Design.from_dict({key: data[key] for key in always}).to_dict()
    return {key: value for key, value in data.items() if key in always or value != default[key]}


def drawn(kind: str, number: int) -> Design:
    """Drawn again until it can be printed and its number of stars is within `STARS`."""
    rng = np.random.default_rng([SEED, KINDS.index(kind), number])
    while True:
        data = {"name": f"{NEWEST}-{kind}-{number:02d}"} | DRAWN[kind](rng, number)
        try:
            design = Design.from_dict(data)
            if STARS[0] <= len(layout(design).centres) <= STARS[1]:
                return design
        except DesignError:
            continue


def _free(rng: np.random.Generator, number: int) -> Data:
    outline = _outline(rng, number, FREE)
    return {"border": _polygon(outline), "stars": _stars(rng, outline)} | _fabric(rng)


def _supported(rng: np.random.Generator, number: int) -> Data:
    """Needles, lifted needles, or two edges moved together; weight is a kind of its own."""
    outline = _outline(rng, number, SUPPORTED)
    supports = _drawn_supports(rng, outline, (number // len(_OUTLINES) + number) % 4)
    return {"border": _polygon(outline), "stars": _stars(rng, outline)} | supports


def _weight(rng: np.random.Generator, number: int) -> Data:
    outline = _outline(rng, number, WEIGHT)
    return {"border": _polygon(outline), "stars": _stars(rng, outline)} | _drawn_supports(rng, outline, 4)


def _canopy(rng: np.random.Generator, number: int) -> Data:
    """A polygon of four to six corners, of unequal radii, on a needle at each of them; equal stars."""
    corners = 4 + number % 3
    angle = 2.0 * np.pi * (np.arange(corners) + 0.5 + rng.uniform(-0.12, 0.12, corners)) / corners
    shape = rng.uniform(0.85, 1.15, corners)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    outline = _scaled(rng, shape * [1.0, rng.uniform(0.65, 1.0)], CANOPY)
    stars = _equal_stars(rng, 6.0, 9.5)
    scale = round(float(rng.uniform(0.6, 0.9)), 2)
    return {"border": _polygon(outline), "stars": stars, "pins": [{"where": "corners", "scale": scale}]}


def _ribbon(rng: np.random.Generator, number: int) -> Data:
    """Long rectangles, free, or held at one short side in a quarter of them; equal stars."""
    sides = [round(float(rng.uniform(*limits)), 1) for limits in ((150.0, 240.0), (30.0, 75.0))]
    stars = _equal_stars(rng, 5.0, 9.5)
    pins = [{"edges": [3], "scale": round(float(rng.uniform(0.72, 0.9)), 2)}] if number % 4 == 3 else []
    return {"border": {"rectangle_mm": sides}, "stars": stars, "pins": pins}


def _arms(rng: np.random.Generator, number: int) -> Data:
    """Four to six arms: free sheets, and sheets on needles."""
    kind, arms, turn = OTHER_STARS[number // 2 % len(OTHER_STARS)]
    outline = _outline(rng, number, ARMS)
    supports = _drawn_supports(rng, outline, 1) if number % 2 else {}
    stars = _equal_stars(rng, 5.5, 8.5)
    lattice = {"kind": kind, "arms": arms, "orientation_deg": turn}
    return {"border": _polygon(outline), "stars": stars, "lattice": lattice} | supports


DRAWN: dict[str, Callable[[np.random.Generator, int], Data]] = {
    FREE: _free, SUPPORTED: _supported, CANOPY: _canopy, RIBBON: _ribbon, WEIGHT: _weight, ARMS: _arms,
}  # fmt: skip


def _outline(rng: np.random.Generator, number: int, kind: str) -> Floats:
    """(n, 2) mm, the outlines in turn, with an area for a number of stars."""
    return _scaled(rng, _OUTLINES[number % len(_OUTLINES)](rng), kind)


def _scaled(rng: np.random.Generator, outline: Floats, kind: str) -> Floats:
    fewest, most = AIMED_STARS[kind]
    area = DEFAULT_SPACING_MM**2 * np.sqrt(3.0) / 2.0 * fewest * (most / fewest) ** rng.uniform()
    return np.asarray(outline * np.sqrt(area / polygon_area(outline)))


def _polygon(outline: Floats) -> Data:
    return {"polygon_mm": np.round(outline, 1).tolist()}


def _stars(rng: np.random.Generator, outline: Floats) -> Data:
    size = float(np.abs(outline).max())
    stars = {"length_mm": _size_field(rng, 4.5, 10.5, size), "thickness_mm": _size_field(rng, 0.26, 0.5, size)}
    return stars | ({"width_mm": round(float(rng.uniform(0.9, 1.5)), 2)} if rng.random() < 0.5 else {})


def _equal_stars(rng: np.random.Generator, shortest: float, longest: float) -> Data:
    length, thickness = rng.uniform(shortest, longest), rng.uniform(0.28, 0.45)
    return {"length_mm": round(float(length), 2), "thickness_mm": round(float(thickness), 2)}


def _fabric(rng: np.random.Generator) -> Data:
    return {"fabric": {"stretch": 1.35 if rng.random() < 0.8 else 1.75}}


def _size_field(rng: np.random.Generator, low: float, high: float, size: float) -> Any:
    """A number, or from one value to another: from the middle outwards, or along a direction."""
    one, other = (round(float(value), 3) for value in rng.uniform(low, high, 2))
    kind = rng.random()
    if kind < 0.35:
        return one
    if kind < 0.7:
        power = float(rng.choice([0.5, 1.0, 2.0]))
        return {"profile": "radial", "from": one, "to": other, "over_mm": round(size, 1), "power": power}
    angle = rng.uniform(0.0, 2.0 * np.pi)
    end = np.round(size * np.array([np.cos(angle), np.sin(angle)]), 1)
    return {"profile": "linear", "from": one, "to": other, "start_mm": (-end).tolist(), "end_mm": end.tolist()}


def _circle(rng: np.random.Generator) -> Floats:
    return rng.uniform(45, 65) * _unit_circle()


def _ellipse(rng: np.random.Generator) -> Floats:
    return _unit_circle() * [rng.uniform(60, 80), rng.uniform(35, 50)]


def _unit_circle() -> Floats:
    angle = 2.0 * np.pi * np.arange(24) / 24
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _l_shape(rng: np.random.Generator) -> Floats:
    (a, b), (c, d) = rng.uniform(50, 70, 2), rng.uniform(45, 65, 2)
    return np.array([[-a, -b], [a, -b], [a, d - b], [c - a, d - b], [c - a, b], [-a, b]])


def _t_shape(rng: np.random.Generator) -> Floats:
    a, bar, stem = rng.uniform(55, 75), rng.uniform(40, 50), rng.uniform(22, 30)
    low, high = -rng.uniform(45, 65), 45.0
    return np.array(
        [[-stem, low], [stem, low], [stem, high - bar], [a, high - bar], [a, high], [-a, high], [-a, high - bar],
         [-stem, high - bar]]
    )  # fmt: skip


def _trapezoid(rng: np.random.Generator) -> Floats:
    base, top, height = rng.uniform(60, 80), rng.uniform(30, 55), rng.uniform(40, 55)
    return np.array([[-base, -height], [base, -height], [top, height], [-top, height]])


_OUTLINES = (_circle, _l_shape, _t_shape, _ellipse, _trapezoid)


def _drawn_supports(rng: np.random.Generator, outline: Floats, kind: int) -> dict[str, Any]:
    """Three needles, four to six, lifted ones, two edges moved together, or one edge under weight."""
    scale, corners = round(float(rng.uniform(0.65, 0.9)), 2), len(outline)
    needles = 3 if kind == 0 else min(int(rng.integers(4, 7)), corners)
    chosen = np.unique(np.rint(np.linspace(0, corners, needles, endpoint=False) + rng.uniform(0, 1)).astype(int))
    numbers = (chosen % corners).tolist()
    if kind < 2:
        return {"pins": [{"corners": numbers, "scale": scale}]}
    if kind == 2:
        lifted = {"corners": numbers[1::2], "scale": scale, "offset_mm": [0.0, 0.0, float(rng.integers(8, 30))]}
        return {"pins": [{"corners": numbers[::2], "scale": scale}, lifted]}
    if kind == 3:
        edges = [{"edges": list(range(first, first + corners // 4))} for first in (0, corners // 2)]
        return {"pins": [edge | {"scale": scale} for edge in edges]}
    weight = {"gravity": {"on": True}, "fabric": {"modulus_mpa": 7.1875}}
    return {"pins": [{"edges": list(range(corners // 4)), "scale": scale}]} | weight


if __name__ == "__main__":
    sys.exit(main())
