"""Consent to computations that take long or need much memory."""

from __future__ import annotations

import sys

import typer

from asterism.cli.common.mistake import Mistake
from asterism.exact.cost import Cost

# larger computations need --yes, or an answer on the terminal
MAX_SECONDS_UNASKED = 300.0
MAX_MEMORY_UNASKED_MB = 4000.0


def is_large(cost: Cost) -> bool:
    """Whether a computation needs consent."""
    return cost.seconds > MAX_SECONDS_UNASKED or cost.memory_mb > MAX_MEMORY_UNASKED_MB


def ask(cost: Cost) -> None:
    """Ask on the terminal whether to begin.

    Raises
    ------
    Mistake
        There is no terminal; the message names the option that consents.
    typer.Abort
        The answer is no.
    """
    question = f"takes about {cost.in_words()}"
    if not (sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty()):
        raise Mistake(f"{question}: use --yes to compute it, or {cost.cheaper}")
    typer.confirm(f"{question}: compute it?", abort=True, err=True)
