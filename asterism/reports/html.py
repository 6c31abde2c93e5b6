"""Building blocks of an HTML report: escaped text, tables, embedded pictures."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image

from asterism.equilibrium.arrays import Floats

STYLE = """
:root { color-scheme: light dark; --ink: #26262b; --paper: #fff; --pale: #62626a; --tile: #f4f3ef; --line: #e8e6e0;
        --good: #2a6f3c; --bad: #a3361f; --warning: #fdf3e7; }
@media screen and (prefers-color-scheme: dark) {
  :root { --ink: #e6e6ea; --paper: #1b1c20; --pale: #a4a6b0; --tile: #282a30; --line: #383a42;
          --good: #7fcf94; --bad: #f0907a; --warning: #3a2e20; }
  figure img { border-radius: 6px; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 1080px;
       margin: 2.5rem auto; padding: 0 1.5rem; }
h1 { font-size: 1.7rem; margin: 0 0 .2rem; overflow-wrap: anywhere; } h2 { font-size: 1.15rem; margin: 2.2rem 0 .6rem; }
.lead { font-size: 1.1rem; margin: 0 0 1.2rem; }
.small { color: var(--pale); font-size: .9rem; max-width: 52rem; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(9.5rem, 1fr)); gap: .8rem; margin: 1rem 0; }
.tile { background: var(--tile); border-radius: 8px; padding: .7rem .9rem; }
.tile b { display: block; font-size: 1.5rem; font-weight: 600; } .tile span { color: var(--pale); font-size: .85rem; }
.row { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(300px, 100%), 1fr)); gap: 1rem;
       align-items: end; }
figure { margin: 0; break-inside: avoid; } figure img { width: 100%; height: auto; display: block; }
figcaption { color: var(--pale); font-size: .85rem; margin-top: .3rem; }
.good { color: var(--good); } .bad { color: var(--bad); }
.warnings { background: var(--warning); border-left: 4px solid #ed7829; margin: 1rem 0; padding: .6rem 1rem; }
.warnings ul { margin: .2rem 0 0; padding-left: 1.2rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: .4rem 0; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: .22rem 1.2rem .22rem 0; border-bottom: 1px solid var(--line); vertical-align: top; }
td.n, th.n { text-align: right; } th { font-weight: 600; }
td { overflow-wrap: anywhere; } td.n, td:first-child { overflow-wrap: normal; }
@media (max-width: 600px) { th, td { padding-right: .5rem; } body { padding: 0 .8rem; } }
"""


def html_page(title: str, parts: Sequence[str], style: str = STYLE) -> str:
    """A complete HTML document without references to other files."""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{style}</style>\n</head>\n<body>\n"
        + "\n".join(parts)
        + "\n</body>\n</html>\n"
    )


def html_table(header: Sequence[str], rows: Sequence[Sequence[str]], numbers: bool = True) -> str:
    """A table. The first column is text; the others are right-aligned numbers, or text if `numbers` is false."""

    def line(cells: Sequence[str], tag: str) -> str:
        kinds = ["", *([' class="n"' if numbers else ""] * (len(cells) - 1))]
        return "<tr>" + "".join(f"<{tag}{k}>{escape(c)}</{tag}>" for k, c in zip(kinds, cells, strict=True)) + "</tr>"

    lines = [line(header, "th"), *(line(row, "td") for row in rows)]
    return '<div class="wide"><table>\n' + "\n".join(lines) + "\n</table></div>"


def design_rows(entry: Any, path: str = "", longest: int = 600) -> list[list[str]]:
    """Dotted paths and texts of all entries of a design that are not empty; lists of numbers are one entry."""
    if entry in (None, [], {}):
        return []
    if isinstance(entry, Mapping):
        inner: Iterable[tuple[Any, Any]] = entry.items()
    elif isinstance(entry, list) and isinstance(entry[0], Mapping):
        inner = enumerate(entry)
    else:
        text = json.dumps(entry, ensure_ascii=False)
        return [[path, text if len(text) <= longest else f"{text[:longest]} ... ({len(text)} characters)"]]
    return [row for key, each in inner for row in design_rows(each, f"{path}.{key}".lstrip("."), longest)]


def tiles(values: Mapping[str, str]) -> str:
    """Large numbers (the values), each with its meaning (the key) below."""
    each = (f'<div class="tile"><b>{escape(v)}</b><span>{escape(k)}</span></div>' for k, v in values.items())
    return '<div class="tiles">' + "".join(each) + "</div>"


def warnings_box(title: str, lines: Sequence[str]) -> str:
    """A box with one line each; empty without lines."""
    each = "".join(f"<li>{escape(line)}</li>" for line in lines)
    return f'<div class="warnings"><b>{escape(title)}</b><ul>{each}</ul></div>' if lines else ""


def figures(pictures: Sequence[tuple[bytes, str]]) -> str:
    """Pairs of PNG data and caption, side by side."""
    each = (
        f'<figure><img alt="{escape(caption, quote=True)}" '
        f'src="data:image/png;base64,{b64encode(data).decode()}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
        for data, caption in pictures
    )
    return '<div class="row">' + "".join(each) + "</div>"


def png(image: Floats) -> bytes:
    """PNG of an image (height, width, 4), row 0 the lowest, on white."""
    opacity = image[..., 3:]
    colour = opacity * image[..., :3] + (1.0 - opacity)
    picture = Image.fromarray(np.clip(255.0 * np.flipud(colour) + 0.5, 0, 255).astype(np.uint8))
    return small_png(picture)


def small_png(image: Image.Image) -> bytes:
    """PNG of an image in 256 colours. MAXCOVERAGE keeps colours of few pixels, such as the red of the supports."""
    out = BytesIO()
    # a step of k-means takes longer than all the rest, for colours that differ by 0.2 of 255 levels (rms)
    image.convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE).save(out, "PNG")
    return out.getvalue()
