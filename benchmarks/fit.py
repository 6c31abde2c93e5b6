"""How near fitted designs come to target surfaces: first guess, fit and exact shape, and the time that each takes.

python -m benchmarks.fit FOLDER [--no-exact] [--first-guess] [NAME ...]

Each target is a row, kept in FOLDER as soon as it is done; a further run goes on from there. Distances are rms over the
printed area in % of the diameter of the target. Previews are fresh ones: of the fit by the preview alone, and of the
design as written, corrected by the exact model and rounded to layers. If the flat print and the corrections lead to two
exact minima, the one of lower energy counts, and the table has the distance of the other one. The exact shape has
triangles of 1.15 mm; that of the first guess is computed with --first-guess only, for finished rows too. A target that
is refused is fitted again with `nearest`, by the preview. The names with `own shape` stand for the inverse crime. The
fits of the gallery are kept in FOLDER/gallery.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

from asterism.exact.simulation import exact_shape
from asterism.fitting.distance import target_distance
from asterism.fitting.errors import ReachError
from asterism.fitting.first_guess import guess_design
from asterism.fitting.fit import fit
from asterism.fitting.residual import FitPlaces
from asterism.pattern.layout.build import layout
from asterism.previews.default_law import paper_law
from asterism.previews.run import preview
from asterism.print.profiles import load_printer
from benchmarks.chosen_names import chosen_names
from benchmarks.fit_gallery import SHOWN, keep
from benchmarks.fit_own_shape import own_shape
from benchmarks.fit_targets import TARGETS
from benchmarks.report import markdown, write_report

HEADER = [
    "target",
    "stars, held by, stretch",
    "ratio needed, available",
    "first guess",
    "its exact shape",
    "fit by preview",
    "preview as written",
    "exact before corrections",
    "exact, unrounded",
    "exact, as written",
    "with bumps",
    "largest",
    "other minimum",
    "certified",
    "CPU s, clock s",
]
SHARES = (0.4, 0.8, 1.0)
# name: whether the border is held
OWN_SHAPES = {"own shape, needles": False, "own shape, held border": True}


def row(name: str, exact: bool, gallery: Path) -> dict[str, Any]:
    """Fit one target; those of the gallery are kept in its folder."""
    make, needles = TARGETS[name]
    target, printer, begun, clock = make(), load_printer("ultimaker2"), time.process_time(), time.perf_counter()
    refused = None
    try:
        fitted = fit(target, needles=needles, printer=printer, exact=exact)
    except ReachError as error:
        refused = str(error)
        fitted = fit(target, needles=needles, printer=printer, exact=False, nearest=True)
    data: dict[str, Any] = {"cpu_s": time.process_time() - begun, "clock_s": time.perf_counter() - clock}
    if exact and name in SHOWN:
        keep(name, fitted, gallery / name.replace(" ", "-"))
    if refused is not None:
        data["refused"] = refused
    summary = fitted.summary.to_json()
    return data | {key: value for key, value in summary.items() if key not in ("design", "motion", "shift_mm")}


def exact_first_guess(name: str) -> dict[str, Any]:
    """Distance of the exact shape of the first guess of a target, started from its preview."""
    make, needles = TARGETS[name]
    guess = guess_design(make(), paper_law(), needles=needles)
    plan = layout(guess.design)
    shape = exact_shape(guess.design, near=preview(guess.design))
    places = FitPlaces.of(guess.target_map, plan.outline, plan.lattice_vectors)
    distance = target_distance(shape, guess.target, places, plan.lattice_vectors)
    return {"mean_percent": distance.mean_percent, "is_minimum": bool(shape.summary["is_minimum"])}


def cells(name: str, data: dict[str, Any]) -> list[str]:
    """One line of the table."""
    exact, corrections = data["exact"], data["corrections"]
    guess = data.get("first_guess_exact")
    held = "border" if data["held_border"] else f"{data['needles']} needles"
    unrounded = exact["mean_percent"] - data["rounding_loss_percent"] if exact else None
    other = data.get("other_exact")
    return [
        name + (", nearest" if "refused" in data else ""),
        f"{data['stars']}, {held}, {data['stretch']:g}",
        f"{data['needed_ratio']:.3f}, {data['available_ratio']:.3f}",
        f"{data['first_guess']['mean_percent']:.2f}",
        f"{guess['mean_percent']:.2f}" if guess else "",
        f"{data['unrounded']['mean_percent']:.2f}",
        f"{data['preview']['mean_percent']:.2f}",
        f"{corrections[0]['mean_percent']:.2f}" if corrections else "",
        "" if unrounded is None else f"{unrounded:.2f}",
        *([f"{exact[key]:.2f}" for key in ("mean_percent", "surface_percent")] if exact else ["", ""]),
        f"{exact['largest_percent']:.1f}" if exact else "",
        f"{other['mean_percent']:.2f}" if other else "",
        ("yes" if exact["is_minimum"] else "no") if exact else "",
        f"{data['cpu_s']:.0f}, {data['clock_s']:.0f}",
    ]


def write(rows: dict[str, dict[str, Any]]) -> None:
    """Write the report of all finished rows."""
    fits = {name: data for name, data in rows.items() if name not in OWN_SHAPES}
    made = {name: data for name, data in fits.items() if "refused" not in data}
    lines = [markdown(HEADER, [cells(name, fits[name]) for name in TARGETS if name in fits])]
    for key, label in (("unrounded", "fresh preview of the fit by the preview"), ("exact", "exact shape")):
        values = np.array([data[key]["mean_percent"] for data in made.values() if data[key]])
        if len(values):
            within = ", ".join(f"{int((values <= share).sum())} within {share:g} %" for share in SHARES)
            median = float(np.median(values))
            lines.append(f"{label.capitalize()} of {len(values)} targets: median {median:.2f} %, {within}.")
    for held, label in ((True, "held borders"), (False, "needles, and free sheets")):
        farthest = [
            data["exact"]["largest_percent"] for data in made.values() if data["exact"] and data["held_border"] == held
        ]
        if farthest:
            lines.append(f"Largest exact distance with {label}: {max(farthest):.1f} %.")
    apart = [name for name, data in made.items() if data.get("other_exact")]
    if apart:
        lines.append(f"Two exact minima: {', '.join(apart)}.")
    lines += [
        f"Inverse crime, {name}, with the outline given: equal stars {own['first_rms_percent']:.2f} %, preview "
        f"{own['preview_rms_percent']:.3f} %, exact {own['exact_mean_percent']:.2f} %, largest "
        f"{own['exact_largest_percent']:.1f} %."
        for name, own in rows.items()
        if name in OWN_SHAPES
    ]
    lines += [f"Refused: {data['refused']}." for data in fits.values() if "refused" in data]
    lines += [f"{name}: {line}." for name, data in made.items() for line in data["warnings"]]
    missing = [name for name in (*TARGETS, *OWN_SHAPES) if name not in rows]
    if missing:
        lines.append(f"Not computed by this version: {', '.join(missing)}.")
    write_report("fit", [{"row": name, **data} for name, data in rows.items()], "\n\n".join(lines))


def main() -> None:
    """Fit the targets that are not done, and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--no-exact", action="store_true")
    parser.add_argument("--first-guess", action="store_true")
    parser.add_argument("names", nargs="*", metavar="NAME")
    given = parser.parse_intermixed_args()
    names = [*TARGETS, *OWN_SHAPES]
    chosen = chosen_names(parser, given.names, names)
    given.folder.mkdir(parents=True, exist_ok=True)
    for name in chosen:
        file = given.folder / f"{name.replace(' ', '-')}.json"
        if not file.exists():
            data = (
                own_shape(OWN_SHAPES[name])
                if name in OWN_SHAPES
                else row(name, not given.no_exact, given.folder / "gallery")
            )
            file.write_text(json.dumps(data, indent=1))
        data = json.loads(file.read_text())
        if given.first_guess and name in TARGETS and not {"refused", "first_guess_exact"} & set(data):
            file.write_text(json.dumps(data | {"first_guess_exact": exact_first_guess(name)}, indent=1))
        print(name, "done", flush=True)
    done = {name: given.folder / f"{name.replace(' ', '-')}.json" for name in names}
    write({name: json.loads(file.read_text()) for name, file in done.items() if file.exists()})


if __name__ == "__main__":
    main()
