"""The middle lines of drawn rods as a drawing, for other programs and for `[[rods.import]]`."""

from __future__ import annotations

import re

import numpy as np

from asterism.print.drawing import Drawing, DrawingLayer, Polyline
from asterism.print.job import Job
from asterism.print.layers import RODS

# characters that names of layers cannot have in DXF
_NOT_IN_DXF = re.compile(r'[<>/\\":;?*=`|,\x00-\x1f]')


def middle_lines(job: Job) -> Drawing:
    """The rods of the printed design in printed coordinates: a layer for each name and width, lines as wide as rods.

    A rod whose width varies has its mean width. The page is the box around the cut lines.
    """
    rods = job.plan.drawn_rods
    widths: dict[str, set[float]] = {}
    keys = [(_NOT_IN_DXF.sub("_", rod.name), round(float(rod.width.mean()), 3)) for rod in rods]
    for name, width in keys:
        widths.setdefault(name, set()).add(width)
    layers = {
        (name, width): DrawingLayer(
            name if len(widths[name]) == 1 else f"{name} {width:g}", RODS.colour, width, is_printed_width=True
        )
        for name, width in dict.fromkeys(keys)
    }
    items = []
    for rod, key in zip(rods, keys, strict=True):
        closed = rod.start == rod.end
        items.append(Polyline(layers[key], rod.points[:-1] if closed else rod.points, closed=closed))
    everything = np.concatenate(job.cut)
    return Drawing(f"{job.design.name}: middle lines", everything.min(axis=0), everything.max(axis=0), tuple(items))
