"""`asterism.preview`, and a preview that keeps its state, so that edits start from the last equilibrium."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal, NoReturn

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.equilibrium.errors import Error
from asterism.equilibrium.threads import one_blas_thread
from asterism.fem.search.mean_fields import Side, check_side, mean_fields, side_of
from asterism.fem.search.relax import ShellEquilibrium
from asterism.fem.shell.shell import Shell
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import check_type
from asterism.pattern.design.section import is_whole
from asterism.pattern.layout.free_motions import check_weight_is_supported
from asterism.pattern.layout.layout import Layout
from asterism.previews.law_choice import serving_law
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.places import Places
from asterism.previews.print_sheet import PrintSheet
from asterism.previews.sheet import keep_print, preview_layout, sheet_for
from asterism.previews.shown_shape import shown_shape, summary
from asterism.previews.solve import PreviewState, other_forms
from asterism.process.progress import Say, ignore_line
from asterism.results.records.shape import OtherFormRecord
from asterism.shape.shape import Shape


class SearchLimitError(Error):
    """A search takes longer than its time limit. The preview keeps its state before the search."""

    exit_status = 1


class SnapshotError(Error, ValueError):
    """A snapshot belongs to another mesh."""


class Watch:
    """Called at least once in each Newton iteration: an error of `check`, or of the time limit, ends the search.

    `has_stopped`: whether the watch has ended the current search.
    """

    def __init__(self, check: Callable[[], None] | None = None, max_seconds: float | None = None) -> None:
        if max_seconds is not None and not max_seconds > 0.0:
            raise ValueError(f"max_seconds = {max_seconds!r}: must be above 0")
        self._check, self._max_seconds = check, max_seconds
        self.begin()

    def begin(self) -> None:
        """Start the clock of a search."""
        self._begun = time.perf_counter()
        self.has_stopped = False

    def __call__(self) -> None:
        try:
            if self._check is not None:
                self._check()
            if self._max_seconds is not None and time.perf_counter() - self._begun > self._max_seconds:
                raise SearchLimitError(f"no equilibrium within {self._max_seconds:g} s; the shape is that before it")
        except BaseException:
            self.has_stopped = True
            raise


@dataclass(frozen=True, eq=False)
class Snapshot:
    """A design and the equilibrium of its shell, for `Preview.restore`. It can be pickled."""

    design: Design
    x: Floats  # (N, 3) degrees of freedom of the shell; read-only

    def __post_init__(self) -> None:
        own = self.x.copy()
        own.flags.writeable = False
        object.__setattr__(self, "x", own)


@dataclass(frozen=True)
class Stage:
    """A result of an edit."""

    # `linear`, the linear response of the last equilibrium to the edit; or `equilibrium`
    name: Literal["linear", "equilibrium"]
    x: Floats  # (N, 3) degrees of freedom of the shell; a copy


class Preview:
    """The homogenised shape of a design, with its state kept for edits.

    Parameters
    ----------
    design : from `load_design`, `new` or `Design.from_dict`.
    law : law of the design's material, also after edits; by default the one that the design names, or else that of
        the paper's material where it covers the stars, or else one of cells that are solved now, with a line to `say`
        for each. Cells are kept for all designs. An edit beyond the sizes of the law solves the cells around the new
        ones; edits of pins, border and places need none; another motif, lattice, fabric or plastic has other cells.
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
        law: Law[Any] | None = None,
        side: Side = "auto",
        triangles: int | None = None,
        say: Say | None = None,
        model: PreviewModel = PREVIEW_MODEL,
        plan: Layout | None = None,
        check: Callable[[], None] | None = None,
        max_seconds: float | None = None,
    ) -> None:
        check_side(side)
        if triangles is not None and not (is_whole(triangles) and 1 <= triangles <= 10_000):  # more take much memory
            raise ValueError(f"triangles = {triangles!r}: must be a whole number, at least 1 and at most 10000")
        self._given_law, self._triangles = law, triangles
        self._say, self._check = say or ignore_line, check
        self._watch = Watch(check, max_seconds)
        self._clock = Clock()
        self.state = self._searched(self._sheet(design, model, plan=plan), side)

    def _begin(self) -> None:
        """Begin an edit: times and the limit of the search start anew."""
        self._watch.begin()
        self._clock = Clock()

    @property
    def design(self) -> Design:
        """The current design."""
        return self.state.design

    @property
    def law(self) -> Any:
        """The law of the material, a `StarLaw` or a `MotifLaw`."""
        return self.state.sheet.law

    @property
    def sheet(self) -> Any:
        """The printed sheet with its law and mesh, for stars a `Sheet`."""
        return self.state.sheet

    @property
    def shell(self) -> Shell:
        """The shell with all supports."""
        return self.state.shell

    @property
    def equilibrium(self) -> ShellEquilibrium:
        """The state of the shell with its certificate."""
        return self.state.equilibrium

    @property
    def forms(self) -> list[OtherFormRecord]:
        """Other minima of the last search, the lowest one first; `show_form` shows one of them."""
        return [form for form, _ in other_forms(self.state)]

    def at(self, points: Floats, x: Floats | None = None) -> Places:
        """The positions of printed points (n, 2) mm, in the pose of the shell; `shape` turns free sheets upright.

        `x`: degrees of freedom of the shell, from a `Stage`; those of the equilibrium by default. Raises ValueError if
        `points` has another form, or a point is outside of the sheet, or x does not belong to this mesh.
        """
        return PointLens(self, points)(x)

    def lens(self, points: Floats) -> PointLens:
        """A function that computes the positions of fixed printed points (n, 2) mm, like `at`, but faster over edits.

        Examples
        --------
        >>> from asterism.pattern import gallery
        >>> lens = Preview(gallery.load("star")).lens([[0.0, 0.0], [3.0, 0.0]])
        >>> lens().bumpy.shape
        (2, 3)
        """
        return PointLens(self, points)

    def edit(self, design: Design, keep_form: bool = False) -> Iterator[Stage]:
        """Change the design in two stages: first the linear response, then the equilibrium.

        The linear response starts from the last equilibrium. It requires that outline, lattice, gravity and supported
        points stay the same; the pins may have other positions in space. For other changes, or if the edit leads to no
        minimum, the search starts again from initial guesses, in one stage, and lists other forms in the summary.

        The edit begins at the first request for a stage; `update` asks for all of them. If you stop after the first
        stage, the preview shows the linear response, and its summary states that this is not an equilibrium. The next
        edit then starts from the last equilibrium again. If the edit fails or is interrupted before its first stage,
        the preview keeps its state.

        Parameters
        ----------
        design : the new design.
        keep_form : a sheet of nearly the same size whose outline, lattice or supported points change also starts from
            the old shape, which takes less time.

        Raises
        ------
        DesignError, MeshError, LawError, SearchLimitError
            As for a new preview, which keeps its state before the edit.
        RuntimeError
            A later edit or a flip has changed the state before this edit was complete.
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
        before = self.state
        with one_blas_thread():
            self._begin()
            state = self.state
            sheet = self._sheet(design, state.sheet.model, before=state.sheet)
            if sheet.space is state.sheet.space:
                state = state.on(sheet, self._clock).respond(self._clock)
            else:
                kept = state.kept_form(sheet, self._clock) if keep_form else None
                state = kept or self._searched(sheet, state.side)
            self.state = state
        if state.response is not None:
            yield Stage("linear", state.x.copy())
            if self.state.response is not state.response:
                raise RuntimeError("this edit was overtaken by a later one, or by a flip")
            with one_blas_thread():
                self._watch.begin()
                # the search overwrites the factor: if it is interrupted, the state must record that
                self.state = replace(self.state, is_factor_resting=False)
                try:
                    self.state = self.state.followed(self._clock)
                except BaseException:
                    if self._watch.has_stopped:
                        self.state = replace(before, is_factor_resting=False)
                    raise
        yield Stage("equilibrium", self.state.x.copy())

    @one_blas_thread()
    def flip(self) -> Side:
        """Search for the form whose edges are on the other side; return the side of the edges afterwards.

        If the search finds no form on the other side, the preview keeps its state.
        """
        self._begin()
        state = self.state
        side = side_of(state.shell, state.equilibrium.x)
        side = mean_fields(state.shell).side if side == "auto" else side
        flipped = state.restarted(self._clock, "up" if side == "down" else "down")
        if side_of(flipped.shell, flipped.equilibrium.x) != flipped.side:
            return side
        self.state = flipped
        return flipped.side

    @one_blas_thread()
    def search_again(self) -> Stage:
        """Search for the equilibrium from initial guesses, as a new preview does; raises the errors of `edit`."""
        self._begin()
        self.state = self.state.restarted(self._clock)
        return Stage("equilibrium", self.state.x.copy())

    def snapshot(self) -> Snapshot:
        """The design and the last equilibrium, for `restore`.

        After the first stage of an edit, this is the design of the edit with the equilibrium before the edit.
        """
        return Snapshot(self.state.design, self.state.resting.x)

    def restore(self, snapshot: Snapshot) -> Stage:
        """Return to a snapshot of this preview, or of another one with the same law and model.

        The equilibrium is certified again. If the snapshot leads to no minimum, the search starts from initial guesses.
        Raises SnapshotError if the snapshot belongs to another mesh, and the errors of `edit`.
        """
        check_type(snapshot, Snapshot, "preview.snapshot() makes one")
        return self._at_form(snapshot.design, snapshot.x)

    def show_form(self, number: int) -> Stage:
        """Show one of the `forms`, by its index in that list, or raise ValueError.

        The form shown before is in the list afterwards.
        """
        minima = other_forms(self.state)
        if not (is_whole(number) and 0 <= number < len(minima)):
            raise ValueError(f"number = {number!r}: must be a whole number from 0 to {len(minima) - 1}")
        return self._at_form(self.design, minima[number][1].x)

    @one_blas_thread()
    def _at_form(self, design: Design, x: Floats) -> Stage:
        """The equilibrium of a design near degrees of freedom x (N, 3) of the shell."""
        self._begin()
        sheet = self._sheet(design, self.state.sheet.model, before=self.state.sheet)
        state = self.state.on(sheet, self._clock)
        if design != self.state.design:
            state = replace(state, resting=replace(state.resting, trials=()))  # other forms of another sheet
        if x.shape != state.shell.flat.shape:
            problem = f"snapshot: must be of a mesh with {len(state.shell.flat)} degrees of freedom, not {len(x)}"
            raise SnapshotError(f"{problem}: it is of another mesh")
        if state.factor is self.state.factor:
            self.state = replace(self.state, is_factor_resting=False)  # the search overwrites the factor
        self.state = state.at_form(x, self._clock)
        return Stage("equilibrium", self.state.x.copy())

    def __reduce__(self) -> NoReturn:
        """Refuse copies, because they would share the factor, which edits overwrite."""
        raise TypeError("a preview cannot be copied or pickled: Preview(preview.design, preview.law) makes another")

    @property
    def seconds(self) -> dict[str, float]:
        """Wall time (s) by part, since the last start, edit or flip."""
        return dict(self._clock.seconds)

    @one_blas_thread()
    def shape(self) -> Shape:
        """The shape, with the bumps of the stars, and its summary."""
        self.state = state = self.state.with_near_zero_modes(self._clock)
        with self._clock("shown"):
            shape = shown_shape(state)
        keep_print(state.sheet)
        return replace(shape, summary=summary(state, shape, self.seconds))

    def _said(self, text: str) -> None:
        """Pass on a line of a long computation, which the caller may end by the error of its check."""
        if self._check is not None:
            self._check()
        self._say(text)

    def _sheet(
        self, design: Design, model: PreviewModel, before: PrintSheet | None = None, plan: Layout | None = None
    ) -> PrintSheet:
        """The sheet of a design, with the values of its law.

        Parameters
        ----------
        before : sheet of the preview before an edit; one of the same print shares its mesh, and its law is extended.
        """
        if plan is None:
            with self._clock("layout"):
                plan = preview_layout(design)
        law = self._given_law
        if law is None:
            with self._clock("law"):
                law = serving_law(design, plan, None if before is None else before.law, self._said)
        check_weight_is_supported(design, plan)
        with self._clock("mesh"):
            if before is not None and before.is_same_print(design, plan):
                sheet = before.with_pattern(design, plan, law)
            else:
                sheet = sheet_for(design, plan, law, self._triangles, model)
        with self._clock("law"):
            _ = sheet.values  # errors of the law come before a search
        return sheet

    def _searched(self, sheet: PrintSheet, side: Side) -> PreviewState:
        """The state of a sheet from guesses."""
        count, rods, stars = sheet.space.mesh.nelements, len(sheet.layout.graph.rods), len(sheet.layout.centres)
        pattern = f"{stars} star{'s' * (stars > 1)}" if stars else f"{rods} rod{'s' * (rods > 1)}"
        # from this number of triangles on, a message announces a long computation: some sheets take hundreds of
        # iterations
        patience = ": this may take a minute" if count > 300 else ""
        self._say(f"{pattern} on {count} triangles{patience}")
        state = PreviewState.from_guesses(sheet, side, self._clock, self._watch)
        keep_print(sheet)
        return state


def preview(
    design: Design,
    law: Law[Any] | None = None,
    side: Side = "auto",
    say: Say | None = None,
    model: PreviewModel = PREVIEW_MODEL,
    plan: Layout | None = None,
) -> Shape:
    """Compute the homogenised shape of a design: with the bumps of its stars, or with the rods of its motif.

    Parameters
    ----------
    design, law, side, say, model, plan : as for `Preview`, which keeps its state for edits; the errors too.

    Returns
    -------
    The shape. Its `summary` holds the certificate (`is_minimum`), the stars outside the range of the law, the estimated
    error, and the whole design. The principal axes of a free sheet lie along x, y and z. `point_fields["bump_mm"]`
    holds the vectors from the smooth surface to the shape.
    """
    begin = time.perf_counter()
    shape = Preview(design, law, side, say=say, model=model, plan=plan).shape()
    return replace(shape, summary=shape.summary | {"wall_s": time.perf_counter() - begin})


class PointLens:
    """Printed points (n, 2) mm on the sheet of a preview, followed over edits; `Preview.lens` makes one.

    After an edit that keeps the print, only what depends on the changed stars is computed again. Raises ValueError:
    these are no points, or one is off the sheet.
    """

    def __init__(self, preview: Preview, points: Floats) -> None:
        self._preview, self._lens = preview, preview.sheet.lens(points)
        self.points = self._lens.points

    def __call__(self, x: Floats | None = None) -> Places:
        """The points in space, at positions `x` of a stage or else in the state that the preview shows.

        Raises ValueError: `x` is not of a stage of the present design; or a point is off the sheet since its outline
        has changed.
        """
        state = self._preview.state
        x = state.x if x is None else np.asarray(x, dtype=float)
        if x.shape != state.x.shape:
            raise ValueError(f"x must be a stage's, shape {state.x.shape}, got shape {x.shape}")
        self._lens = self._lens.renewed(state.sheet)
        return self._lens(x)
