"""`asterism.preview`: the fast, homogenised shape of a design."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

from asterism.fem.search.mean_fields import Side
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.session import Preview
from asterism.process.listeners import Say
from asterism.shape.shape import Shape


def preview(
    design: Design,
    law: Law[Any] | None = None,
    side: Side = "auto",
    say: Say | None = None,
    model: PreviewModel = PREVIEW_MODEL,
    plan: Layout | None = None,
) -> Shape:
    """Compute the homogenised shape of a design: with the bumps of its stars, or with the rods of its motif.

    Parameters
    ----------
    design : from `load_design`, `new` or `Design.from_dict`.
    law : from `homogenize.law.law_file.load_law`; by default the one that the design names, or else that of the paper's
        material where it covers the stars, or else one of cells that are solved now and kept.
    side : side of the edges: `down` (plastic outside), `up`, or `auto`, which follows from the stars.
    say : called with a line of text at the beginning of each stage.
    model : constants of the preview model.
    plan : layout of the design; computed by default.

    Returns
    -------
    The shape. Its `summary` holds the certificate (`is_minimum`), the stars outside the range of the law, the estimated
    error, and the whole design. The principal axes of a free sheet lie along x, y and z. `point_fields["bump_mm"]`
    holds the vectors from the smooth surface to the shape.

    Raises
    ------
    DesignError, MeshError, LawError
        As for `Preview`, which keeps its state for edits.
    """
    begin = time.perf_counter()
    shape = Preview(design, law, side, say=say, model=model, plan=plan).shape()
    return replace(shape, summary=shape.summary | {"wall_s": time.perf_counter() - begin})
