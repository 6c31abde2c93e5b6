"""Draws pictures into docs/pictures anew, and prints the numbers that pages state beside them.

python -m benchmarks.pictures KIND [NAME ...]    (names: of designs, states or pictures, for kinds that have several)

gallery: designs and patterns by both models, with the table of their page. start: small pictures of the studio's first
page. pages: designs that stand in a page's text, and two forms of one design. verified: an exact shape and its preview.
fabrics: a sheet on two fabrics. contact: a roll with and without contact. export: pages of a layout.pdf. studio: states
of the studio's page. tutorial: the canopy, step by step.
`python -m benchmarks.fit_targets FOLDER` draws the fits.
"""

from __future__ import annotations

import argparse
from importlib import import_module
from inspect import signature

# by the module that draws them: browsers are not loaded for pictures that need none
KINDS = {
    "gallery": "shapes", "start": "shapes", "pages": "shapes", "verified": "shapes", "fabrics": "shapes",
    "contact": "shapes", "export": "shapes", "studio": "studio", "tutorial": "studio",
}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.pictures")
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("names", nargs="*")
    options = parser.parse_intermixed_args()
    draw = getattr(import_module(f"benchmarks.pictures.{KINDS[options.kind]}"), options.kind)
    if options.names and not signature(draw).parameters:
        parser.error(f"NAME: {options.kind} has none")
    try:
        draw(*options.names)
    except KeyError as unknown:
        parser.error(f"NAME: {unknown} is unknown to {options.kind}")


if __name__ == "__main__":
    main()
