"""How well strips tell a material: many made-up tables of the paper's strips, with errors, and what the fit says.

python -m benchmarks.strips
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.measure.strips.errors import UndeterminedMaterialError
from asterism.measure.strips.strip_fit import fit_readings
from asterism.measure.strips.synthetic import synthetic_readings
from asterism.pattern.design.materials import Plastic
from benchmarks.report import markdown, write_report

TABLES = 200
RATIO, KAPPA_BAR = 3200.0, 0.003
CASES: list[dict[str, Any]] = [
    {},
    {"reading_mm": 0.1},
    {"reading_mm": 0.05, "scatter": 0.05},
    {"reading_mm": 0.5, "scatter": 0.0},
    {"reading_mm": 0.5, "flat_mm": 0.5, "count": 5},
    {"count": 4},
    {"count": 2},
    {"reading_mm": 0.05, "step_mm": 0.5},
    {"reading_mm": 0.3, "step_mm": 1.0},
    {"reading_mm": 0.1, "step_mm": 0.1, "count": 4},
    {"off_mm": 0.003},
    {"off_mm": 0.01},
    {"off_mm": 0.01, "reading_mm": 0.1, "scatter": 0.02, "count": 4},
    {"off_mm": 0.005, "reading_mm": 0.1, "scatter": 0.02},
    {"off_mm": 0.01, "reading_mm": 0.02, "scatter": 0.003},
]
HEADER = [
    "strips",
    "reading mm",
    "ruler mm",
    "scatter %",
    "thickness off mm",
    "inside %",
    "kappa_bar inside %",
    "half width %",
    "named wrongly",
    "refused",
    "flat",
]


def main() -> None:
    """Fit all tables and write the report."""
    rows = []
    for case in CASES:
        values = {"count": 10, "reading_mm": 0.3, "scatter": 0.03, "flat_mm": 0.0, "step_mm": 0.0, "off_mm": 0.0} | case
        inside, kept, half, named, flat = [], [], [], [], []
        for seed in range(TABLES):
            strips = synthetic_readings(seed, Plastic(modulus_ratio=RATIO, kappa_bar_per_mm=KAPPA_BAR), **values)
            flat.append(np.mean([r.curvature_per_mm is None for r in strips]))
            try:
                fit = fit_readings(strips, flat_height_mm=values["flat_mm"] or 0.5)
            except UndeterminedMaterialError:
                continue
            ratio, kappa_bar = fit.ratio["paper"], fit.kappa_bar[None]
            inside.append(ratio.low <= RATIO <= ratio.high)
            kept.append(kappa_bar.low <= KAPPA_BAR <= kappa_bar.high)
            half.append((ratio.high - ratio.low) / 2 / RATIO)
            named.append(len(fit.left_out))
        rows.append(
            {
                **values,
                "tables": TABLES,
                "refused": TABLES - len(inside),
                "inside_percent": 100 * float(np.mean(inside)),
                "kappa_bar_inside_percent": 100 * float(np.mean(kept)),
                "half_width_percent": 100 * float(np.median(half)),
                "good_readings_left_out_per_table": float(np.mean(named)),
                "flat_percent": 100 * float(np.mean(flat)),
            }
        )
        print(rows[-1], flush=True)
    cells = [
        [
            f"4 x {row['count']}",
            f"{row['reading_mm']:g}",
            f"{row['step_mm']:g}" if row["step_mm"] else "-",
            f"{100 * row['scatter']:g}",
            f"{row['off_mm']:g}" if row["off_mm"] else "-",
            f"{row['inside_percent']:.1f}",
            f"{row['kappa_bar_inside_percent']:.1f}",
            f"{row['half_width_percent']:.1f}",
            f"{row['good_readings_left_out_per_table']:.3f}",
            str(row["refused"]),
            f"{row['flat_percent']:.0f} %",
        ]
        for row in rows
    ]
    write_report("strips", rows, markdown(HEADER, cells))


if __name__ == "__main__":
    main()
