"""The law that comes with the package: time to evaluate it for a whole sheet, and its errors.

python -m benchmarks.law
"""

from __future__ import annotations

import time

import numpy as np

from benchmarks.report import markdown, write_report
from homogenize.law import NAMES
from homogenize.law_file import load_law

STARS, TIMES = 200, 500


def main() -> None:
    law = load_law()
    rng = np.random.default_rng(0)
    rows = []
    for table in law.tables:
        sizes = (rng.uniform(4, 7, STARS), rng.uniform(0.3, 0.5, STARS), rng.uniform(0.8, 1.6, STARS))
        table(*sizes)
        seconds = []
        for _ in range(TIMES):
            start = time.perf_counter()
            table(*sizes)
            seconds.append(time.perf_counter() - start)
        held = law.residuals[f"{table.stretch:g}"]["held_out"]
        errors = {name: held["errors"][name]["rms_percent"] for name in NAMES}
        row = {"stretch": table.stretch, "median_ms": 1e3 * float(np.median(seconds)), "rms_percent": errors}
        rows.append({**row, "cell_s": law.made["cell_seconds"] / len(law.samples), "solved": float(table.good.mean())})
    header = ["stretch", f"ms for {STARS} stars", "cells with an answer", "s a cell", *(f"{n} rms %" for n in NAMES)]
    body = [
        [f"{r['stretch']:g}", f"{r['median_ms']:.2f}", f"{100 * r['solved']:.0f} %", f"{r['cell_s']:.1f}"]
        + [f"{r['rms_percent'][n]:.2f}" for n in NAMES]
        for r in rows
    ]
    table_text = markdown(header, body)
    write_report("law", rows, table_text)
    print(table_text)


if __name__ == "__main__":
    main()
