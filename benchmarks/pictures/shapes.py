"""Pictures of shapes: of the gallery, of designs in the text, of a verification, of contact, and of printed sheets."""

from __future__ import annotations

import re
import tempfile
import tomllib
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path

import numpy as np
import pypdfium2
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from PIL import Image

from asterism.draw.picture import draw_shape
from asterism.draw.render import render
from asterism.draw.scene import drawn_size, scene, sheet_camera
from asterism.exact.simulation import exact_shape
from asterism.homogenize.errors import LawError
from asterism.measure.compare import surface_cut
from asterism.pattern import gallery as designs
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.session import preview
from asterism.print.export import write_export
from asterism.print.job import prepare
from asterism.print.printer import load_plastic, load_printer
from asterism.reports.html import png, small_png
from asterism.reports.plots import comparison_views
from asterism.results.files import write_file
from asterism.shape.comparison import compare_shapes
from asterism.shape.shape import Shape
from benchmarks.report import PICTURES, ROOT, markdown, number

GALLERY_HEADER = [
    "design", "stars", "vertices", "energy N mm", "height mm", "height of the preview mm", "width x depth mm",
    "contraction", "smallest eigenvalue N/mm", "minima of the starts", "next minimum %",
]  # fmt: skip
# twice the size at which the studio's first page shows them, for fine screens
START_PX = np.array([440, 300])
FORMS_DESIGN = "fig8-h-decreasing"
# name of a picture: design, page of its layout.pdf
EXPORTED = {"sheet-layout": ("u-shape", 0), "sheet-needles": ("roof", 2)}


def gallery(*names: str) -> None:
    """NAME.png and preview-NAME.png of designs, pattern-NAME.png of patterns, and the rows of their tables."""
    rows = []
    for name, design in _named(names):
        is_pattern = name in designs.pattern_names()
        shape, shown = exact_shape(design, starts=3 if is_pattern else 1), None
        draw(shape, f"pattern-{name}" if is_pattern else name, name)
        try:
            shown = preview(design)
        except (LawError, DesignError) as error:
            print(f"{name}: no preview: {error}")
        if shown is not None and not is_pattern:
            draw(shown, f"preview-{name}", name)
        s = shape.summary
        rows.append([
            name, str(s["stars_total"]), str(s["vertices"]), f"{s['energy_n_mm']:.1f}", f"{s['height_mm']:.1f}",
            number(shown and shown.summary["height_mm"], ".1f"),
            " x ".join(f"{size:.0f}" for size in s["extent_mm"][:2]), number(s["contraction"], ".3f"),
            f"{s['smallest_eigenvalue']:.1e}" if s["is_minimum"] else "no minimum",
            str(s.get("minima_seen", "-")), number(s.get("next_minimum_percent")),
        ])  # fmt: skip
        print("  ".join(rows[-1]), flush=True)
    print(markdown(GALLERY_HEADER, rows))


def draw(shape: Shape, name: str, title: str) -> None:
    """docs/pictures/NAME.png, small enough for a page."""
    large = BytesIO()
    draw_shape(shape, title, large)
    image = Image.open(large).convert("RGB")
    image.thumbnail((1000, 1000))
    write_file(PICTURES / f"{name}.png", small_png(image))


def _named(names: tuple[str, ...]) -> Iterator[tuple[str, Design]]:
    """Designs and patterns of the gallery, by default all."""
    known = (*designs.names(), *designs.pattern_names())
    for name in names or known:
        if name not in known:
            raise KeyError(name)
        yield name, designs.load(name)


def start(*names: str) -> None:
    """asterism/studio/gallery/NAME.png: previews, of some drawings exact shapes, in perspective on no ground."""
    for name, design in _named(names):
        try:
            shape = preview(design)
        except (LawError, DesignError):
            shape = exact_shape(design)
        write_file(ROOT / "asterism" / "studio" / "gallery" / f"{name}.png", _small(shape))
        print(name, flush=True)


