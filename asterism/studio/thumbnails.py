"""Small plans of the last states of a document, to choose one from."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.pattern.layout.layout import Layout
from asterism.studio.history import History

MAX_THUMBNAILS = 30
THUMBNAIL_DIGITS = 2


class Thumbnails:
    """Outline, places and sizes of the stars, by the revision of a state."""

    def __init__(self) -> None:
        self._plans: dict[int, dict[str, Any]] = {}

    def add(self, revision: int, layout: Layout) -> None:
        """Keep the plan of a state; the oldest ones are forgotten."""
        self._plans.pop(revision, None)
        self._plans[revision] = {
            "outline_mm": _rounded(layout.outline),
            "at_mm": _rounded(layout.lattice.place(layout.sheet_sites)),
            "sizes_mm": _rounded(layout.site_sizes_mm),
        }
        for old in list(self._plans)[:-MAX_THUMBNAILS]:
            del self._plans[old]

    def data(self, history: History) -> list[dict[str, Any]]:
        """The states of a history that have a plan, oldest first: position, revision, label, plan (mm)."""
        return [
            {
                "position": position,
                "revision": step.revision,
                "label": step.label,
                "is_shown": position == history.position,
                **self._plans[step.revision],
            }
            for position, step in enumerate(history.steps)
            if step.revision in self._plans
        ]


def _rounded(values: Any) -> list[Any]:
    plain: list[Any] = np.round(np.asarray(values, dtype=float), THUMBNAIL_DIGITS).tolist()
    return plain
