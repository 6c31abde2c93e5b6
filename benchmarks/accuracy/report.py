"""The study's tables and plots, and the table in brief of docs/explanation/accuracy.md."""

from __future__ import annotations

import json
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from asterism.results.files import write_file
from benchmarks.accuracy.causes import CAUSES
from benchmarks.accuracy.speed import told
from benchmarks.report import RESULTS, markdown

DOCS = Path(__file__).parents[2] / "docs"
BEGIN, END = "<!-- accuracy of the preview -->", "<!-- end of accuracy of the preview -->"
FAR = 2.5  # % of the diameter, and more is a miss
HEIGHT_FAR = 6.0  # % of the height, and more is a miss
LOGARITHMIC = ("softness", "expected")
HEADER = [
    "design", "stars", "down", "held", "rms %", "rms mm", "after a rigid motion %", "largest %", "star centres %",
    "height %", "expected height %", "mean height %", "rise %", "roll radius %", "normals deg", "same form",
    "expected %", "exact, two meshes %", "exact shape", "warnings",
]  # fmt: skip


def row(r: dict[str, Any]) -> list[str]:
    """One line of the table."""
    starts = "from the preview" if r.get("result_from") == "preview" else "-"
    if "starts" in r:
        iterations = "/".join(str(one["iterations"]) for one in r["starts"].values())
        apart = "one minimum" if r["starts_agree"] else f"{r['starts_distance_percent']:.1f} % apart"
        starts = f"{apart}, {iterations}"
    return [
        r["name"],
        str(r["stars"]),
        str(len(r["exact"]["stars_down"]) if "exact" in r else r["stars_down"]),
        r["causes"].get("held", "-"),
        f"{r['rms_percent']:.2f}",
        f"{r['rms_mm']:.2f}",
        f"{r['rms_after_motion_percent']:.2f}",
        f"{r['max_percent']:.1f}",
        f"{r['rms_stars_percent']:.2f}",
        _signed(r["height_error_percent"]),
        _number(r.get("expected_height_percent"), 1),
        _signed(r.get("mean_height_error_percent")),
        _signed(r.get("rise_error_percent")),
        _signed(r["roll_radius_error_percent"]),
        f"{r['normals_rms_deg']:.1f}",
        "yes" if r["same_branch"] else "no",
        _number(r["expected_rms_percent"]),
        _number(r.get("mesh_change_percent")),
        starts,
        str(len(r["warnings"])),
    ]


def totals(rows: list[dict[str, Any]]) -> str:
    """The study in a few numbers, each beside what it should be."""
    rms = np.array([r["rms_percent"] for r in rows])
    heights, means = _known(rows, "height_error_percent"), _known(rows, "mean_height_error_percent")
    radii = _known(rows, "roll_radius_error_percent")
    expected = [r for r in rows if r["expected_rms_percent"] is not None]
    rises = _known(rows, "rise_error_percent")
    lines = [
        ["rms distance, median", "at most 1.0 %", f"{np.median(rms):.2f} %"],
        ["rms distance, nine in ten", "at most 2.5 %", f"{np.quantile(rms, 0.9):.2f} %"],
        [
            "distance of the exact shape from that on a coarser mesh",
            "",
            _spread_in_words(_known(rows, "mesh_change_percent")),
        ],
        ["height, bumps included", "within 6 %", _within(heights, 6.0)],
        ["height of the cell means", "within 6 %", _within(means, 6.0)],
        ["rise of held sheets over what holds them", "within 6 %", _within(rises, 6.0)],
        ["radius of the roll", "within 6 %", _within(radii, 6.0)],
        [
            "stars' bumps: distance over their size",
            "",
            f"median {np.median(_known(rows, 'relief_error_percent')):.0f} %",
        ],
        ["same form", "nine in ten", f"{sum(r['same_branch'] for r in rows)} of {len(rows)}"],
    ]
    lines.append(["time of the exact model over a preview's", "at least 100", speedups()])
    if expected:
        ratio = np.array([r["rms_percent"] / r["expected_rms_percent"] for r in expected])
        found = f"median {np.median(ratio):.2f}, nine in ten {np.quantile(ratio, 0.9):.2f}"
        lines.append(["distance over what was expected", "", found])
    far = [r for r in rows if missed(r)]
    lines.append(["misses that were announced", "all", f"{sum(map(announced, far))} of {len(far)}"])
    off, near = ([r for r in rows if height_missed(r) == far] for far in (True, False))
    told = f"{sum(map(height_announced, off))} of {len(off)}, {sum(map(height_expected, off))} by the number"
    lines.append(["heights off by more than 6 % that were announced", "all", told])
    told = f"{sum(map(height_announced, near))} of {len(near)}, {sum(map(height_expected, near))} by the number"
    lines.append(["heights within 6 % that were announced too", "few", told])
    return markdown(["", "wanted", "found"], lines)


def speedups() -> str:
    """What `benchmarks.accuracy.speed` has measured."""
    rows = json.loads((RESULTS / "accuracy.speed.json").read_text(encoding="utf-8"))["rows"]
    return f"from nothing {told(rows, 'again_ms')}; for an edit {told(rows, 'edit_ms')}"


def missed(r: dict[str, Any]) -> bool:
    """Further off than 2.5 %, or another form."""
    return r["rms_percent"] > FAR or not r["same_branch"]


def announced(r: dict[str, Any]) -> bool:
    """Whether the preview expected to be as far off as counts as a miss, or warned of another form."""
    expected = r["expected_rms_percent"]
    return (expected is not None and expected > FAR) or _another_form(r)


