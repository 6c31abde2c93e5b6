"""Every design of the gallery by the exact model: numbers, seconds, a picture each, and the page that shows them.

python -m benchmarks.gallery [NAME ...]    (with names: these only, no page)
"""

from __future__ import annotations

import sys
from io import BytesIO
from itertools import takewhile
from pathlib import Path
from typing import Any

from PIL import Image

from asterism.draw.picture import draw_shape, small_png
from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.results.files import write_file
from asterism.shape.shape import Shape
from benchmarks.report import RESULTS, markdown, write_report

DOCS = Path(__file__).parent.parent / "docs"
PICTURES, PAGE = DOCS / "pictures", DOCS / "reference" / "gallery.md"
INTRODUCTION = """# The gallery

Designs of the paper's figures. `asterism new NAME` writes one of them as a file to start from. The paper prints few of
their sizes: each design states which of its values come from the paper and which are chosen.

The table has the shapes of the [exact model](../explanation/exact-model.md) on a mesh with edges of 2 mm. A design with
an eigenvalue is a certified minimum. The seconds are from two cores, with compiled loops.
`python -m benchmarks.gallery` prints the table and writes this page.
"""
# names of pictures of drawn patterns
PATTERN_PICTURE = "pattern-{}"
PATTERNS_INTRODUCTION = """## Drawn patterns

Patterns of other works on printed textiles, [drawn line by line](../how-to/patterns.md). `asterism new NAME` writes
these too. Each names its source and what is chosen.

The table has the lowest minimum from three starts, and how much higher the next one is. Processor seconds are those of
all three starts. `python -m benchmarks.pattern_gallery` prints the table and writes this page.
"""
HEADER = [
    "design", "stars up", "vertices", "energy N mm", "height mm", "extent mm", "contraction",
    "smallest eigenvalue N/mm", "iterations", "factorisations", "seconds",
]  # fmt: skip


def main(names: list[str]) -> None:
    rows: list[dict[str, Any]] = []
    for name in names or gallery.names():
        shape = exact_shape(gallery.load(name))
        rows.append({key: value for key, value in shape.summary.items() if key != "design"} | {"name": name})
        picture(shape, name)
        print("  ".join(row(rows[-1])), flush=True)
        if not shape.summary["is_minimum"]:
            print(f"{name}: NOT A MINIMUM", flush=True)
    if not names:
        table = markdown(HEADER, [row(r) for r in rows])
        write_report("gallery", rows, table)
        write_file(PAGE, whole_page())


def row(r: dict[str, Any]) -> list[str]:
    """One line of the table."""
    verdict = f"{r['smallest_eigenvalue']:.1e}" if r["is_minimum"] else "no minimum"
    return [
        r["name"],
        f"{r['stars_up']}/{r['stars_total']}",
        str(r["vertices"]),
        f"{r['energy_n_mm']:.2f}",
        f"{r['height_mm']:.1f}",
        " x ".join(f"{size:.0f}" for size in r["extent_mm"]),
        "-" if r["contraction"] is None else f"{r['contraction']:.3f}",
        verdict,
        str(r["iterations"]),
        str(r["factorisations"]),
        f"{r['wall_s']:.1f}",
    ]


def whole_page() -> str:
    """docs/reference/gallery.md: the stored tables, then each design with the comment of its file."""
    parts = [INTRODUCTION, stored_table("gallery"), ""]
    parts += [part for name in gallery.names() for part in section(name, "##")]
    parts += [PATTERNS_INTRODUCTION, stored_table("pattern_gallery"), ""]
    parts += [part for name in gallery.pattern_names() for part in section(name, "###", PATTERN_PICTURE)]
    return "\n".join(parts)


def stored_table(name: str) -> str:
    """The table of a benchmark's last results."""
    return (RESULTS / f"{name}.md").read_text(encoding="utf-8").partition("\n\n")[2].strip()


def section(name: str, level: str, picture_name: str = "{}") -> list[str]:
    """Lines on one design: heading, comment and picture."""
    lines = gallery.path(name).read_text(encoding="utf-8").splitlines()
    comment = [line.removeprefix("#").strip() for line in takewhile(lambda line: line.startswith("#"), lines)]
    shown = f"![{name}: perspective, from above, from the front](../pictures/{picture_name.format(name)}.png)"
    return [f"{level} {name}", "", *comment, "", shown, ""]


def picture(shape: Shape, name: str, title: str | None = None) -> None:
    """docs/pictures/NAME.png, small enough for a page."""
    large = BytesIO()
    draw_shape(shape, title or name, large)
    image = Image.open(large).convert("RGB")
    image.thumbnail((1000, 1000))
    write_file(PICTURES / f"{name}.png", small_png(image))


if __name__ == "__main__":
    main(sys.argv[1:])
