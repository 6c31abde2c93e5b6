"""Fixed printed points on the sheet of a preview, followed over edits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.previews.kinds import kind_of
from asterism.previews.places import Places, SheetLens
from asterism.previews.state import AnyPreviewState


class PointLens:
    """Takes the stages of a preview to printed points; `Preview.lens` makes one.

    After an edit that keeps the print, only what depends on the changed stars is computed again.

    Parameters
    ----------
    state : gives the preview's state.
    points : (n, 2) mm, on the sheet.

    Attributes
    ----------
    points : as given.

    Raises
    ------
    ValueError
        These are no points, or one is off the sheet.
    """

    def __init__(self, state: Callable[[], AnyPreviewState], points: Floats) -> None:
        self.points = checked_points(points)
        self._state = state
        self._lens = self._new_lens(state())

    def __call__(self, x: Floats | None = None) -> Places:
        """The points in space, at positions `x` of a stage or else in the state that the preview shows.

        Raises
        ------
        ValueError
            `x` is not of a stage of the present design; or a point is off the sheet since its outline has changed.
        """
        state = self._state()
        x = checked_positions(x, state)
        if state.sheet.space is self._lens.sheet.space:
            self._lens = self._lens.renewed(state.sheet)
        else:
            self._lens = self._new_lens(state)
        return self._lens(x, state.values)

    def _new_lens(self, state: AnyPreviewState) -> SheetLens:
        return kind_of(state.design).lens(state, self.points)


def checked_points(points: Floats) -> Floats:
    """(n, 2) of points or a single one."""
    points = np.atleast_2d(np.asarray(points, dtype=float))
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise ValueError(f"points must be finite pairs of mm on the print, shape (n, 2), got shape {points.shape}")
    return points


def checked_positions(x: Floats | None, state: AnyPreviewState) -> Floats:
    """(N, 3) positions of the shell's dofs; by default those that the state shows."""
    x = state.x if x is None else np.asarray(x, dtype=float)
    if x.shape != state.x.shape:
        raise ValueError(f"x must be a stage's, shape {state.x.shape}, got shape {x.shape}")
    return x
