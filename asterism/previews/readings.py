"""Read access to a preview: the parts of its state, and the positions of printed points."""

from __future__ import annotations

from typing import Any

from asterism.equilibrium.arrays import Floats
from asterism.fem.search.evidence import ShellEquilibrium
from asterism.fem.search.mean_fields import Side
from asterism.fem.shell.shell import Shell
from asterism.pattern.design.design import Design
from asterism.pattern.layout.symmetries import Symmetry
from asterism.previews.kinds import kind_of
from asterism.previews.point_lens import PointLens, checked_points, checked_positions
from asterism.previews.state import AnyPreviewState
from asterism.previews.surface.places import Places
from asterism.previews.uncertainty.other_forms import OtherForm, forms_met


class PreviewReadings:
    """The part of a preview that reads its state and does not change it.

    Attributes
    ----------
    state : all results, as one frozen value; an edit replaces it as a whole.
    """

    state: AnyPreviewState

    @property
    def design(self) -> Design:
        """The current design."""
        return self.state.design

    @property
    def law(self) -> Any:
        """The law of the material, a `Law`; for a motif its `MotifLaw`."""
        return self.state.law

    @property
    def side(self) -> Side:
        """The requested side of the edges."""
        return self.state.side

    @property
    def sheet(self) -> Any:
        """The printed sheet and its mesh: a `PrintSheet`, for stars a `Sheet`."""
        return self.state.sheet

    @property
    def values(self) -> Any:
        """The law at the stars of the design, `StarValues`; for a motif `MotifFieldValues`."""
        return self.state.values

    @property
    def shell(self) -> Shell:
        """The shell with all supports."""
        return self.state.shell

    @property
    def equilibrium(self) -> ShellEquilibrium:
        """The state of the shell with its certificate."""
        return self.state.equilibrium

    @property
    def symmetries(self) -> list[Symmetry]:
        """Motions of the print that map the design to itself."""
        return self.state.symmetries

    @property
    def forms(self) -> list[OtherForm]:
        """Other minima of the last search, the lowest one first; `Preview.show_form` shows one of them."""
        return [form for form, _ in forms_met(self.state)]

    def at(self, points: Floats, x: Floats | None = None) -> Places:
        """The positions of printed points in space.

        They are in the pose of the shell, whereas `Preview.shape` turns free sheets upright.

        Parameters
        ----------
        points : (n, 2) mm, or a single point.
        x : degrees of freedom of the shell, from a `Stage`; those of the equilibrium by default.

        Raises
        ------
        ValueError
            `points` has another form, or a point is outside of the sheet, or x does not belong to this mesh.
        """
        state = self.state
        points, x = checked_points(points), checked_positions(x, state)
        return kind_of(state.design).lens(state, points)(x, state.values)

    def lens(self, points: Floats) -> PointLens:
        """A function that computes the positions of fixed printed points (n, 2) mm, like `at`, but faster.

        Raises
        ------
        ValueError
            `points` has another form, or a point is outside of the sheet.

        Examples
        --------
        >>> from asterism.previews.session import Preview
        >>> from asterism.pattern import gallery
        >>> lens = Preview(gallery.load("star")).lens([[0.0, 0.0], [3.0, 0.0]])
        >>> lens().bumpy.shape
        (2, 3)
        """
        return PointLens(lambda: self.state, points)
