"""Previews of motifs against the exact model: sheets that are drawn once, one half to work with, the other to report.

python -m benchmarks.motif_previews [working | held_out]
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.print_layout import print_layout
from asterism.verification.run import verify
from benchmarks.motif_shells import MOTIFS
from benchmarks.report import markdown, write_report

SEED, EDGE_MM = 1, 2.5
HALVES = ("working", "held_out")
# sides of the sheets, mm, and the distance of their lines that rods must keep from the outline's corners
SMALL_MM, LARGE_MM = (48.0, 64.0), (80.0, 100.0)
THICKNESS_MM, LARGEST_RATIO = (0.32, 0.5), 1.25
# the announced error counts as met if the error is at most this many times as large
ANNOUNCED_FACTOR = 2.0
MEDIAN_PERCENT, MAX_PERCENT = 1.0, 2.5


def drawn_sheets() -> dict[str, list[tuple[str, Design]]]:
    """The sheets of both halves: of every motif, free or supported, and of one thickness or graded, one each."""
    rng = np.random.default_rng(SEED)
    halves: dict[str, list[tuple[str, Design]]] = {half: [] for half in HALVES}
    for number, name in enumerate(MOTIFS):
        for supported in (False, True):
            for graded in (False, True):
                large = bool((number + supported) % 2)
                half = HALVES[(number + supported + graded) % 2]
                words = ["supported" if supported else "free", "graded" if graded else "uniform"]
                design = printable(partial(_drawn, rng, name, supported, graded, large))
                halves[half].append((f"{name}, {', '.join(words)}", design))
    return halves


def printable(drawn: Callable[[], Design]) -> Design:
    """The first sheet that can be printed: at some sizes the outline leaves rods too near to each other."""
    while True:
        design = drawn()
        try:
            print_layout(design)
        except DesignError:
            continue
        return design


def _drawn(rng: np.random.Generator, name: str, supported: bool, graded: bool, large: bool) -> Design:
    lines, lattice = MOTIFS[name]
    width, height = np.round(rng.uniform(*(LARGE_MM if large else SMALL_MM), size=2))
    low = float(np.round(rng.uniform(*THICKNESS_MM), 2))
    high = float(np.round(low * rng.uniform(1.1, LARGEST_RATIO), 2))
    angle, reach = rng.uniform(0.0, np.pi), 0.4 * min(width, height)
    along = reach * np.array([np.cos(angle), np.sin(angle)])
    ends = {"start_mm": (-along).round(1).tolist(), "end_mm": along.round(1).tolist()}
    thickness = {"profile": "linear", "from": low, "to": high, **ends} if graded else low
    scale, by_edges = float(np.round(rng.uniform(0.85, 0.95), 3)), rng.random() < 0.5
    held = {"edges": [0, 2]} if by_edges else {"where": "corners"}
    return Design.from_dict(
        {
            "name": f"{name}-{'supported' if supported else 'free'}-{'graded' if graded else 'uniform'}",
            "rods": {"motif": lines, "thickness_mm": thickness},
            "lattice": lattice,
            "border": {"rectangle_mm": (width, height)},
            "pins": [{**held, "scale": scale}] if supported else [],
            "mesh": {"edge_mm": EDGE_MM},
        }
    )


def measured(sheet: str, design: Design) -> dict[str, Any]:
    """Preview and exact shape of one sheet."""
    print(sheet, flush=True)
    summary = verify(design, say=lambda text: None).summary
    (height, shown), expected_height = summary["heights_mm"], summary["expected_height_percent"]
    row = {
        "sheet": sheet,
        "size_mm": design.border.rectangle_mm,
        "rms_percent": summary["rms_percent"],
        "max_percent": summary["max_percent"],
        "expected_percent": summary["expected_rms_percent"],
        "height_mm": height,
        "height_error_mm": shown - height,
        "expected_height_mm": None if expected_height is None else 0.01 * expected_height * shown,
        "same_form": summary["same_branch"],
        "exact_minimum": summary["exact"]["is_minimum"],
        "preview_minimum": summary["preview"]["is_minimum"],
        "starts_agree": summary["starts_agree"],
        "warnings": summary["preview"]["warnings"],
        "preview_s": summary["preview_again_s"],
        "exact_s": summary["exact_s"],
    }
    print(row, flush=True)
    return row


def is_announced(row: dict[str, Any]) -> bool:
    """Whether the preview states an error of this size."""
    expected = row["expected_percent"]
    return expected is None or row["rms_percent"] <= ANNOUNCED_FACTOR * expected


def table(rows: list[dict[str, Any]]) -> str:
    """The rows as Markdown, and what they show in one line."""
    header = ["sheet", "mm", "rms %", "estimated %", "largest %", "height mm", "its error mm", "estimated mm", "form"]
    lines = [
        [
            row["sheet"],
            " x ".join(f"{side:g}" for side in row["size_mm"]),
            f"{row['rms_percent']:.2f}",
            _one_digit(row["expected_percent"]),
            f"{row['max_percent']:.1f}",
            f"{row['height_mm']:.1f}",
            f"{row['height_error_mm']:.1f}",
            _one_digit(row["expected_height_mm"]),
            "same" if row["same_form"] else "other" if row["exact_minimum"] else "no exact minimum",
        ]
        for row in rows
    ]
    errors = np.array([row["rms_percent"] for row in rows])
    far = [row for row in rows if row["rms_percent"] > MAX_PERCENT and not is_announced(row)]
    met = sum(row["expected_percent"] is not None and row["rms_percent"] <= row["expected_percent"] for row in rows)
    known = [row for row in rows if row["expected_height_mm"] is not None]
    high = sum(abs(row["height_error_mm"]) <= row["expected_height_mm"] for row in known)
    text = f"Median {np.median(errors):.2f} %, largest {errors.max():.2f} %; {met} of {len(rows)} within the estimate; "
    text += f"{len(far)} above {MAX_PERCENT} % and not announced. {high} of {len(known)} heights within their estimate."
    return f"{markdown(header, lines)}\n\n{text}"


def main(halves: list[str]) -> None:
    sheets = drawn_sheets()
    parts, rows = [], []
    for half in halves:
        of_half = [measured(*sheet) for sheet in sheets[half]]
        rows += [{"half": half, **row} for row in of_half]
        parts.append(f"{half.replace('_', ' ').capitalize()} sheets:\n\n{table(of_half)}")
    text = f"Previews of motifs against the exact model, edges of {EDGE_MM:g} mm.\n\n" + "\n\n".join(parts)
    print(text)
    if halves == list(HALVES):
        write_report("motif_previews", rows, text)


def _one_digit(value: float | None) -> str:
    return "-" if value is None else f"{value:.1f}"


if __name__ == "__main__":
    main(sys.argv[1:] or list(HALVES))
