"""What one reads off a preview: its state by parts, and printed points in space."""

from __future__ import annotations

from asterism.previews.fields.star_values import StarValues
from asterism.previews.point_lens import PointLens, checked_points, checked_positions
from asterism.previews.sheet import Sheet
from asterism.previews.state import PreviewState
from asterism.previews.surface.surface import Lens, Places
from asterism.previews.uncertainty.other_forms import OtherForm, forms_met
from fem.elements.tabulation import Floats
from fem.search.evidence import ShellEquilibrium
from fem.search.sides import Side
from fem.shell.shell import Shell
from homogenize.law.law import Law
from pattern.design.design import Design
from pattern.layout.symmetries import Symmetry


class PreviewReadings:
    """A preview as far as it only shows its state.

    Attributes
    ----------
    state : all that was computed, a frozen value; edits replace it as a whole.
    """

    state: PreviewState

    @property
    def design(self) -> Design:
        """As given, or as edited since."""
        return self.state.design

    @property
    def law(self) -> Law:
        """As given."""
        return self.state.law

    @property
    def side(self) -> Side:
        """To which the edges were asked to go."""
        return self.state.side

    @property
    def sheet(self) -> Sheet:
        """The print and its mesh."""
        return self.state.sheet

    @property
    def values(self) -> StarValues:
        """The law at the design's stars."""
        return self.state.values

    @property
    def shell(self) -> Shell:
        """The shell with all supports."""
        return self.state.shell

    @property
    def equilibrium(self) -> ShellEquilibrium:
        """The state of the shell with its evidence."""
        return self.state.equilibrium

    @property
    def symmetries(self) -> list[Symmetry]:
        """Motions of the print that map the design to itself."""
        return self.state.symmetries

    @property
    def forms(self) -> list[OtherForm]:
        """Other minima that the last search has met, the lowest one first; `Preview.show_form` goes to one of them."""
        return [form for form, _ in forms_met(self.state)]

    def at(self, points: Floats, x: Floats | None = None) -> Places:
        """Printed points (n, 2) mm, or a single one, in space; `x` of a stage in place of the equilibrium.

        In the pose of the shell: free sheets of `shape` are turned upright.

        Raises
        ------
        ValueError
            These are no points, or one is off the sheet; x is not of a stage.
        """
        state = self.state
        points, x = checked_points(points), checked_positions(x, state)
        return Lens(state.sheet, state.law.waves, points)(x, state.values)

    def lens(self, points: Floats) -> PointLens:
        """Printed points (n, 2) mm, followed over edits: it takes stages to places as `at` does, and faster.

        Raises
        ------
        ValueError
            These are no points, or one is off the sheet.

        Examples
        --------
        >>> from asterism.previews.session import Preview
        >>> from pattern import gallery
        >>> lens = Preview(gallery.load("star")).lens([[0.0, 0.0], [3.0, 0.0]])
        >>> lens().bumpy.shape
        (2, 3)
        """
        return PointLens(lambda: self.state, points)
