"""What a preview does differently for each kind of pattern: law, values, sheet, positions, shape and summary.

`asterism.previews.kinds.kind_of` gives the kind of a design. All else, from supports to search, is common to all kinds.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from typing import Any

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh
from asterism.previews.model import PreviewModel
from asterism.previews.places import Places, SheetLens, ShownSheet
from asterism.previews.print_sheet import PrintSheet
from asterism.previews.state import AnyPreviewState
from asterism.process.listeners import Say
from asterism.results.records.preview import PreviewRecord
from asterism.shape.shape import Shape


class PatternKind(ABC):
    """A kind of pattern that has previews."""

    @abstractmethod
    def layout(self, design: Design) -> Layout:
        """The layout of a design, with pins that can carry its weight.

        Raises
        ------
        DesignError
            The design cannot be printed, or has no preview.
        """

    @abstractmethod
    def default_law(self, design: Design, plan: Layout, known: Any, say: Say) -> Any:
        """The law of a preview to which none is given.

        Parameters
        ----------
        known : law of the preview before an edit, or None.
        say : called with a line if the law takes long.

        Raises
        ------
        LawError
            No law serves.
        """

    @abstractmethod
    def check_law(self, law: Any) -> None:
        """Refuse objects that are not laws of this kind with a `TypeError`."""

    @abstractmethod
    def values(self, design: Design, plan: Layout, law: Any, model: PreviewModel) -> Any:
        """The law at the stars, or at the sizes of the sheet's rods.

        Raises
        ------
        LawError
            The law is for another material, or its values are impossible for a sheet.
        """

    @abstractmethod
    def sheet(self, design: Design, plan: Layout, triangles: int | None, model: PreviewModel) -> PrintSheet:
        """The printed sheet and its mesh of about a number of triangles."""

    @abstractmethod
    def size_in_words(self, plan: Layout) -> str:
        """How many stars or rods there are, for messages."""

    @abstractmethod
    def lens(self, state: AnyPreviewState, points: Floats) -> SheetLens:
        """Computes the positions of printed points (n, 2) mm on a state's sheet."""

    @abstractmethod
    def shown_mesh(self, sheet: Any) -> Mesh:
        """Triangles of the shape, with the rods along their edges."""

    @abstractmethod
    def shape(self, sheet: Any, mesh: Mesh, places: Places) -> Shape:
        """The shape without a summary."""

    @abstractmethod
    def summary(
        self, state: AnyPreviewState, shape: Shape, mesh: Mesh, up: Floats, clock: Clock, seconds: dict[str, float]
    ) -> PreviewRecord:
        """The record of a shape.

        Parameters
        ----------
        up : (3,) unit vector, z of the shape in the pose of the shell.
        """

    def with_shown_sheet(self, state: AnyPreviewState, clock: Clock) -> AnyPreviewState:
        """The state with triangles to show."""
        if state.shown is not None:
            return state
        with clock("shown"):
            mesh = self.shown_mesh(state.sheet)
            lens = self.lens(state, mesh.points)
        return replace(state, shown=ShownSheet(mesh, lens))
