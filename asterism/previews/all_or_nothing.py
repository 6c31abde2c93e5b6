"""Changes that are made as a whole, or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def all_or_nothing(*things: object) -> Iterator[None]:
    """Give the things back the attributes they had, unless the block comes to its end.

    For attributes that are replaced, not changed within.
    """
    before = [dict(vars(thing)) for thing in things]
    try:
        yield
    except BaseException:
        for thing, attributes in zip(things, before, strict=True):
            vars(thing).clear()
            vars(thing).update(attributes)
        raise
