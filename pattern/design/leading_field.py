"""The field of the design file with which a message begins."""

from __future__ import annotations

import re

from asterism.pattern.design.design import Design

_FIELD = re.compile(r"(\w+)(?:\.\w+|\[\d+\])*(?= = |: )")


def leading_field(message: str) -> str:
    """The field that a message names before all else; empty if it names none.

    Examples
    --------
    >>> leading_field("rods.motif[0].width_mm = 9: must be at most 5")
    'rods.motif[0].width_mm'
    >>> leading_field("the motif has no law of one cell: 2 x 2 cells relax to 90 % of its energy")
    ''
    """
    found = _FIELD.match(message)
    return found[0] if found and found[1] in Design.model_fields else ""
