"""The option `--edge` of a preview: a length, or the limit of an infinitely fine mesh."""

from __future__ import annotations

from asterism.cli.common.mistake import Mistake

IN_THE_LIMIT = "limit"


def asked_edge(text: str) -> float:
    """mm; 0 for the limit.

    Raises
    ------
    Mistake
        The text is neither a length nor `limit`.
    """
    if text == IN_THE_LIMIT:
        return 0.0
    try:
        edge = float(text)
    except ValueError:
        edge = -1.0
    if not 0.2 <= edge <= 100.0:
        raise Mistake(f"--edge: {text!r} must be a length from 0.2 to 100 mm, or {IN_THE_LIMIT}")
    return edge
