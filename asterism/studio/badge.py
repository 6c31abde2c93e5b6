"""The one statement about the shape that pages show; whatever speaks of it takes it from here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from asterism.results.words import shape_in_words


@dataclass(frozen=True)
class Situation:
    """What is known of the shown shape.

    Attributes
    ----------
    revision : of the document.
    shape_revision : of the design that the shape is of; None without a shape.
    stage : of its last frame.
    is_minimum : whether it is certified.
    numbers : of its summary; empty until there is one.
    is_at_work : whether a newer shape is on its way.
    """

    revision: int
    shape_revision: int | None = None
    stage: str | None = None
    is_minimum: bool = False
    numbers: Mapping[str, Any] | None = None
    is_at_work: bool = False


def badge(now: Situation) -> dict[str, Any]:
    """The state of the shape, the worst statement first: its kind, its words, and the frame that it is about.

    Examples
    --------
    >>> badge(Situation(3, 3, "equilibrium", True, {"expected_rms_percent": 1.5}))["words"]
    'Preview, about 1.5 %'
    >>> badge(Situation(4, 3, "exact", True, {"mesh_error_percent": 0.7}))["words"]
    'Outdated'
    >>> badge(Situation(4, 3, "exact", True, {"mesh_error_percent": 0.7}, is_at_work=True))["words"]
    'Computing'
    """
    is_current = now.shape_revision == now.revision
    has_shape = is_current and now.stage in ("equilibrium", "exact")
    if not has_shape and now.is_at_work:
        kind, words = "computing", "Computing"
    elif now.stage == "printed" or now.shape_revision is None:
        kind, words = "none", "Not computed"
    elif not has_shape:
        kind, words = "outdated", "Outdated"
    else:
        model = "exact" if now.stage == "exact" else "preview"
        words = shape_in_words({**(now.numbers or {}), "model": model, "is_minimum": now.is_minimum})
        kind = model if now.is_minimum else "doubtful"
    return {
        "kind": kind,
        "words": words,
        "revision": now.shape_revision,
        "stage": now.stage,
        "is_stale": now.shape_revision is not None and not is_current,
    }