def height_missed(r: dict[str, Any]) -> bool:
    """A height that is off by more than 6 %."""
    return abs(r["height_error_percent"]) > HEIGHT_FAR


def height_announced(r: dict[str, Any]) -> bool:
    """Whether the preview expected its height to be off by as much as counts as a miss, or warned of another form."""
    return height_expected(r) or _another_form(r)


def height_expected(r: dict[str, Any]) -> bool:
    """Whether it expected its height to be off by as much as counts as a miss."""
    expected = r["expected_height_percent"]
    return expected is not None and bool(expected > HEIGHT_FAR)


def _another_form(r: dict[str, Any]) -> bool:
    return any("another form" in line for line in r["warnings"])


def misses(rows: list[dict[str, Any]]) -> str:
    """What is further off than 2.5 %, or another form, with what had been said about it."""
    lines = []
    for r in rows:
        if not missed(r):
            continue
        expected = r["expected_rms_percent"]
        said = "nothing expected" if expected is None else f"expected {expected:.1f} %"
        warned = "; ".join(r["warnings"]) or "no warning"
        form = "" if r["same_branch"] else ", another form"
        lines.append(f"- `{r['name']}`: {r['rms_percent']:.1f} %{form}. {said[0].upper() + said[1:]}; {warned}.")
    return "\n".join(lines) or "None."


def plot(rows: list[dict[str, Any]], path: Path) -> None:
    """The distance against each of its possible causes, and against what was expected."""
    figure = Figure(figsize=(11.0, 6.4), layout="constrained")
    FigureCanvasAgg(figure)
    names = [*CAUSES.items(), ("expected", "expected, %")]
    for axes, (name, label) in zip(figure.subplots(2, 4, sharey=True).flat, names, strict=False):
        for held, colour in (("free", "tab:orange"), ("held", "tab:blue")):
            some = [r for r in rows if r["causes"].get("held") == held and _cause(r, name) is not None]
            if some:
                axes.semilogy(
                    [_cause(r, name) for r in some], [r["rms_percent"] for r in some], "o", color=colour, label=held,
                    markersize=5, markeredgewidth=0, alpha=0.8,
                )  # fmt: skip
        axes.axhline(1.0, color="0.8", linewidth=1.0, zorder=0)
        axes.set_xlabel(label, fontsize=8)
        if name in LOGARITHMIC:
            axes.set_xscale("log")
            axes.xaxis.set_minor_formatter(NullFormatter())
        axes.grid(True, which="major", color="0.92")
    figure.axes[0].legend(frameon=False)
    for axes in figure.axes[::4]:
        axes.set_ylabel("rms distance, % of the diameter")
    figure.axes[-1].remove()
    out = BytesIO()
    figure.savefig(out, format="png", dpi=100)
    write_file(path, out.getvalue())


def section(rows: list[dict[str, Any]], left_out: dict[str, str]) -> str:
    """Markdown."""
    left = "\n".join(f"- `{name}`: {why}" for name, why in left_out.items())
    return "\n\n".join(
        [
            totals(rows),
            "![Distance against its possible causes](../pictures/accuracy.png)",
            f"Further off than 2.5 %, or another form:\n\n{misses(rows)}",
            *([f"Without a preview:\n\n{left}"] if left else []),
            markdown(HEADER, [row(r) for r in rows]),
        ]
    )


def in_brief(rows: list[dict[str, Any]]) -> str:
    """Distances and heights of the study in four rows."""
    supported = [r for r in rows if r["causes"].get("held") == "held"]
    free = [r for r in rows if r["causes"].get("held") == "free"]
    lines = [
        ["rms distance, all designs", *_spread(_known(rows, "rms_percent"))],
        ["rms distance, supported sheets", *_spread(_known(supported, "rms_percent"))],
        ["rms distance, free sheets", *_spread(_known(free, "rms_percent"))],
        ["height, all designs", *_spread(_known(rows, "height_error_percent"))],
    ]
    return markdown(["", "designs", "median, %", "nine in ten within, %", "largest, %"], lines)


def put_into_docs(text: str, begin: str = BEGIN, end: str = END) -> None:
    """Replaces the text between two comments in docs/explanation/accuracy.md."""
    path = DOCS / "explanation" / "accuracy.md"
    before, rest = path.read_text(encoding="utf-8").split(begin)
    write_file(path, f"{before}{begin}\n\n{text}\n\n{end}{rest.split(end)[1]}")


def _spread(errors: np.ndarray) -> list[str]:
    return [str(len(errors)), *(f"{np.quantile(errors, share):.2f}" for share in (0.5, 0.9, 1.0))]


def _spread_in_words(values: np.ndarray) -> str:
    if len(values) == 0:
        return "-"
    return f"{len(values)} designs: median {np.median(values):.2f} %, largest {values.max():.2f} %"


def _cause(r: dict[str, Any], name: str) -> float | None:
    return r["expected_rms_percent"] if name == "expected" else r["causes"].get(name)


def _known(rows: list[dict[str, Any]], name: str) -> np.ndarray:
    return np.abs([r[name] for r in rows if r.get(name) is not None])


def _within(errors: np.ndarray, limit: float) -> str:
    if len(errors) == 0:
        return "-"
    return f"{(errors <= limit).sum()} of {len(errors)}, median {np.median(errors):.1f} %, largest {errors.max():.1f} %"


def _number(value: float | None, digits: int = 2) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def _signed(value: float | None) -> str:
    return "-" if value is None else f"{value:+.1f}"
