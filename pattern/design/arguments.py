"""Checks of arguments."""

from __future__ import annotations

from typing import Any


def check_type(given: Any, kind: type, hint: str) -> None:
    """Raise `TypeError` unless `given` is of the type `kind`; `hint` names where one comes from."""
    if not isinstance(given, kind):
        raise TypeError(f"a {kind.__name__} is needed, not {type(given).__name__}: {hint}")
