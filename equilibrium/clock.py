"""Wall time by named part of a computation."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager


class Clock:
    """Wall time of blocks, summed by part.

    >>> clock = Clock()
    >>> with clock("sum"):
    ...     total = sum([1, 2, 3])
    >>> list(clock.seconds)
    ['sum']
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}  # wall time by part

    @contextmanager
    def __call__(self, part: str) -> Iterator[None]:
        """Add the wall time of the block to `part`."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[part] = self.seconds.get(part, 0.0) + time.perf_counter() - start
