"""States of a preview from designs: layout, law, values and sheet of any kind of pattern, each timed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from asterism.equilibrium.clock import Clock
from asterism.fem.search.mean_fields import Side
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.design.section import is_whole
from asterism.pattern.layout.free_motions import check_weight_is_supported
from asterism.pattern.layout.layout import Layout
from asterism.previews.kept_prints import keep_print, kept_print
from asterism.previews.kinds import kind_of, serves
from asterism.previews.model import PreviewModel
from asterism.previews.pattern_kind import PatternKind
from asterism.previews.solve import at_form, carried, state_from_guesses, state_without_search, with_pattern
from asterism.previews.state import AnyPreviewState
from asterism.previews.watch import Watch
from asterism.process.listeners import Say, ignore_line

# from this number of triangles on, a message announces a long computation: some sheets take hundreds of iterations
PATIENCE_TRIANGLES = 300
# largest number of triangles that the caller may give, which limits the memory
MAX_ASKED_TRIANGLES = 10_000


@dataclass(frozen=True, eq=False)
class EvaluatedDesign:
    """A design with its layout, its law, and the law's values.

    Attributes
    ----------
    kind : of its pattern.
    """

    design: Design
    plan: Layout
    kind: PatternKind
    law: Any
    values: Any

    def is_same_print(self, state: AnyPreviewState) -> bool:
        """Whether the sheet of a state serves this design."""
        return serves(state.sheet, self.design, self.plan)


class DesignedStates:
    """Makes the states of a preview's designs.

    Parameters
    ----------
    law : law of the preview, also after edits; None for the one that serves each design.
    triangles : approximate number of triangles of the shell's mesh; None for the default.
    say : called with a line of text at the beginning of each stage.
    check : called at least once in each Newton iteration.
    max_seconds : longest wall time of the search in one stage of an edit.

    Attributes
    ----------
    clock : of the present stage.
    """

    def __init__(
        self,
        law: Any,
        triangles: int | None,
        say: Say | None,
        check: Callable[[], None] | None,
        max_seconds: float | None,
    ) -> None:
        if triangles is not None and not (is_whole(triangles) and 1 <= triangles <= MAX_ASKED_TRIANGLES):
            raise ValueError(
                f"triangles = {triangles!r}: must be a whole number, at least 1 and at most {MAX_ASKED_TRIANGLES}"
            )
        self.given_law, self.triangles = law, triangles
        self.say = say or ignore_line
        self.watch, self._check = Watch(check, max_seconds), check
        self.clock = Clock()

    def begin(self) -> None:
        """Begin an edit: times and the limit of the search start anew."""
        self.watch.begin()
        self.clock = Clock()

    def _said(self, text: str) -> None:
        """Pass on a line of a long computation, which the caller may end by the error of its check."""
        if self._check is not None:
            self._check()
        self.say(text)

    def evaluated(
        self, design: Design, model: PreviewModel, plan: Layout | None = None, known: Any = None
    ) -> EvaluatedDesign:
        """Layout, law and values of a design.

        Parameters
        ----------
        plan : layout of the design; computed by default.
        known : law of the preview before an edit.

        Raises
        ------
        DesignError, LawError
            See `Preview`.
        """
        check_type(design, Design, "load_design reads one from a file")
        kind = kind_of(design)
        if self.given_law is not None:
            kind.check_law(self.given_law)
        if plan is None:
            with self.clock("layout"):
                plan = kind.layout(design)
        law = self.given_law
        if law is None:
            with self.clock("law"):
                law = kind.default_law(design, plan, known, self._said)
        check_weight_is_supported(design, plan)
        with self.clock("law"):
            values = kind.values(design, plan, law, model)
        return EvaluatedDesign(design, plan, kind, law, values)

    def new(self, new: EvaluatedDesign, side: Side, model: PreviewModel) -> AnyPreviewState:
        """The state of a design from guesses, on a new sheet or on a kept one of the same print."""
        kept = kept_print(new.design, new.plan, self.triangles, model)
        with self.clock("mesh"):
            if kept is None:
                sheet = new.kind.sheet(new.design, new.plan, self.triangles, model)
            else:
                sheet = kept.sheet.with_pattern(new.design, new.plan)
        count = sheet.space.mesh.nelements
        patience = ": this may take a minute" if count > PATIENCE_TRIANGLES else ""
        self.say(f"{new.kind.size_in_words(new.plan)} on {count} triangles{patience}")
        state = state_from_guesses(sheet, new.law, new.values, side, self.clock, self.watch)
        if kept is not None:
            with self.clock("shown"):
                state = replace(state, shown=kept.shown_on(sheet))
        self.keep(state)
        return state

    def keep(self, state: AnyPreviewState) -> None:
        """Keep the print of a state for further previews."""
        keep_print(state, self.triangles)

    def printed(self, new: EvaluatedDesign, state: AnyPreviewState) -> AnyPreviewState:
        """The state of a design on a new sheet, before a search."""
        with self.clock("mesh"):
            sheet = new.kind.sheet(new.design, new.plan, self.triangles, state.model)
        with self.clock("shell"):
            return state_without_search(sheet, new.law, new.values, state.side, state.watch)

    def kept_form(self, new: EvaluatedDesign, state: AnyPreviewState) -> AnyPreviewState | None:
        """The state of a design on a new sheet, started from the old shape; None if that is impossible."""
        printed = self.printed(new, state)
        with self.clock("shell"):
            x = carried(state, printed)
        return None if x is None else at_form(printed, x, self.clock)

    def on_same_print(self, new: EvaluatedDesign, state: AnyPreviewState) -> AnyPreviewState:
        """The state of a design on the sheet of a state, at the equilibrium of that."""
        started = replace(state, law=new.law)
        with self.clock("fields"):
            return with_pattern(started, new.design, new.plan, new.values)
