"""The steps on the way to an equilibrium, and their effort."""

from __future__ import annotations

from dataclasses import dataclass, field

from asterism.equilibrium.clock import Clock
from asterism.equilibrium.newton.minimise import NewtonResult


@dataclass(frozen=True)
class PathStep:
    """One step of the continuation; a summary has an entry with these names for each step.

    Attributes
    ----------
    step : 0 during the release of the fabric; later the `step` of the pins that take hold.
    release : released part of the stretch, 0 to 1.
    moved : part of their way that the pins have moved, 0 to 1.
    vertices : number of vertices of the mesh.
    energy_n_mm : energy at the end of the step.
    iterations : number of Newton iterations, those after kicks included.
    kicks : number of times that the state had become unstable and was moved along its negative mode.
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
    """Effort so far: numbers of iterations and factorisations, seconds by stage (`clock`), and the steps taken."""

    iterations: int = 0
    factorisations: int = 0
    clock: Clock = field(default_factory=Clock)
    path: list[PathStep] = field(default_factory=list)

    def add(self, result: NewtonResult) -> None:
        """Add the iterations and factorisations of a minimisation."""
        self.iterations += result.iterations
        self.factorisations += result.factorisations
