"""What the way to an equilibrium was, and what it cost."""

from __future__ import annotations

from dataclasses import dataclass, field

from equilibrium.clock import Clock
from equilibrium.newton.minimise import NewtonResult


@dataclass(frozen=True)
class PathStep:
    """One step of the way.

    Attributes
    ----------
    step : 0 while the fabric is released; then that of the pins that take hold.
    release : how much of the stretch is let go, 0 to 1.
    moved : how much of their way the pins of this step have gone, 0 to 1.
    vertices : of the mesh.
    energy_n_mm : where it ended.
    iterations : of Newton's method, kicks included.
    kicks : times that the path had lost its stability, and was followed down to the side.
    """

    step: int
    release: float
    moved: float
    vertices: int
    energy_n_mm: float
    iterations: int
    kicks: int


@dataclass
class Effort:
    """Work done so far; `clock` has the seconds by stage."""

    iterations: int = 0
    factorisations: int = 0
    clock: Clock = field(default_factory=Clock)
    path: list[PathStep] = field(default_factory=list)

    def add(self, result: NewtonResult) -> None:
        """Count what a minimisation took."""
        self.iterations += result.iterations
        self.factorisations += result.factorisations
