"""Previews of stars that are not the same in all directions, each with the law of its own stars.

python -m benchmarks.other_stars FOLDER [--choose]

Four, five and six arms on square lattices, four and five on triangular ones, three on a square one: free, held along
the border, or on their corners; the same designs every time. FOLDER keeps laws and exact shapes. Of these the lowest
counts, from the release, or from the preview with or without what differs between directions. Each preview is
made thrice: with no part of that, with the part in use (`anisotropy_share` of the preview's model), and with all of
it.

SHARE is not from these. --choose previews the free ones of as many designs that come after them with more parts, and
prints the geometric means of the distances.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.errors import CampaignError
from asterism.homogenize.law.law import Law
from asterism.laws.calibrate import calibrate
from asterism.laws.design_law import material_for_design
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.run import preview
from asterism.shape.comparison import compare_shapes
from benchmarks.accuracy.exact import exact
from benchmarks.accuracy.report import FAR
from benchmarks.report import markdown, write_report

SHARE = PREVIEW_MODEL.anisotropy_share
COUNT = 36
EDGE_MM = 1.15
# kind of lattice, arms, turn in degrees
STARS = [
    ("square", 4, 0), ("square", 4, 45), ("triangular", 4, 0), ("square", 3, 0), ("triangular", 5, 0),
    ("square", 5, 10), ("square", 6, 0), ("square", 4, 20), ("triangular", 4, 30),
]  # fmt: skip
HELD = ["free", "border", "corners", "free"]
SHARES, CHOICE = [0.0, SHARE, 1.0], [0.0, 0.5, 0.6, 0.7, 0.8, 1.0]
HEADER = ["design", "lattice, arms, turned by", "held", "stars", *(f"rms %, {share:g} of it" for share in SHARES)]
# of the part in use
HEADER += ["expected %", "height %", "expected height %", "warned of"]
WARNINGS = {
    "pleat": "pleats",
    "another form,": "another form",
    "curl to a radius": "tight stars",
}


def other_stars(number: int) -> Design:
    """A design by its number."""
    rng = np.random.default_rng([77, number])
    kind, arms, turn = STARS[number % len(STARS)]
    held = _held(number)
    while True:
        r = DEFAULT_SPACING_MM * rng.uniform(2.2, 3.2)
        length = DEFAULT_SPACING_MM * rng.uniform(0.33, 0.5)
        field = {"profile": "radial", "from": length, "to": length * rng.uniform(0.6, 1.0), "over_mm": r}
        hexagon = [[-r, -0.6 * r], [0, -r], [r, -0.6 * r], [r, 0.6 * r], [0, r], [-r, 0.6 * r]]
        outline = {"polygon_mm": hexagon} if rng.random() < 0.5 else {"rectangle_mm": [2 * r, r * rng.uniform(1.4, 2)]}
        scale = round(float(rng.uniform(*((0.68, 0.74) if held == "border" else (0.6, 0.72)))), 3)
        data = {
            "name": f"other-{number:02d}",
            "stars": {
                "length_mm": field if rng.random() < 0.5 else length,
                "thickness_mm": round(float(rng.uniform(0.28, 0.5)), 3),
            },
            "lattice": {"kind": kind, "arms": arms, "orientation_deg": turn},
            "border": outline,
            "pins": [] if held == "free" else [{"where": held, "scale": scale}],
            "mesh": {"edge_mm": EDGE_MM},
        }
        try:
            design = Design.from_dict(data)
            layout(design)
            return design
        except DesignError:
            continue


def row(number: int, folder: Path, shares: Sequence[float] = SHARES) -> dict[str, Any]:
    """How far the previews of a design, with each of the shares, are from its lowest exact shape."""
    design = other_stars(number)
    law = calibrate(material_for_design(design, EDGE_MM), folder / "laws" / f"{design.name}.npz", jobs=2)
    plan = layout(design)
    shown = [_preview(design, law, share) for share in shares]
    starts = {"": None, "-plain": shown[0], "-directed": shown[1]}
    shapes = [
        exact(design, folder / f"exact{name}", None if start is None else lambda start=start: start)
        for name, start in starts.items()
    ]
    right = min(shapes, key=lambda shape: shape.summary["energy_n_mm"])
    same = symmetries(design, plan)
    compared = [compare_shapes(right, each, plan, same, design.gravity.pull) for each in shown]
    used = shares.index(SHARE)
    height, other = compared[used].heights_mm
    return {
        "design": design.name,
        "lattice": design.lattice.kind,
        "arms": design.lattice.arms,
        "orientation_deg": design.lattice.orientation_deg,
        "held": _held(number),
        "stars": len(plan.centres),
        "rms_percent": [each.rms_percent for each in compared],
        "height_error_percent": 100.0 * (other / height - 1.0),
        **{key: shown[used].summary[key] for key in ("expected_rms_percent", "expected_height_percent", "warnings")},
        "shares": list(shares),
    }


def _held(number: int) -> str:
    return HELD[number // len(STARS) % len(HELD)]


def _preview(design: Design, law: Law, share: float) -> Any:
    return preview(design, law, model=replace(PREVIEW_MODEL, anisotropy_share=share))


def table(rows: list[dict[str, Any]]) -> str:
    """Each design, how far half of the previews are off, nine in ten and all, and how many are within 2.5 %."""
    rms = np.array([row["rms_percent"] for row in rows])
    lines = [
        [
            row["design"], f"{row['lattice']}, {row['arms']}, {row['orientation_deg']:g} deg", row["held"],
            str(row["stars"]), *(f"{value:.2f}" for value in row["rms_percent"]), *_expected(row),
        ]
        for row in rows
    ]  # fmt: skip
    ends = {
        name: np.quantile(rms, part, axis=0) for name, part in (("median", 0.5), ("nine in ten", 0.9), ("largest", 1.0))
    }
    cells_of = {name: [f"{value:.2f}" for value in values] for name, values in ends.items()}
    cells_of["within 2.5 %"] = [f"{count} of {len(rows)}" for count in (rms <= FAR).sum(axis=0)]
    before, after = HEADER.index("stars") * [""], len(_expected(rows[0])) * [""]
    return markdown(HEADER, [*lines, *([name, *before, *cells, *after] for name, cells in cells_of.items())])


def _expected(row: dict[str, Any]) -> list[str]:
    """What a preview expects of itself, how far off its height is, and what it warns of."""
    rms, height = (row[key] for key in ("expected_rms_percent", "expected_height_percent"))
    warned = {name for words, name in WARNINGS.items() if any(words in line for line in row["warnings"])}
    return [
        "-" if rms is None else f"{rms:.2f}",
        f"{row['height_error_percent']:+.1f}",
        "-" if height is None else f"{height:.1f}",
        ", ".join(sorted(warned)) or "-",
    ]


def told(rows: Sequence[dict[str, Any]]) -> str:
    """How many of those that miss were announced, and how good expectations are."""
    used = SHARES.index(SHARE)
    far = [row for row in rows if row["rms_percent"][used] > FAR]
    announced = [row for row in far if (row["expected_rms_percent"] or 0.0) > FAR or _expected(row)[-1] != "-"]
    known = [row for row in rows if row["expected_rms_percent"] is not None]
    ratio = [row["rms_percent"][used] / row["expected_rms_percent"] for row in known]
    middle, most = np.quantile(ratio, [0.5, 1.0])
    return (
        f"Further off than {FAR} %: {len(far)}, of which {len(announced)} were announced. {len(known)} of {len(rows)} "
        f"expect a distance: what was found over that is {middle:.2f} in the median, {most:.2f} at most."
    )


def rows(numbers: Iterable[int], folder: Path, shares: Sequence[float]) -> tuple[list[dict[str, Any]], list[str]]:
    """Those that have a law, and why others have none."""
    found, without = [], []
    for number in numbers:
        try:
            found.append(row(number, folder, shares))
            print(found[-1], flush=True)
        except CampaignError as error:
            without.append(f"- `{other_stars(number).name}`: {error}")
            print(without[-1], flush=True)
    return found, without


def choose(folder: Path) -> None:
    """Print what each of `CHOICE` makes of other designs."""
    found, _ = rows((n for n in range(COUNT, 2 * COUNT) if _held(n) == "free"), folder, CHOICE)
    means = np.exp(np.log([row["rms_percent"] for row in found]).mean(axis=0))
    print("  ".join(f"{share:g}: {mean:.2f} %" for share, mean in zip(CHOICE, means, strict=True)))


def main(words: list[str]) -> None:
    """All designs, into `results`."""
    folder = Path(words[0])
    (folder / "laws").mkdir(parents=True, exist_ok=True)
    if "--choose" in words:
        choose(folder)
        return
    found, without = rows(range(COUNT), folder, SHARES)
    left = "\n\nWithout a law:\n\n" + "\n".join(without) if without else ""
    write_report("other_stars", found, f"{table(found)}\n\n{told(found)}{left}")


if __name__ == "__main__":
    main(sys.argv[1:])
