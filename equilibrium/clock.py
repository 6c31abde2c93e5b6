"""Wall time by named part of a computation."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
Value = TypeVar("Value")


class Clock:
    """Wall time of the calls made through it, summed by part.

    Attributes
    ----------
    seconds : wall time by part.

    Examples
    --------
    >>> clock = Clock()
    >>> clock("sum", sum, [1, 2, 3])
    6
    >>> list(clock.seconds)
    ['sum']
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    def __call__(self, part: str, function: Callable[P, Value], *args: P.args, **kwargs: P.kwargs) -> Value:
        """Call `function` with the arguments and add its wall time to `part`."""
        start = time.perf_counter()
        try:
            return function(*args, **kwargs)
        finally:
            self.seconds[part] = self.seconds.get(part, 0.0) + time.perf_counter() - start
