"""Exact shapes of designs, kept in a folder: they take most of the time. Finished ones are not computed again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import Symmetry, symmetries
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.session import preview
from asterism.reports.write_results import write_results
from asterism.shape.comparison import Comparison, compare_shapes
from asterism.shape.measures import CellMean
from asterism.shape.shape import Shape
from asterism.shape.vtu import read_shape
from asterism.verification.verify import right_shape

NEAR, RELEASED, FINE = "near", "released", "fine"


@dataclass(frozen=True)
class Solved:
    """The exact shapes of a design, in a folder of its name below `folder`.

    Attributes
    ----------
    design : what is solved.
    folder : that of all designs.
    """

    design: Design
    folder: Path

    def has(self, start: str) -> bool:
        """Whether the shape of a start, `near`, `released` or `fine`, is there."""
        return (self.folder / self.design.name / start / "summary.json").exists()

    def near(self) -> Shape:
        """From the preview, at the design's tolerance."""
        return self._kept(NEAR, lambda: exact_shape(self.design, near=preview(self.design)))

    def released(self) -> Shape:
        """From the flat print, at the design's tolerance."""
        return self._kept(RELEASED, lambda: exact_shape(self.design))

    def fine(self) -> Shape:
        """From `near`, with four times the vertices."""

        def solve() -> Shape:
            near = self.near()
            return exact_shape(self.design, near=near, edge_mm=0.5 * near.summary["edge_mm"])

        return self._kept(FINE, solve)

    @cached_property
    def right(self) -> Shape:
        """The one that counts: the lower of `near` and, if it is there, `released`."""
        both = {NEAR: self.near(), **({RELEASED: self.released()} if self.has(RELEASED) else {})}
        return both[right_shape(both)]

    def compared(self, model: PreviewModel = PREVIEW_MODEL) -> Comparison:
        """The preview of a model with the shape that counts."""
        return self.distance(preview(self.design, model=model))

    def distance(self, shape: Shape, exact: Shape | None = None) -> Comparison:
        """A shape with an exact one, by default the one that counts."""
        pull = self.design.gravity.pull
        return compare_shapes(exact or self.right, shape, self._plan, self._symmetries, pull, self._mean)

    @cached_property
    def _plan(self) -> Layout:
        return layout(self.design)

    @cached_property
    def _symmetries(self) -> list[Symmetry]:
        return symmetries(self.design, self._plan)

    @cached_property
    def _mean(self) -> CellMean:
        return CellMean(self.right.printed, self.right.weights, self._plan.lattice_vectors)

    def _kept(self, start: str, solve: Callable[[], Shape]) -> Shape:
        here = self.folder / self.design.name / start
        if self.has(start):
            shape = read_shape(here)
            if shape.summary.get("design") == self.design.to_dict():
                return shape
        shape = solve()
        write_results(shape, here)
        return shape
