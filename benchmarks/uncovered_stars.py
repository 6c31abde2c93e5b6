"""Previews by a universal law that ends within a sheet: how much stars outside of the law move it.

    python -m benchmarks.uncovered_stars

The materials are those of `benchmarks.universal_materials`, the arms twice as long at one end of the sheet as at the
other, or in its middle as at its rim. The law is cut below the longest or above the shortest arms, so that a share of
the stars lies outside. Distances to the preview by the whole law are between star centres after rigid alignment, rms,
in % of the width.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.law.law import Law
from asterism.homogenize.universal.groups import GROUP_KEYS, star_groups
from asterism.homogenize.universal.material_law import law_edge, material_law, table_nodes
from asterism.homogenize.universal.universal_law import UniversalLaw
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.rigid_fit import rms_distance
from asterism.previews.run import preview
from asterism.previews.universal_choice import packaged_universal_law, sizes_of_stars, universal_choice
from benchmarks.report import markdown, write_report
from benchmarks.universal_materials import MATERIALS, SEED, drawn_sheet

RINGS = 3
# longest and shortest arms over those of the drawn sheet
LONGEST, SHORTEST = 4.0 / 3.0, 2.0 / 3.0
SHARES = (0.05, 0.1, 0.2, 0.3, 0.5)
CLASSES = ((0.0, 0.1), (0.0, 0.15), (0.0, 0.2), (0.0, 0.25), (0.25, 0.5))
PERCENTILES = (50, 90, 100)


@dataclass(frozen=True)
class CutLaw(UniversalLaw):
    """A universal law for arms in a part of its range; lengths over the spacing."""

    arms: tuple[float, float] = (0.0, 1.0)

    def covers(self, groups: Floats) -> Bools:
        arm = groups[:, GROUP_KEYS.index("arm")]
        return np.asarray(super().covers(groups) & (arm >= self.arms[0]) & (arm <= self.arms[1]))


def main() -> None:
    rng = np.random.default_rng(SEED)
    rows = [row for _ in range(MATERIALS) for sheet in graded(drawn_sheet(rng)) for row in rows_of(sheet)]
    lines = []
    for low, high in CLASSES:
        distances = [row["distance_percent"] for row in rows if low < row["share"] <= high]
        numbers = np.percentile(distances, PERCENTILES)
        lines.append([f"{100 * low:g} to {100 * high:g}", str(len(distances)), *(f"{x:.2f}" for x in numbers)])
    text = markdown(["stars outside, %", "previews", "distance, median %", "nine in ten, %", "largest, %"], lines)
    write_report("uncovered_stars", rows, text)
    print(text)


def graded(sheet: Design) -> list[Design]:
    """The sheet with arms that vary along it, and from its middle to its rim."""
    data, spacing = sheet.to_dict(), sheet.lattice.spacing_mm
    length = data["stars"]["length_mm"]
    ends = {"from": LONGEST * length, "to": SHORTEST * length}
    half = RINGS * spacing
    profiles = (
        {"profile": "linear", "start_mm": [-half, 0.0], "end_mm": [half, 0.0]} | ends,
        {"profile": "radial", "over_mm": half} | ends,
    )
    return [
        Design.from_dict(data | {"stars": data["stars"] | {"length_mm": profile}, "border": {"rings": RINGS}})
        for profile in profiles
    ]


def rows_of(sheet: Design) -> list[dict[str, Any]]:
    """The previews by cut laws; none where the whole law does not serve all stars."""
    law, sizes = packaged_universal_law(), sizes_of_stars(sheet)
    whole = universal_choice(sheet, sizes).law
    if law is None or whole is None:
        return []
    edge, spacing = law_edge(sheet), sheet.lattice.spacing_mm
    groups = star_groups(sheet.fabric, sheet.plastic, spacing, edge, sizes)
    if not law.covers(groups).all():
        return []
    arm = groups[:, GROUP_KEYS.index("arm")]
    expected = star_centres(sheet, whole)
    width = float(np.ptp(expected, axis=0).max())
    rows = []
    for share in SHARES:
        ends = {"long": (0.0, np.quantile(arm, 1.0 - share)), "short": (np.quantile(arm, share), 1.0)}
        for outside, (least, most) in ends.items():
            cut = CutLaw(law.cells, law.parts, law.left_out, law.spread_count, law.made, (float(least), float(most)))
            given = star_centres(sheet, material_law(cut, sheet, table_nodes(spacing), edge))
            rows.append(
                {
                    "stretch": sheet.fabric.stretch_xy[0],
                    "outside": outside,
                    "share": float((~cut.covers(groups)).mean()),
                    "distance_percent": 100.0 * rms_distance(expected, given) / width,
                }
            )
    return rows


def star_centres(sheet: Design, law: Law) -> Floats:
    """(S, 3) mm, in the preview by a law."""
    shape = preview(sheet, law)
    return shape.positions[shape.star_vertices]


if __name__ == "__main__":
    main()
