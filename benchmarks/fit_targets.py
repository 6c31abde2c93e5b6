"""How near fitted designs come to fifteen target surfaces of 100 to 150 mm, and pictures of six of them.

python -m benchmarks.fit_targets FOLDER [NAME ...] [--no-exact]

FOLDER keeps each fit as soon as it is done; a further run goes on from there. Distances are rms over the print in % of
the diameter of the target. Previews are fresh ones: of the fit by the preview alone, and of the design as written,
corrected by the exact model and rounded to layers. If the flat print and the corrections lead to two exact minima, the
one of lower energy counts. A target that is refused is fitted again with `nearest`, by the preview.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Sequence
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from scipy.spatial import Delaunay

from asterism.equilibrium.arrays import Floats, Ints
from asterism.exact.simulation import exact_shape
from asterism.fitting.first_guess import guess_design
from asterism.fitting.fit import Fit, fit
from asterism.fitting.reach import ReachError
from asterism.fitting.residual import FitPlaces, Residual, target_distance
from asterism.fitting.target import TargetSurface
from asterism.pattern.layout.build import layout
from asterism.previews.law_choice import paper_law
from asterism.previews.session import preview
from asterism.print.printer import load_printer
from asterism.process.settings import FitSettings
from asterism.reports.fit_page import fit_views, signed_distance_map
from asterism.reports.html import png
from benchmarks.report import PICTURES, chosen, markdown, number, write_report

SHOWN = ("ellipsoid dome", "two bumps", "three-legged shell", "hypar", "monkey saddle", "barrel")
# pixels, width of a picture of a fit, and height of one of its parts
PICTURE_WIDTH, PART_HEIGHT = 1400, 300
HEADER = [
    "target", "diameter mm", "stars, held by, stretch", "ratio needed, available", "first guess", "its exact shape",
    "fit by preview", "preview as written", "exact before corrections", "exact, unrounded", "exact, as written",
    "largest", "other minimum", "certified", "CPU s",
]  # fmt: skip


def round_mesh(rings: int = 24) -> tuple[Floats, Ints]:
    """(V, 2) points of the unit disk in rings, and triangles."""
    points = [np.zeros((1, 2))]
    for ring in range(1, rings + 1):
        angle = np.arange(6 * ring) * (2.0 * np.pi / (6 * ring))
        points.append(ring / rings * np.column_stack([np.cos(angle), np.sin(angle)]))
    plane = np.concatenate(points)
    return plane, Delaunay(plane).simplices.astype(np.int64)


def rectangle_mesh(width: float, depth: float, columns: int = 50, rows: int = 40) -> tuple[Floats, Ints]:
    """(V, 2) points of a rectangle around the origin, and triangles."""
    x, y = np.linspace(-0.5, 0.5, columns) * width, np.linspace(-0.5, 0.5, rows) * depth
    plane = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return plane, Delaunay(plane).simplices.astype(np.int64)


Mesh = tuple[Floats, Ints]


def surface(name: str, mesh: Mesh, place: Callable[[Floats, Floats], Sequence[Floats]]) -> TargetSurface:
    """The points of a flat mesh where `place` takes their coordinates."""
    plane, triangles = mesh
    return TargetSurface.of_triangles(np.column_stack(place(*plane.T)), triangles, name)


def cap_mesh(half_angle_deg: float, width_mm: float = 100.0, rings: int = 24) -> tuple[Floats, Ints]:
    """(V, 3) points of a cap of a sphere, of that width up to its equator, and triangles."""
    plane, triangles = round_mesh(rings)
    half = np.deg2rad(half_angle_deg)
    radius = 0.5 * width_mm / np.sin(min(half, 0.5 * np.pi))
    angle, around = half * np.linalg.norm(plane, axis=1), np.arctan2(plane[:, 1], plane[:, 0])
    places = [np.sin(angle) * np.cos(around), np.sin(angle) * np.sin(around), np.cos(angle)]
    return radius * np.column_stack(places), triangles


def cap(half_angle_deg: float, name: str) -> TargetSurface:
    """A cap of a sphere, 100 mm wide."""
    return TargetSurface.of_triangles(*cap_mesh(half_angle_deg), name)


def graph(height: Callable[[Floats, Floats], Floats], width: float, depth: float, name: str) -> TargetSurface:
    """Heights over an ellipse with these diameters."""
    plane, triangles = round_mesh()
    scaled = 0.5 * np.array([width, depth]) * plane
    return surface(name, (scaled, triangles), lambda x, y: [x, y, height(x, y)])


def _barrel(angle: Floats, along: Floats) -> Sequence[Floats]:
    """A part of a cylinder of radius 55 mm."""
    return [55.0 * np.sin(angle), along, 55.0 * np.cos(angle)]


def _torus_part(around: Floats, across: Floats) -> Sequence[Floats]:
    """The upper part of a torus: Gauss curvature of both signs."""
    radius = 100.0 + 35.0 * np.sin(across)
    return [radius * np.sin(around), radius * np.cos(around), 35.0 * np.cos(across)]


def _three_legged_shell(u: Floats, v: Floats) -> Sequence[Floats]:
    """A vault on three legs: the border rises between them."""
    radius, around = np.hypot(u, v), np.arctan2(v, u)
    reach = 52.0 * (1.0 + 0.12 * np.cos(3.0 * around)) * radius
    heights = 20.0 - 0.0075 * reach**2 - 3.0 * radius**3 * np.cos(3.0 * around)
    return [reach * np.cos(around), reach * np.sin(around), heights]


def _bump(x: Floats, y: Floats, at: tuple[float, float], width: float) -> Floats:
    return np.exp(-((x - at[0]) ** 2 + (y - at[1]) ** 2) / width**2)


def _two_bumps(x: Floats, y: Floats) -> Floats:
    return 11.0 * _bump(x, y, (-18.0, 0.0), 22.0) + 7.0 * _bump(x, y, (22.0, 6.0), 20.0)


def _face_mask(u: Floats, v: Floats) -> Sequence[Floats]:
    """An oval mask, 112 by 150 mm, with nose, brows, cheeks and chin; its rim bends back."""
    x, y = 56.0 * u, 75.0 * v
    heights = 44.0 * np.sqrt(1.0 - 0.92 * (u**2 + v**2)) + 11.0 * _bump(x, y / 2.2, (0.0, 1.0), 11.0)
    heights += 4.0 * _bump(x, y, (0.0, -46.0), 16.0) + 3.0 * _bump(x, y, (-27.0, -8.0), 16.0)
    heights += 3.0 * _bump(x, y, (27.0, -8.0), 16.0) - 4.0 * _bump(x, y, (-20.0, 20.0), 12.0)
    return [x, y, heights - 4.0 * _bump(x, y, (20.0, 20.0), 12.0)]


# name: target, and number of needles (None: chosen by the fit)
TARGETS: dict[str, tuple[Callable[[], TargetSurface], int | None]] = {
    **{f"cap {angle} deg": (partial(cap, angle, f"cap {angle} deg"), None) for angle in (35, 45, 50, 60)},
    "cap 35 deg, free": (partial(cap, 35.0, "cap 35 deg, free"), 0),
    "ellipsoid dome": (
        partial(graph, lambda x, y: 26.0 * np.sqrt(1.0 - (x / 76.0) ** 2 - (y / 52.0) ** 2), 124, 84, "ellipsoid dome"),
        None,
    ),
    "hypar": (lambda: TargetSurface.of_formula("11*x*y/41.7**2", 83.4, name="hypar"), None),
    "saddle": (partial(graph, lambda x, y: 10.0 * (x**2 - y**2) / 50.0**2, 100, 100, "saddle"), None),
    "monkey saddle": (
        partial(graph, lambda x, y: 9.0 * (x**3 - 3.0 * x * y**2) / 50.0**3, 100, 100, "monkey saddle"), None,
    ),
    "barrel": (partial(surface, "barrel", rectangle_mesh(np.deg2rad(110.0), 76.0), _barrel), None),
    "two bumps": (partial(graph, _two_bumps, 104, 104, "two bumps"), None),
    "three-legged shell": (partial(surface, "three-legged shell", round_mesh(), _three_legged_shell), None),
    "torus part": (partial(surface, "torus part", rectangle_mesh(1.05, 1.7), _torus_part), None),
    "hemisphere": (partial(cap, 85.0, "hemisphere"), None),
    "face mask": (partial(surface, "face mask", round_mesh(36), _face_mask), None),
}  # fmt: skip


def row(name: str, exact: bool) -> dict[str, Any]:
    """Fit one target, and draw it if it is shown."""
    make, needles = TARGETS[name]
    target, begun = make(), time.process_time()
    data: dict[str, Any] = {}
    try:
        fitted = fit(target, FitSettings(needles=needles, exact=exact), printer=load_printer("ultimaker2"))
    except ReachError as error:
        data["refused"] = str(error)
        settings = FitSettings(needles=needles, exact=False, nearest=True)
        fitted = fit(target, settings, printer=load_printer("ultimaker2"))
    data["cpu_s"] = time.process_time() - begun
    if exact and name in SHOWN:
        _picture(fitted).save(PICTURES / f"fit-{name.replace(' ', '-')}.webp", quality=78, method=6)
    if exact and "refused" not in data:
        data["first_guess_exact"] = _exact_first_guess(name)
    summary = fitted.summary.to_json()
    return data | {key: value for key, value in summary.items() if key not in ("design", "motion", "shift_mm")}


def _exact_first_guess(name: str) -> float:
    """Distance of the exact shape of the first guess, started from its preview."""
    make, needles = TARGETS[name]
    guess = guess_design(make(), paper_law(), FitSettings(needles=needles))
    plan = layout(guess.design)
    places = FitPlaces.of(guess.target_map, plan.outline, plan.lattice_vectors)
    residual = Residual(guess.target, places, not plan.pins)
    shape = exact_shape(guess.design, near=preview(guess.design))
    return float(target_distance(shape, residual, plan.lattice_vectors).mean_percent)


def _picture(fitted: Fit) -> Image.Image:
    """Target, shape, both, and signed distance, side by side on white."""
    views = fit_views(fitted)
    parts = [png(views[name][0]) for name in ("target", "shape", "overlaid")] + [signed_distance_map(fitted)]
    page, cell = Image.new("RGB", (PICTURE_WIDTH, PART_HEIGHT), "white"), PICTURE_WIDTH // len(parts)
    for count, part in enumerate(parts):
        image = Image.open(BytesIO(part)).convert("RGB")
        scale = min((cell - 12) / image.width, PART_HEIGHT / image.height)
        image = image.resize((round(image.width * scale), round(image.height * scale)), Image.Resampling.LANCZOS)
        page.paste(image, (count * cell + (cell - image.width) // 2, (PART_HEIGHT - image.height) // 2))
    return page


def cells(name: str, data: dict[str, Any]) -> list[str]:
    """One line of the table."""
    exact, held = data["exact"], "border" if data["held_border"] else f"{data['needles']} needles"
    corrected, other = data["corrections"], data.get("other_exact")
    distances = [
        data["first_guess"]["mean_percent"], data.get("first_guess_exact"), data["unrounded"]["mean_percent"],
        data["preview"]["mean_percent"], corrected[0]["mean_percent"] if corrected else None,
        exact and exact["mean_percent"] - data["rounding_loss_percent"], exact and exact["mean_percent"],
        exact and exact["largest_percent"], other and other["mean_percent"],
    ]  # fmt: skip
    return [
        name + (", nearest" if "refused" in data else ""), f"{data['diameter_mm']:.0f}",
        f"{data['stars']}, {held}, {data['stretch']:g}",
        f"{data['needed_ratio']:.3f}, {data['available_ratio']:.3f}", *map(number, distances),
        ("yes" if exact["is_minimum"] else "no") if exact else "-", f"{data['cpu_s']:.0f}",
    ]  # fmt: skip


def table(rows: dict[str, dict[str, Any]]) -> str:
    """Markdown: the table, medians, and why targets were refused."""
    lines = [markdown(HEADER, [cells(name, data) for name, data in rows.items()])]
    made = [data for data in rows.values() if "refused" not in data]
    for key, label in (("unrounded", "Fresh preview of the fit by the preview"), ("exact", "Exact shape as written")):
        values = [data[key]["mean_percent"] for data in made if data[key]]
        if values:
            lines.append(f"{label}: median {np.median(values):.2f} %, largest {max(values):.2f} %.")
    return "\n\n".join([*lines, *(f"Refused: {data['refused']}." for data in rows.values() if "refused" in data)])


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fit_targets")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--no-exact", action="store_true")
    parser.add_argument("names", nargs="*", metavar="NAME")
    given = parser.parse_intermixed_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    rows = {}
    for name in chosen(parser, given.names, {name: name for name in TARGETS}):
        file = given.folder / f"{name.replace(' ', '-')}.json"
        if not file.exists():
            file.write_text(json.dumps(row(name, not given.no_exact), indent=1))
        rows[name] = json.loads(file.read_text())
        print(name, "done", flush=True)
    text = table(rows)
    print(text)
    if not given.names and not given.no_exact:
        write_report("fit_targets", text, "python -m benchmarks.fit_targets FOLDER")


if __name__ == "__main__":
    main()
