"""What an exact shape costs, estimated from its design before anything is computed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout, mesh_vertices, sheet_outline


@dataclass(frozen=True)
class Cost:
    """An estimate: number of vertices, peak memory in MB, and wall time in seconds."""

    vertices: int
    memory_mb: float
    seconds: float
    # what costs less, for the question whether to compute it
    cheaper: ClassVar[str] = "a larger mesh.edge_mm"

    def in_words(self) -> str:
        """One phrase.

        >>> Cost(58381, 1338.4, 25.3).in_words(), Cost(400000, 8000.0, 1189.0).in_words()
        ('58381 vertices, 1.3 GB, 25 s', '400000 vertices, 8.0 GB, 20 min')
        """
        return f"{self.vertices} vertices, {self.memory_mb / 1000:.1f} GB, {self.time_in_words}"

    @property
    def time_in_words(self) -> str:
        """The time in seconds or minutes."""
        return f"{self.seconds:.0f} s" if self.seconds < 100 else f"{self.seconds / 60:.0f} min"


def exact_cost(design: Design, starts: int = 1, shapes: int = 1) -> Cost:
    """The cost of exact shapes of a design on the mesh that it asks for.

    Parameters
    ----------
    starts : number of initial guesses.
    shapes : number of exact shapes, one after the other; a verification computes two.

    Examples
    --------
    >>> from asterism.pattern import gallery
    >>> exact_cost(gallery.load("tube")).vertices
    3632
    """
    outline = sheet_outline(design) if design.border.rods is None else layout(design).outline
    vertices = mesh_vertices(design.usual_edge_mm, outline)
    # Fitted to python -m benchmarks.exact (1141 to 58381 vertices, two cores) and to the largest whole solve of
    # python -m benchmarks.large (294847 vertices), within a factor of two. From 58000 vertices on the factorisation
    # dominates.
    seconds = max(1.5 + 5.0 * (vertices / 10_000) ** 0.9, 25.0 * (vertices / 58_000) ** 2.0)
    if design.solver.contact:  # of sheets that meet themselves; other sheets take twice as long with contact
        seconds *= 8.0
    # a further start explores the coarse mesh, and the lowest minima are carried to the fine mesh
    seconds *= (1.0 + 0.5 * (starts - 1)) * shapes
    return Cost(round(vertices), 200.0 + 0.0195 * vertices, seconds)
