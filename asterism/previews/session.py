"""A preview that keeps its state, so that edits start from the last equilibrium."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NoReturn

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.threads import one_blas_thread
from asterism.fem.search.mean_fields import Side, check_side, mean_fields, side_of
from asterism.homogenize.law.any_law import AnyLaw
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.design.section import is_whole
from asterism.pattern.layout.layout import Layout
from asterism.previews.designed_states import DesignedStates
from asterism.previews.kinds import kind_of
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.readings import PreviewReadings
from asterism.previews.snapshot import Snapshot
from asterism.previews.solve import at_form, followed, respond, restarted, with_near_zero_modes
from asterism.previews.stage import Stage
from asterism.previews.uncertainty.other_forms import forms_met
from asterism.process.listeners import Say
from asterism.shape.shape import Shape

OTHER_SIDE: dict[Side, Side] = {"down": "up", "up": "down"}


class Preview(PreviewReadings):
    """The homogenised shape of a design, with its state kept for edits.

    Parameters
    ----------
    design : from `load_design`, `new` or `Design.from_dict`.
    law : law of the design's material, also after edits; by default the one that the design names, or else that of
        the paper's material, or else the universal law where it serves, chosen again in each edit. The cells of a motif
        are solved, once in a process, with a line to `say` for each direction of each cell. The first edit of a size of
        its rods solves the cells around the new size; further edits within that range need none. Edits of pins, border
        and places need none either; another motif, lattice, fabric or plastic has other cells.
    side : side of the edges: `down` (plastic outside), `up`, or `auto`, which follows from the stars.
    triangles : approximate number of triangles of the shell's mesh, at most 10000; by default it follows from the
        stars.
    say : called with a line of text at the beginning of each stage.
    model : constants of the preview model.
    plan : layout of the design; computed by default.
    check : called at least once in each Newton iteration. An error that it raises ends the edit, and the preview keeps
        the state before it.
    max_seconds : longest wall time of the search in one stage of an edit.

    Attributes
    ----------
    state : all results, as one frozen value; an edit replaces it as a whole.

    Raises
    ------
    DesignError, MeshError
        The design cannot be printed, or its sheet cannot be meshed.
    LawError
        The law is for another material, or its values at a star are impossible for a sheet.
    SearchLimitError
        The search takes longer than `max_seconds`.
    TypeError, ValueError
        An argument has the wrong type or value.

    Examples
    --------
    >>> from asterism.pattern import gallery
    >>> preview = Preview(gallery.load("dome"))
    >>> preview.equilibrium.is_minimum
    True
    """

    @one_blas_thread()
    def __init__(
        self,
        design: Design,
        law: AnyLaw | None = None,
        side: Side = "auto",
        triangles: int | None = None,
        say: Say | None = None,
        model: PreviewModel = PREVIEW_MODEL,
        plan: Layout | None = None,
        check: Callable[[], None] | None = None,
        max_seconds: float | None = None,
    ) -> None:
        check_side(side)
        self._states = DesignedStates(law, triangles, say, check, max_seconds)
        self._edits = 0
        self.state = self._states.new(self._states.evaluated(design, model, plan), side, model)

    def edit(self, design: Design, keep_form: bool = False) -> Iterator[Stage]:
        """Change the design in two stages: first the linear response, then the equilibrium.

        The linear response starts from the last equilibrium. It requires that outline, lattice, gravity and supported
        points stay the same; the pins may have other positions in space. For other changes, or if the edit leads to no
        minimum, the search starts again from initial guesses, in one stage. Only such a search lists other forms in
        the summary.

        With `keep_form`, a sheet of nearly the same size whose outline, lattice or supported points change also starts
        from the old shape, which takes less time.

        The edit begins at the first request for a stage; `update` requests all stages. If you stop after the first
        stage, the preview shows the linear response, and its summary states that this is not an equilibrium. The next
        edit then starts from the last equilibrium again. If the edit fails or is interrupted before its first stage,
        the preview keeps its state.

        Parameters
        ----------
        design : the new design.
        keep_form : start from the old shape in more cases, see above.

        Yields
        ------
        The stages.

        Raises
        ------
        DesignError, MeshError, LawError
            As for a new preview. The preview keeps its state.
        SearchLimitError
            A stage takes longer than `max_seconds`. The preview keeps its state before the edit.
        RuntimeError
            A later edit or a flip has begun before this edit was complete.
        TypeError
            `design` is not a design; raised at once.
        """
        check_type(design, Design, "load_design reads one from a file")
        return self._stages(design, keep_form)

    def update(self, design: Design) -> Shape:
        """Change the design and return the shape of the new equilibrium; raises the errors of `edit`."""
        for _ in self.edit(design):
            pass
        return self.shape()

    def _stages(self, design: Design, keep_form: bool) -> Iterator[Stage]:
        before, states = self.state, self._states
        with one_blas_thread():
            states.begin()
            state, response = self.state, None
            new = states.evaluated(design, state.model, known=state.law)
            if new.is_same_print(state):
                state, response = respond(states.on_same_print(new, state), states.clock)
            else:
                kept = states.kept_form(new, state) if keep_form else None
                state = kept or states.new(new, state.side, state.model)
            self.state = state
            self._edits += 1
            number = self._edits
        if response is not None:
            yield Stage("linear", self.state.x.copy())
            if self._edits != number:
                raise RuntimeError("this edit was overtaken by a later one, or by a flip")
            with one_blas_thread():
                states.watch.begin()
                # the search overwrites the factor: if it is interrupted, the state must record that
                self.state = replace(self.state, is_factor_resting=False)
                try:
                    self.state = followed(self.state, response, states.clock)
                except BaseException:
                    if states.watch.has_stopped:
                        self.state = replace(before, is_factor_resting=False)
                    raise
        yield Stage("equilibrium", self.state.x.copy())

    @one_blas_thread()
    def flip(self) -> Side:
        """Search for the form whose edges are on the other side; return the side of the edges afterwards.

        If the search finds no form on the other side, the preview keeps its state.
        """
        self._states.begin()
        self._edits += 1
        state = self.state
        side = side_of(state.shell, state.equilibrium.x)
        side = mean_fields(state.shell).side if side == "auto" else side
        flipped = restarted(state, self._states.clock, OTHER_SIDE[side])
        if side_of(flipped.shell, flipped.equilibrium.x) != flipped.side:
            return side
        self.state = flipped
        return flipped.side

    @one_blas_thread()
    def search_again(self) -> Stage:
        """Search for the equilibrium from initial guesses, as a new preview does; raises the errors of `edit`."""
        self._states.begin()
        self._edits += 1
        self.state = restarted(self.state, self._states.clock)
        return Stage("equilibrium", self.state.x.copy())

    def snapshot(self) -> Snapshot:
        """The design and the last equilibrium, for `restore`.

        After the first stage of an edit, this is the design of the edit with the equilibrium before the edit.
        """
        state = self.state
        return Snapshot(state.design, state.side, self._states.triangles, state.resting.x, state.resting.energy)

    def restore(self, snapshot: Snapshot) -> Stage:
        """Return to a snapshot of this preview, or of another one with the same law and model.

        The equilibrium is certified again. If the snapshot leads to no minimum, the search starts from initial guesses.

        Raises
        ------
        DesignError, MeshError, LawError, SearchLimitError
            As for an edit. The preview keeps its state.
        ValueError
            The snapshot belongs to another mesh.
        """
        check_type(snapshot, Snapshot, "preview.snapshot() makes one")
        return self._at_form(snapshot.design, snapshot.x)

    def show_form(self, number: int) -> Stage:
        """Show one of the `forms`, by its index in that list. The form shown before is in the list afterwards.

        Raises
        ------
        ValueError
            The list has no such index.
        """
        minima = forms_met(self.state)
        if not (is_whole(number) and 0 <= number < len(minima)):
            raise ValueError(f"number = {number!r}: must be a whole number from 0 to {len(minima) - 1}")
        return self._at_form(self.design, minima[number][1].x)

    @one_blas_thread()
    def _at_form(self, design: Design, x: Floats) -> Stage:
        """The equilibrium of a design near degrees of freedom x (N, 3) of the shell."""
        self._states.begin()
        self._edits += 1
        states = self._states
        new = states.evaluated(design, self.state.model, known=self.state.law)
        same = new.is_same_print(self.state)
        state = states.on_same_print(new, self.state) if same else states.printed(new, self.state)
        if design != self.state.design:
            state = replace(state, resting=replace(state.resting, trials=()))  # other forms of another sheet
        if x.shape != state.shell.flat.shape:
            raise ValueError(f"positions of {len(x)} dofs are of another mesh, which has {len(state.shell.flat)}")
        if state.factor is self.state.factor:
            self.state = replace(self.state, is_factor_resting=False)  # the search overwrites the factor
        self.state = at_form(state, x, self._states.clock)
        return Stage("equilibrium", self.state.x.copy())

    def __reduce__(self) -> NoReturn:
        """Refuse copies, because they would share the factor, which edits overwrite."""
        raise TypeError("a preview cannot be copied or pickled: Preview(preview.design, preview.law) makes another")

    @property
    def seconds(self) -> dict[str, float]:
        """Wall time (s) by part, since the last start, edit or flip."""
        return dict(self._states.clock.seconds)

    @one_blas_thread()
    def shape(self) -> Shape:
        """The shape, with the bumps of the stars, and its summary, as for files and pictures."""
        states, kind = self._states, kind_of(self.state.design)
        self.state = with_near_zero_modes(self.state, states.clock)
        self.state = kind.with_shown_sheet(self.state, states.clock)
        states.keep(self.state)
        state, shown = self.state, self.state.shown
        assert shown is not None
        with states.clock("shown"):
            places = shown.lens(state.x, state.values)
            shape = kind.shape(state.sheet, shown.mesh, places)
        up = np.eye(3)[2]
        if not shape.held:
            shape, up = shape.aligned(), shape.upright()[2]
        return replace(shape, summary=kind.summary(state, shape, shown.mesh, up, states.clock, self.seconds))