def _small(shape: Shape) -> bytes:
    shape = shape if shape.held else shape.aligned()
    thing, view = scene(shape), sheet_camera("oblique", shape.positions)
    image = render(thing, view, float(((START_PX - 8) / drawn_size(thing, view)).min()))[::-1]
    part = Image.fromarray(np.rint(255 * np.clip(image, 0, 1)).astype(np.uint8), "RGBA")
    picture = Image.new("RGBA", tuple(START_PX.tolist()))
    picture.paste(part, ((picture.width - part.width) // 2, (picture.height - part.height) // 2))
    out = BytesIO()
    # the octree is the only one of these choices that keeps opacity
    picture.quantize(255, Image.Quantize.FASTOCTREE, kmeans=1).save(out, "PNG", optimize=True)
    return out.getvalue()


def pages(*names: str) -> None:
    """NAME.png of the whole designs of docs/how-to/patterns.md that it shows, and branches-1.png and branches-2.png."""
    text = (ROOT / "docs" / "how-to" / "patterns.md").read_text(encoding="utf-8")
    tables = map(tomllib.loads, re.findall(r"```toml\n(name = .*?)```", text, re.DOTALL))
    shown = {table["name"]: table for table in tables if f"pictures/{table['name']}.png" in text}
    for name in names or (*shown, "branches"):
        if name == "branches":
            shape = exact_shape(designs.load(FORMS_DESIGN), starts=10)
            for count, form in enumerate((shape, *shape.others[:1]), 1):
                draw(form, f"branches-{count}", FORMS_DESIGN)
        else:
            draw(exact_shape(Design.from_dict(shown[name])), name, name)
        print(name, flush=True)


def fabrics() -> None:
    """fabric-even.png and fabric-grain.png: the tube on two fabrics of the same mean modulus."""
    even = designs.load("tube").to_dict()
    modulus, root = even["fabric"]["modulus_mpa"], np.sqrt(2.5)
    grain = even["fabric"] | {"modulus_mpa": [modulus * root, modulus / root], "grain_deg": 0.0}
    for name, fabric in (("even", even["fabric"]), ("grain", grain)):
        design = Design.from_dict(even | {"fabric": fabric})
        draw(exact_shape(design, near=preview(design)), f"fabric-{name}", "tube")


def verified() -> None:
    """verified.png: the exact dome, its preview, and one in the other, seen from the same place."""
    design = designs.load("dome")
    plan = layout(design)
    comparison = compare_shapes(exact_shape(design), preview(design), plan, symmetries(design, plan))
    views = comparison_views(comparison)
    images = [Image.open(BytesIO(png(views[name][0]))).convert("RGB") for name in ("exact", "preview", "overlaid")]
    gap, height = 30, max(image.height for image in images)
    sheet = Image.new("RGB", (sum(image.width + gap for image in images) - gap, height), "white")
    left = 0
    for image in images:
        sheet.paste(image, (left, height - image.height))
        left += image.width + gap
    sheet.thumbnail((1400, 1400))
    write_file(PICTURES / "verified.png", small_png(sheet))
    print(f"{comparison.rms_percent:.2f} % of the diameter")


def contact() -> None:
    """contact.png: a tube of thin stars, which rolls up further than round, cut across without and with contact."""
    figure = Figure(figsize=(10.0, 5.0), dpi=100, facecolor="white")
    FigureCanvasAgg(figure)
    data = designs.load("tube").to_dict()
    data["stars"]["thickness_mm"] = 0.3
    for axes, has_contact in zip(figure.subplots(1, 2), (False, True), strict=True):
        data["solver"]["contact"] = has_contact
        shape = exact_shape(Design.from_dict(data)).aligned()
        title = "with contact" if has_contact else "without contact"
        print(f"{title}: {shape.summary['self_intersections']} pairs of triangles through each other", flush=True)
        cut = surface_cut(shape.positions, shape.triangles, 0, 0.0)[:, :, 1:]
        cut -= (cut.min(axis=(0, 1)) + cut.max(axis=(0, 1))) / 2
        reach = 1.05 * float(np.abs(cut).max())
        axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", title=title)
        axes.set_axis_off()
        # the fabric as thick as it is
        width = 72.0 * axes.get_window_extent().height / figure.dpi / (2.0 * reach) * data["fabric"]["thickness_mm"]
        axes.add_collection(LineCollection(list(cut), linewidths=width, colors="#9d4b36", capstyle="round"))
    large = BytesIO()
    figure.savefig(large, format="png")
    write_file(PICTURES / "contact.png", small_png(Image.open(large)))


def export(*names: str) -> None:
    """Pages of layout.pdf, as `asterism export` writes it for the paper's printer."""
    for name in names or EXPORTED:
        design, page = EXPORTED[name]
        with tempfile.TemporaryDirectory() as folder:
            write_export(
                prepare(designs.load(design), load_printer("ultimaker2"), load_plastic("tpu95a")), Path(folder)
            )
            document = pypdfium2.PdfDocument(Path(folder) / "layout.pdf")
            image = document[page].render(scale=1.2).to_pil().convert("RGB")
            document.close()
        write_file(PICTURES / f"{name}.png", small_png(image))
        print(name, flush=True)
