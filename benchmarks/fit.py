"""How near fitted designs come to target surfaces: first guess, fit and exact shape, and the time that each takes.

python -m benchmarks.fit FOLDER [--no-exact] [NAME ...]

Each target is a row, kept in FOLDER as soon as it is done; a further run goes on from there. Distances are rms over the
printed area in % of the diameter of the target. The preview is a fresh one of the design as written, rounded to layers.
The exact shape has triangles of 1.15 mm.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

from asterism.fitting.errors import ReachError
from asterism.fitting.fit import fit
from asterism.print.profiles import load_printer
from benchmarks.fit_targets import TARGETS
from benchmarks.report import markdown, write_report

HEADER = [
    "target",
    "stars, needles, stretch",
    "ratio needed, available",
    "first guess",
    "preview",
    "loss by rounding",
    "exact, mean over a cell",
    "with bumps",
    "largest",
    "minimum",
    "restarts",
    "CPU s",
]
SHARES = (0.4, 0.8, 1.0)


def row(name: str, exact: bool) -> dict[str, Any]:
    """Fit one target."""
    make, needles = TARGETS[name]
    begun = time.process_time()
    try:
        fitted = fit(make(), needles=needles, printer=load_printer("ultimaker2"), exact=exact)
    except ReachError as error:
        return {"refused": str(error), "cpu_s": time.process_time() - begun}
    summary = fitted.summary.to_json()
    return {key: value for key, value in summary.items() if key not in ("design", "motion", "shift_mm")} | {
        "cpu_s": time.process_time() - begun
    }


def cells(name: str, data: dict[str, Any]) -> list[str]:
    """One line of the table."""
    if "refused" in data:
        return [name, "refused", *[""] * (len(HEADER) - 3), f"{data['cpu_s']:.0f}"]
    exact, preview = data["exact"], data["preview"]
    return [
        name,
        f"{data['stars']}, {data['needles']}, {data['stretch']:g}",
        f"{data['needed_ratio']:.3f}, {data['available_ratio']:.3f}",
        f"{data['first_guess']['mean_percent']:.2f}",
        f"{preview['mean_percent']:.2f}",
        "-" if data["rounding_loss_percent"] is None else f"{data['rounding_loss_percent']:.3f}",
        *([f"{exact[key]:.2f}" for key in ("mean_percent", "surface_percent")] if exact else ["", ""]),
        f"{exact['largest_percent']:.1f}" if exact else "",
        ("yes" if exact["is_minimum"] else "no") if exact else "",
        str(data["restarts"]),
        f"{data['cpu_s']:.0f}",
    ]


def write(rows: dict[str, dict[str, Any]]) -> None:
    """Write the report of all finished rows."""
    made = {name: data for name, data in rows.items() if "refused" not in data}
    lines = [markdown(HEADER, [cells(name, rows[name]) for name in TARGETS if name in rows])]
    for model, label in (("preview", "fresh preview"), ("exact", "exact shape")):
        values = np.array([data[model]["mean_percent"] for data in made.values() if data[model]])
        if len(values):
            within = ", ".join(f"{int((values <= share).sum())} within {share:g} %" for share in SHARES)
            median = float(np.median(values))
            lines.append(f"{label.capitalize()} of {len(values)} targets: median {median:.2f} %, {within}.")
    lines += [f"Refused: {data['refused']}." for data in rows.values() if "refused" in data]
    lines += [f"{name}: {line}." for name, data in made.items() for line in data["warnings"]]
    write_report("fit", [{"row": name, **data} for name, data in rows.items()], "\n\n".join(lines))


def main() -> None:
    """Fit the targets that are not done, and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--no-exact", action="store_true")
    parser.add_argument("names", nargs="*", metavar="NAME")
    given = parser.parse_intermixed_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    for name in given.names or TARGETS:
        file = given.folder / f"{name.replace(' ', '-')}.json"
        if not file.exists():
            file.write_text(json.dumps(row(name, not given.no_exact), indent=1))
        print(name, "done", flush=True)
    done = {name: given.folder / f"{name.replace(' ', '-')}.json" for name in TARGETS}
    write({name: json.loads(file.read_text()) for name, file in done.items() if file.exists()})


if __name__ == "__main__":
    main()
