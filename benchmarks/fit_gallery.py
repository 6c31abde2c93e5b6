"""Six targets with the designs that are fitted to them: numbers, a picture each, and the page that shows them.

python -m benchmarks.fit_gallery FOLDER [--no-exact] [NAME ...]

Each target is kept in FOLDER as soon as it is done, with its report; a further run goes on from there. The page is
written when all six are done. `python -m benchmarks.fit FOLDER` keeps the same fits in FOLDER/gallery.
"""

from __future__ import annotations

import argparse
import json
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from asterism.fitting.fit import fit
from asterism.fitting.result import Fit
from asterism.print.profiles import load_printer
from asterism.reports.fit_files import write_fit
from asterism.reports.fit_plots import signed_distance_map
from asterism.reports.fit_views import fit_views
from asterism.reports.html import png
from asterism.results.files import write_file
from benchmarks.chosen_names import chosen_names
from benchmarks.fit_targets import TARGETS
from benchmarks.report import markdown, write_report
from benchmarks.small_pictures import write_small

SHOWN = ("ellipsoid dome", "two bumps", "three-legged shell", "hypar", "monkey saddle", "barrel")
DOCS = Path(__file__).parent.parent / "docs"
PAGE = DOCS / "reference" / "fit-gallery.md"
# pixels, width of a picture of the page, and height of one of its parts
PICTURE_WIDTH, PART_HEIGHT = 1400, 300
INTRODUCTION = """# Gallery of fits

Six target surfaces, and the designs that [`asterism fit`](../how-to/fit.md) finds for them. From left to right: the
target, the {by} of the design, both in one another (target orange), and the signed distance on the print, red on the
plastic side. `python -m benchmarks.fit_gallery FOLDER{option}` computes the designs, and writes table and page.
Distances are rms over the printed area in % of the largest distance of two points of the target. Thicknesses are whole
layers of an Ultimaker 2. [Fit to a target](../explanation/fit.md) explains the method. More targets{also} are in
[benchmarks/results/fit.md](../../benchmarks/results/fit.md).
"""
HEADER = ["target", "diameter mm", "stars, held by, stretch", "first guess", "preview", "loss by rounding"]
EXACT_HEADER, LAST_HEADER = "exact", "largest"


def main() -> None:
    """Fit the targets that are not done, and write the page when all are."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--no-exact", action="store_true")
    parser.add_argument("names", nargs="*", metavar="NAME")
    given = parser.parse_intermixed_args()
    for name in chosen_names(parser, given.names, SHOWN):
        folder = given.folder / _file(name)
        if not (folder / "summary.json").exists():
            make, needles = TARGETS[name]
            keep(
                name, fit(make(), needles=needles, printer=load_printer("ultimaker2"), exact=not given.no_exact), folder
            )
        print(name, "done", flush=True)
    done = {name: given.folder / _file(name) / "summary.json" for name in SHOWN}
    if all(file.exists() for file in done.values()):
        write({name: json.loads(file.read_text()) for name, file in done.items()})


def keep(name: str, fitted: Fit, folder: Path) -> None:
    """Write the folder of a fit, and its picture for the page."""
    write_fit(fitted, folder)
    write_small(_picture(fitted), DOCS / "pictures" / f"fit-{_file(name)}.webp")


def write(summaries: dict[str, dict[str, Any]]) -> None:
    """Write table and page."""
    is_exact = all(summary["exact"] for summary in summaries.values())
    header = [*HEADER, *([EXACT_HEADER] if is_exact else []), LAST_HEADER]
    table = markdown(header, [_row(name, summary, is_exact) for name, summary in summaries.items()])
    rows = [
        {"row": name, **{key: value for key, value in summary.items() if key not in ("design", "motion", "shift_mm")}}
        for name, summary in summaries.items()
    ]
    write_report("fit_gallery", rows, table)
    words = {
        "by": "exact shape" if is_exact else "preview",
        "option": "" if is_exact else " --no-exact",
        "also": "" if is_exact else ", and exact shapes,",
    }
    parts = [INTRODUCTION.format(**words), table]
    for name in summaries:
        parts.append(
            f"## {name.capitalize()}\n\n![{name}: target, shape, distance](../pictures/fit-{_file(name)}.webp)"
        )
    write_file(PAGE, "\n\n".join(part.strip() for part in parts) + "\n")


def _row(name: str, summary: dict[str, Any], is_exact: bool) -> list[str]:
    result = summary["exact" if is_exact else "preview"]
    loss = summary["rounding_loss_percent"]
    held = "border" if summary["held_border"] else f"{summary['needles']} needles"
    return [
        name,
        f"{summary['diameter_mm']:.0f}",
        f"{summary['stars']}, {held}, {summary['stretch']:g}",
        f"{summary['first_guess']['mean_percent']:.2f}",
        f"{summary['preview']['mean_percent']:.2f}",
        "-" if loss is None else f"{loss:.3f}",
        *([f"{result['mean_percent']:.2f}"] if is_exact else []),
        f"{result['largest_percent']:.1f}",
    ]


def _picture(fitted: Fit) -> bytes:
    """PNG of target, shape, both, and signed distance, side by side on white."""
    views = fit_views(fitted)
    parts = [Image.open(BytesIO(png(views[name][0]))) for name in ("target", "shape", "overlaid")]
    parts.append(Image.open(BytesIO(signed_distance_map(fitted))))
    cell = PICTURE_WIDTH // len(parts)
    page = Image.new("RGB", (PICTURE_WIDTH, PART_HEIGHT), "white")
    for number, part in enumerate(parts):
        seen = part.convert("RGB")
        scale = min((cell - 12) / seen.width, PART_HEIGHT / seen.height)
        size = np.maximum(np.round(np.array(seen.size) * scale), 1).astype(int)
        small = seen.resize((int(size[0]), int(size[1])), Image.Resampling.LANCZOS)
        page.paste(small, (number * cell + (cell - small.width) // 2, (PART_HEIGHT - small.height) // 2))
    stream = BytesIO()
    page.save(stream, format="PNG")
    return stream.getvalue()


def _file(name: str) -> str:
    return name.replace(" ", "-")


if __name__ == "__main__":
    main()
