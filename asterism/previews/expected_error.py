"""The estimated error of a preview: nine of ten exact shapes of its kind of sheet were found within it.

The kinds differ by how a sheet is held and by its number of stars. The numbers are measured
(`python -m benchmarks.accuracy`), and nothing is computed from the sheet itself: the exact model, a second later, is
the answer. Heights differ by a share of the diameter, also on sheets that are nearly flat.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from asterism.previews.state import PreviewState


class ExpectedError(NamedTuple):
    """In % of the diameter; nine of ten exact shapes are nearer.

    Attributes
    ----------
    distance : rms distance to the exact shape.
    height : difference of the heights.
    """

    distance: float
    height: float


# without supports that act along the print
FREE = ExpectedError(4.0, 3.3)
# held, and under weight
HEAVY = ExpectedError(5.0, 6.0)
# held, of at most FEW_STARS, and of more
HELD_FEW = ExpectedError(5.0, 3.0)
HELD_MANY = ExpectedError(1.3, 2.1)
FEW_STARS = 24
# motifs of drawn rods, free or held: nets roll up about another axis than their previews, or hardly
MOTIF = ExpectedError(17.0, 5.5)
# share of the stars or rods: with more of them unlike those of the measured sheets, nothing is stated
MAX_FOREIGN_SHARE = 0.1


def expected_error(state: PreviewState) -> ExpectedError | None:
    """The estimated error of a state; None with many stars or rods that its law does not describe.

    A sheet that slides on all of its supports counts as free.

    Examples
    --------
    >>> from asterism.pattern import gallery
    >>> from asterism.previews.session import Preview
    >>> expected_error(Preview(gallery.load("dome")).state) is HELD_MANY
    True
    """
    layout, values = state.layout, state.sheet.values
    if not layout.has_stars:
        return MOTIF if len(values.outside) <= MAX_FOREIGN_SHARE * values.places else None
    inverted = int(np.count_nonzero(layout.star_branch < 0))
    stars = len(layout.centres)
    if max(len(values.outside), len(values.strongly_anisotropic), inverted) > MAX_FOREIGN_SHARE * stars:
        return None
    if not state.is_supported:
        return FREE
    if state.design.gravity.on:
        return HEAVY
    return HELD_FEW if stars <= FEW_STARS else HELD_MANY
