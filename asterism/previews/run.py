"""`asterism.preview`: from a design to its homogenised shape."""

from __future__ import annotations

import time
from dataclasses import replace

from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.session import Preview, Say
from asterism.shape.shape import Shape
from fem.search.sides import Side
from homogenize.law.law import Law
from pattern.design.design import Design
from pattern.layout.layout import Layout


def preview(
    design: Design,
    law: Law | None = None,
    side: Side = "auto",
    say: Say | None = None,
    model: PreviewModel = PREVIEW_MODEL,
    plan: Layout | None = None,
) -> Shape:
    """The homogenised shape of a design, with its stars' bumps.

    Parameters
    ----------
    design : from `load_design`, `new` or `Design.from_dict`.
    law : from `homogenize.law.law_file.load_law`; that of the paper's material by default.
    side : to which the edges go: `down`, with the plastic outside, or `up`; `auto` leaves it to the stars.
    say : called with a line of text when something begins.
    model : constants of the preview model.
    plan : layout of the design, if it is there already.

    Returns
    -------
    The shape; `summary` says whether it is a minimum, names stars outside the law's range, and holds the whole design.
    A free sheet lies with its principal axes along x, y and z. `point_fields["bump_mm"]` leads from the shell's smooth
    surface to the bumpy one.

    Raises
    ------
    DesignError, MeshError, LawError
        As for `Preview`, which keeps its state for further edits.
    """
    begin = time.perf_counter()
    shape = Preview(design, law, side, say=say, model=model, plan=plan).shape()
    return replace(shape, summary=shape.summary | {"wall_s": time.perf_counter() - begin})
