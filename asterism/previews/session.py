"""A preview that stays: edits go on from the last equilibrium."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Literal, NoReturn

import numpy as np

from asterism.previews.fields.star_values import StarValues, star_values
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.readings import PreviewReadings
from asterism.previews.sheet import Sheet, sheet_of
from asterism.previews.snapshot import Snapshot
from asterism.previews.solve import (
    at_form,
    carried,
    followed,
    respond,
    restarted,
    state_from_guesses,
    state_without_search,
    with_near_zero_modes,
    with_shown_sheet,
    with_stars,
)
from asterism.previews.state import PreviewState
from asterism.previews.summary import summary
from asterism.previews.surface.surface import shape_of
from asterism.previews.uncertainty.estimate import estimate_error
from asterism.previews.uncertainty.other_forms import forms_met
from asterism.previews.watch import Watch
from asterism.shape.shape import Shape
from equilibrium.clock import Clock
from equilibrium.threads import one_blas_thread
from fem.elements.tabulation import Floats
from fem.search.mean_fields import mean_fields
from fem.search.sides import Side, check_side, side_of
from homogenize.law.law import Law
from homogenize.law.law_file import load_law
from pattern.design.arguments import check_type
from pattern.design.design import Design
from pattern.design.section import is_whole
from pattern.layout.build import layout
from pattern.layout.layout import Layout
from pattern.layout.weight_support import check_weight_is_supported

Say = Callable[[str], None]
PATIENCE_TRIANGLES = 300  # a line of text announces that a larger sheet takes long: some need hundreds of iterations
MAX_ASKED_TRIANGLES = 10_000  # many more would fill the memory
OTHER_SIDE: dict[Side, Side] = {"down": "up", "up": "down"}


@cache
def paper_law() -> Law:
    """The law that comes with the package, read once."""
    return load_law()


@dataclass(frozen=True)
class Stage:
    """A result of an edit.

    Attributes
    ----------
    name : `linear`, the linear response of the last equilibrium to the edit; or `equilibrium`.
    x : (N, 3) mm, positions of the shell's dofs; a copy.
    """

    name: Literal["linear", "equilibrium"]
    x: Floats


class Preview(PreviewReadings):
    """The homogenised shape of a design, kept ready for changes.

    Parameters
    ----------
    design : from `load_design`, `new` or `Design.from_dict`.
    law : of the design's material; the paper's by default.
    side : to which the edges go: `down`, with the plastic outside, or `up`; `auto` leaves it to the stars.
    triangles : of the shell's mesh, about, at most 10000; by default as many as the stars need.
    say : called with a line of text when something begins.
    model : constants of the preview model.
    plan : layout of the design, if it is there already.
    check : called at least once in each Newton iteration. An error that it raises ends the edit, and the preview keeps
        the state before it.
    max_seconds : wall time after which the search of an edit's stage is given up.

    Attributes
    ----------
    state : all that was computed, a frozen value; edits replace it as a whole.

    Raises
    ------
    DesignError, MeshError
        The design cannot be printed, or its sheet not meshed.
    LawError
        The law is not for this material, or gives values at a star that no sheet can have.
    SearchLimitError
        The search takes longer than `max_seconds`.
    TypeError, ValueError
        An argument is no design, no law or no side.

    Examples
    --------
    >>> from pattern import gallery
    >>> preview = Preview(gallery.load("dome"))
    >>> preview.equilibrium.is_minimum
    True
    """

    @one_blas_thread()
    def __init__(
        self,
        design: Design,
        law: Law | None = None,
        side: Side = "auto",
        triangles: int | None = None,
        say: Say | None = None,
        model: PreviewModel = PREVIEW_MODEL,
        plan: Layout | None = None,
        check: Callable[[], None] | None = None,
        max_seconds: float | None = None,
    ) -> None:
        check_side(side)
        if triangles is not None and not (is_whole(triangles) and 1 <= triangles <= MAX_ASKED_TRIANGLES):
            raise ValueError(
                f"triangles = {triangles!r}: must be a whole number, at least 1 and at most {MAX_ASKED_TRIANGLES}"
            )
        if law is not None:
            check_type(law, Law, "load_law reads one from a file")
        self._say = say or (lambda text: None)
        self._triangles = triangles
        self._watch = Watch(check, max_seconds)
        self._edits = 0
        self._clock = Clock()
        law = law if law is not None else self._clock("law", paper_law)
        plan = plan if plan is not None else self._clock("layout", layout, design)
        check_weight_is_supported(design, plan)
        values: StarValues = self._clock("law", star_values, design, plan, law, model)
        self.state = self._new_state(design, plan, values, law, side, model)

    def _new_state(
        self, design: Design, plan: Layout, values: StarValues, law: Law, side: Side, model: PreviewModel
    ) -> PreviewState:
        """The state of a design on a new sheet."""
        sheet: Sheet = self._clock("mesh", sheet_of, design, plan, self._triangles, model)
        count = sheet.space.mesh.nelements
        patience = ": this may take a minute" if count > PATIENCE_TRIANGLES else ""
        stars = len(plan.centres)
        self._say(f"{stars} star{'s' if stars > 1 else ''} on {count} triangles{patience}")
        return state_from_guesses(sheet, law, values, side, self._clock, self._watch)

    def _printed_state(self, design: Design, plan: Layout, values: StarValues) -> PreviewState:
        """The state of a design on a new sheet, before any search."""
        state = self.state
        sheet = self._clock("mesh", sheet_of, design, plan, self._triangles, state.model)
        return self._clock("shell", state_without_search, sheet, state.law, values, state.side, state.watch)

    def _kept_form(self, design: Design, plan: Layout, values: StarValues) -> PreviewState | None:
        """The state of a design on a new sheet that goes on from the old shape, if it can."""
        new = self._printed_state(design, plan, values)
        x = self._clock("shell", carried, self.state, new)
        return None if x is None else at_form(new, x, self._clock)

    def edit(self, design: Design, keep_form: bool = False) -> Iterator[Stage]:
        """Change the design: first the linear response, at once, and then the equilibrium.

        If outline, supported points, lattice and gravity stay the same, the shape goes on from the last equilibrium;
        the pins may stand at other places in space. Otherwise, or if that leads to no minimum, it starts anew, without
        a linear response. Only a new start meets other forms: after an edit that goes on, the summary lists none.
        With `keep_form`, a sheet with another outline, other supported points or another lattice goes on from the old
        shape as well if it is nearly as large, which takes less time.

        The edit begins when the first stage is asked for; `update` asks for all. If you stop after the linear response,
        the preview shows that response, and its summary says that it is no equilibrium unless the edit changed nothing;
        the next edit's linear response is that of the last equilibrium again. If the edit fails or is interrupted
        before, the preview stays as it was.

        Raises
        ------
        DesignError, MeshError, LawError
            As for a new preview; the old one then stays as it was.
        SearchLimitError
            A stage takes longer than `max_seconds`; the preview then stays as it was before the edit.
        RuntimeError
            A later edit or a flip has overtaken this one.
        TypeError
            It is no design; at once.
        """
        check_type(design, Design, "load_design reads one from a file")
        return self._stages(design, keep_form)

    def update(self, design: Design) -> Shape:
        """Change the design and go on to its equilibrium; what `edit` raises, and its shape."""
        for _ in self.edit(design):
            pass
        return self.shape()

    def _stages(self, design: Design, keep_form: bool) -> Iterator[Stage]:
        before = self.state
        with one_blas_thread():
            self._watch.begin()
            self._clock = Clock()
            plan = self._clock("layout", layout, design)
            check_weight_is_supported(design, plan)
            state, response = self.state, None
            values = self._clock("law", star_values, design, plan, state.law, state.model)
            if state.sheet.is_same_print(design, plan):
                state = self._clock("fields", with_stars, state, design, plan, values)
                state, response = respond(state, self._clock)
            else:
                kept = self._kept_form(design, plan, values) if keep_form else None
                state = kept or self._new_state(design, plan, values, state.law, state.side, state.model)
            self.state = state
            self._edits += 1
            number = self._edits
        if response is not None:
            yield Stage("linear", self.state.equilibrium.x.copy())
            if self._edits != number:
                raise RuntimeError("this edit was overtaken by a later one, or by a flip")
            with one_blas_thread():
                self._watch.begin()
                # the search changes the content of the factor: an interruption leaves a state that says so
                self.state = replace(self.state, is_factor_resting=False)
                try:
                    self.state = followed(self.state, response, self._clock)
                except BaseException:
                    if self._watch.has_stopped:
                        self.state = replace(before, is_factor_resting=False)
                    raise
        yield Stage("equilibrium", self.state.equilibrium.x.copy())

    @one_blas_thread()
    def flip(self) -> Side:
        """Turn the edges to the other side of the print; returns the side they have then.

        If the search finds no form on the other side, the preview stays as it was.
        """
        self._watch.begin()
        self._clock = Clock()
        self._edits += 1
        state = self.state
        side = side_of(state.shell, state.equilibrium.x)
        side = mean_fields(state.shell).side if side == "auto" else side
        flipped = restarted(state, self._clock, OTHER_SIDE[side])
        if side_of(flipped.shell, flipped.equilibrium.x) != flipped.side:
            return side
        self.state = flipped
        return flipped.side

    @one_blas_thread()
    def search_again(self) -> Stage:
        """Search for the equilibrium anew, as a new preview of the design does; what `edit` raises."""
        self._watch.begin()
        self._clock = Clock()
        self._edits += 1
        self.state = restarted(self.state, self._clock)
        return Stage("equilibrium", self.state.equilibrium.x.copy())

    def snapshot(self) -> Snapshot:
        """The design and the last equilibrium, to which `restore` goes back.

        After the first stage of an edit that is the equilibrium before it, with the design of the edit.
        """
        state = self.state
        return Snapshot(state.design, state.side, self._triangles, state.resting.x, state.resting.energy)

    def restore(self, snapshot: Snapshot) -> Stage:
        """Go back to a snapshot of this preview, or of another one with the same law and model.

        The equilibrium is certified again. If the snapshot's positions lead to no minimum, the shape starts anew.

        Raises
        ------
        DesignError, MeshError, LawError, SearchLimitError
            As for an edit; the preview then stays as it was.
        ValueError
            The snapshot is of another mesh.
        """
        check_type(snapshot, Snapshot, "preview.snapshot() makes one")
        return self._at_form(snapshot.design, snapshot.x)

    def show_form(self, number: int) -> Stage:
        """Go to a form of `forms`, by its number in that list from 0. The form that was shown is in the list then.

        Raises
        ------
        ValueError
            There is no such form.
        """
        minima = forms_met(self.state)
        if not (is_whole(number) and 0 <= number < len(minima)):
            raise ValueError(f"number = {number!r}: must be a whole number from 0 to {len(minima) - 1}")
        return self._at_form(self.design, minima[number][1].x)

    @one_blas_thread()
    def _at_form(self, design: Design, x: Floats) -> Stage:
        """The equilibrium of a design near positions x (N, 3) of the shell's dofs."""
        self._watch.begin()
        self._clock = Clock()
        self._edits += 1
        plan = self._clock("layout", layout, design)
        check_weight_is_supported(design, plan)
        state = self.state
        values = self._clock("law", star_values, design, plan, state.law, state.model)
        if state.sheet.is_same_print(design, plan):
            state = self._clock("fields", with_stars, state, design, plan, values)
        else:
            state = self._printed_state(design, plan, values)
        if x.shape != state.shell.flat.shape:
            raise ValueError(f"positions of {len(x)} dofs are of another mesh, which has {len(state.shell.flat)}")
        if state.factor is self.state.factor:
            self.state = replace(self.state, is_factor_resting=False)  # the search changes its content
        self.state = at_form(state, x, self._clock)
        return Stage("equilibrium", self.state.equilibrium.x.copy())

    def __reduce__(self) -> NoReturn:
        """Refuse copies, which would share the factor that edits change."""
        raise TypeError("a preview cannot be copied or pickled: Preview(preview.design, preview.law) makes another")

    @property
    def seconds(self) -> dict[str, float]:
        """Wall time by part, since the preview was made, edited or flipped."""
        return dict(self._clock.seconds)

    @one_blas_thread()
    def shape(self) -> Shape:
        """The sheet with its stars' bumps, as files and pictures show it, with its summary."""
        self.state = with_near_zero_modes(self.state, self._clock)
        self.state = with_shown_sheet(self.state, self._clock)
        state, shown = self.state, self.state.shown
        assert shown is not None
        places = self._clock("shown", shown.lens, state.equilibrium.x, state.values)
        shape: Shape = self._clock("shown", shape_of, state.sheet, shown.mesh, places)
        up = np.eye(3)[2]
        if not shape.held:
            shape, up = shape.aligned(), shape.upright()[2]
        estimate = estimate_error(state, shape, up, self._clock)
        return replace(shape, summary=summary(state, shape, shown.mesh, estimate, self.seconds))
