"""Why a motif has no law, with the field of the design file."""

from __future__ import annotations

from asterism.pattern.design.leading_field import leading_field


def problem_of_motif(problem: str) -> str:
    """The problem of a cell after the field that it is about: its own, or that of the motif.

    Examples
    --------
    >>> problem_of_motif("the motif has no law of one cell")
    'rods.motif: the motif has no law of one cell'
    >>> problem_of_motif("rods: motif[0] has a piece of 0.50 mm at [1.00, 0.00]: 1 or more")
    'rods: motif[0] has a piece of 0.50 mm at [1.00, 0.00]: 1 or more'
    """
    return problem if leading_field(problem) else f"rods.motif: {problem}"
