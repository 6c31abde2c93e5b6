"""Every design of the gallery as a preview: numbers, a picture each, and the page that shows them.

python -m benchmarks.preview_gallery [NAME ...]    (with names: these only, no page)
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law_file import load_law
from asterism.pattern import gallery
from asterism.previews.run import preview
from asterism.results.files import write_file
from benchmarks.gallery import picture
from benchmarks.laws import law_of
from benchmarks.report import RESULTS, markdown, write_report

PAGE = Path(__file__).parent.parent / "docs" / "reference" / "preview-gallery.md"
INTRODUCTION = """# Previews of the gallery

Every design of the [gallery](gallery.md): the [preview](../explanation/preview.md) on the left, the
[exact shape](../explanation/exact-model.md) on the right. `python -m benchmarks.preview_gallery` prints the table and
writes this page; heights of the exact shapes are those of `python -m benchmarks.gallery`. The page on
[accuracy](../explanation/accuracy.md) has the distances between the two.

A design of another material than the paper's uses a [law of its own stars](../how-to/calibrate.md#for-one-design).
`asterism calibrate NAME.toml` computes it. Its line in the table is marked "own law".

The previews of `doubly-curved` and `fig8-l-uniform` show another form than the exact model finds when it releases the
flat print. Started from the preview, the exact model reaches the form of the preview, with less energy.
"""
HEADER = [
    "design", "stars", "not scale-separated", "triangles", "iterations", "start", "height mm", "exact height mm",
    "extent mm", "contraction", "exact contraction", "softest mode N/mm3",
]  # fmt: skip


def main(names: list[str]) -> None:
    law = load_law()
    rows: list[dict[str, Any]] = []
    for name in names or gallery.names():
        design = gallery.load(name)
        try:
            its = law_of(design, law)
            shape = preview(design, its)
        except LawError as error:
            rows.append({"name": name, "refused": str(error)})
            print(f"{name}: {error}", flush=True)
            continue
        kept = {key: value for key, value in shape.summary.items() if key != "design"}
        rows.append(kept | {"name": name, "own_law": its is not law})
        picture(shape, f"preview-{name}", name)
        print("  ".join(row(rows[-1], {})), flush=True)
    if not names:
        exact = {r["name"]: r for r in json.loads((RESULTS / "gallery.json").read_text())["rows"]}
        table = markdown(HEADER, [row(r, exact.get(r["name"], {})) for r in rows if "refused" not in r])
        write_report("preview_gallery", rows, table)
        write_file(PAGE, page(table, rows))


def row(r: dict[str, Any], exact: dict[str, Any]) -> list[str]:
    """One line of the table."""
    other = (f"{exact['height_mm']:.1f}", _ratio(exact["contraction"])) if exact else ("-", "-")
    return [
        r["name"] + (", own law" if r["own_law"] else "") + ("" if r["is_minimum"] else " (no minimum)"),
        str(r["stars"]),
        str(len(r["stars_tight"])),
        str(r["shell_triangles"]),
        str(r["iterations"]),
        r["start"],
        f"{r['height_mm']:.1f}",
        other[0],
        " x ".join(f"{size:.0f}" for size in r["extent_mm"]),
        _ratio(r["contraction"]),
        other[1],
        f"{r['soft_modes_n_mm3'][0]:.1e}" if r["soft_modes_n_mm3"] else "-",
    ]


def _ratio(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def page(table: str, rows: list[dict[str, Any]]) -> str:
    """docs/reference/preview-gallery.md."""
    parts = [INTRODUCTION, table, ""]
    for r in rows:
        name = r["name"]
        parts += [f"## {name}", ""]
        if "refused" in r:
            parts += [f"No preview: {r['refused']}.", ""]
        else:
            both = (f"![{name}, preview](../pictures/preview-{name}.png)", f"![{name}, exact](../pictures/{name}.png)")
            parts += [" ".join(both), ""]
    return "\n".join(parts)


if __name__ == "__main__":
    main(sys.argv[1:])
