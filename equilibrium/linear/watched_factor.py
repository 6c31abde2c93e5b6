"""A factorisation that calls a function before all of its work, so that a long search can be watched and stopped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor


@dataclass
class WatchedFactor:
    """Calls `watch` before each factorisation and solution of another factor; an error of `watch` ends the search.

    Every Newton iteration solves at least once.
    """

    factor: Factor
    watch: Callable[[], None]

    def __post_init__(self) -> None:
        self.name = self.factor.name

    def factorise(self, data: Floats) -> bool:
        """See `Factor.factorise`."""
        self.watch()
        return self.factor.factorise(data)

    def solve(self, b: Floats) -> Floats:
        """See `Factor.solve`."""
        self.watch()
        return self.factor.solve(b)

    def close(self) -> None:
        """Free the memory."""
        self.factor.close()
