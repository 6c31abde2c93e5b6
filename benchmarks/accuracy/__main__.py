"""The study: the preview against the exact model, for the gallery and 24 designs at random.

python -m benchmarks.accuracy FOLDER [NAME ...]    (with names: these only, no report and no picture)

FOLDER keeps exact shapes and finished comparisons. The exact model starts from the released sheet and from the preview,
and the shape of lower energy counts. docs/pictures/accuracy.png shows the distances against possible causes.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from asterism.homogenize.errors import LawError
from asterism.results.files import write_file
from benchmarks.accuracy.comparisons import Row, compared
from benchmarks.accuracy.designs import designs
from benchmarks.accuracy.tables import by_support, line, section
from benchmarks.report import PICTURES, chosen, write_report

CAUSES = {
    "stars": "stars", "softness": "smallest eigenvalue, exact, N/mm", "mesh_change_percent": "exact, two meshes, %",
    "expected_rms_percent": "expected, %",
}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy")
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    options = parser.parse_intermixed_args()
    rows, left_out = [], []
    for design in chosen(parser, options.names, {design.name: design for design in designs()}):
        try:
            rows.append(compared(design, options.folder))
        except LawError as error:
            left_out.append(f"Without a preview: {error}.")
            continue
        print("  ".join(line(rows[-1])), flush=True)
    text = section(by_support(rows), *left_out) if rows else "\n".join(left_out)
    print(text)
    if not options.names:
        write_report("accuracy", text, "python -m benchmarks.accuracy FOLDER")
        write_file(PICTURES / "accuracy.png", plot(rows))


def plot(rows: Sequence[Row]) -> bytes:
    """PNG of the distance against its possible causes, and against what was expected."""
    figure = Figure(figsize=(11.0, 3.4), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (name, label) in zip(figure.subplots(1, len(CAUSES), sharey=True), CAUSES.items(), strict=True):
        for held, colour in (("free", "tab:orange"), ("held", "tab:blue")):
            some = [row for row in rows if row["is_held"] == (held == "held") and row[name] is not None]
            x, y = [row[name] for row in some], [row["rms_percent"] for row in some]
            axes.loglog(x, y, "o", color=colour, label=held, markersize=5, markeredgewidth=0, alpha=0.8)
        axes.axhline(1.0, color="0.8", linewidth=1.0, zorder=0)
        axes.set_xlabel(label)
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.grid(True, which="major", color="0.92")
    figure.axes[0].legend(frameon=False)
    figure.axes[0].set_ylabel("rms distance, % of the diameter")
    out = BytesIO()
    figure.savefig(out, format="png", dpi=100)
    return out.getvalue()


if __name__ == "__main__":
    main()
