"""Supervision of a search: a function of the caller, and a time limit."""

from __future__ import annotations

import time
from collections.abc import Callable

from asterism.equilibrium.errors import Error


class SearchLimitError(Error):
    """A search takes longer than its time limit. The preview keeps its state before the search."""

    exit_status = 1


class Watch:
    """Called at least once in each Newton iteration.

    Parameters
    ----------
    check : called each time; an error that it raises ends the search.
    max_seconds : wall time after which a search ends with `SearchLimitError`.

    Attributes
    ----------
    has_stopped : whether the watch has ended the current search.
    """

    def __init__(self, check: Callable[[], None] | None = None, max_seconds: float | None = None) -> None:
        if max_seconds is not None and not max_seconds > 0.0:
            raise ValueError(f"max_seconds = {max_seconds!r}: must be above 0")
        self._check, self._max_seconds = check, max_seconds
        self.begin()

    def begin(self) -> None:
        """Start the clock of a search."""
        self._begun = time.perf_counter()
        self.has_stopped = False

    def __call__(self) -> None:
        """Call the check, and raise SearchLimitError after the time limit."""
        try:
            if self._check is not None:
                self._check()
            if self._max_seconds is not None and time.perf_counter() - self._begun > self._max_seconds:
                raise SearchLimitError(f"no equilibrium within {self._max_seconds:g} s; the shape is that before it")
        except BaseException:
            self.has_stopped = True
            raise
