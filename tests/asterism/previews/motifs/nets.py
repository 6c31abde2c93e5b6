"""Designs with the motif of a net, and laws of made-up cells."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from asterism.homogenize.law.motif_law import MotifLaw
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews.law_choice import serving_law
from tests.homogenize.motif_laws import made_up

CROSS = [{"line_mm": [(5, 5), (15, 5)]}, {"line_mm": [(5, 5), (5, 15)]}]
GRADED = {"profile": "linear", "from": 0.4, "to": 0.5, "start_mm": [-20.0, 0.0], "end_mm": [20.0, 0.0]}


def net(thickness: object = 0.4, **sections: Any) -> Design:
    return Design.from_dict(
        {
            "name": "net",
            "rods": {"motif": CROSS, "thickness_mm": thickness},
            "lattice": {"kind": "square", "spacing_mm": 10.0},
            "border": {"rectangle_mm": (40.0, 40.0)},
            "mesh": {"edge_mm": 4.0},
        }
        | sections
    )


def net_law(design: Design, known: MotifLaw | None = None, say: Callable[[str], None] = lambda text: None) -> MotifLaw:
    law = serving_law(design, layout(design), known, say, made_up)
    assert isinstance(law, MotifLaw)
    return law
