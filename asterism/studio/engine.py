"""The engine: one preview, which shows edits as they come. The newest edit wins.

An edit gives the linear response at once and then the equilibrium. While the pointer is down, equilibria are left out
if newer edits wait, but not for long. When nothing has been asked for a while, a fine mesh follows, with the error, the
warnings and the other forms, and the exact model can go on from there. A pattern without a preview is left to it.
"""

from __future__ import annotations

import math
import pickle
import sys
import threading
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.exact.cost import exact_cost
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.plan import without_law
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import BlankSheetError, DesignError
from asterism.pattern.design.stars import SIZE_KEYS
from asterism.pattern.layout.painted_stars import with_painted_stars
from asterism.previews.law_choice import law_of, paper_law
from asterism.previews.session import Preview, SearchLimitError, SnapshotError
from asterism.previews.solve import EDIT_START, FORM_START, other_forms
from asterism.process.compiling import clock_without_compiling, signs_while_compiling
from asterism.studio.answers import UNEXPECTED, blank_summary, engine_problem, rest_summary
from asterism.studio.engine_frames import EQUILIBRIUM, EngineFrames
from asterism.studio.inbox import SIGN_EVERY_S, Cancelled, Inbox, SearchBounds, Superseded
from asterism.studio.messages import (
    Busy,
    Edit,
    FitTarget,
    Flip,
    Limits,
    Parts,
    Ready,
    Rested,
    ShowForm,
    Sign,
    StudioProblem,
)
from asterism.studio.sheet_frames import blank_frame, printed_frame


class Engine:
    """Shows edits; `clock` gives seconds, without those in which loops are compiled."""

    def __init__(
        self, inbox: Inbox, send: Callable[[Any], None], clock: Callable[[], float] = time.perf_counter
    ) -> None:
        self._inbox, self._send_on = inbox, send
        self.bounds = SearchBounds(inbox, send, clock)
        self._preview: Preview | None = None
        self._printed: Design | None = None  # a design without a preview
        self._known: Edit | None = None
        self._design: Design | None = None
        self._limits_of: Any = None  # material and lattice of the last limits
        self._frames = EngineFrames()
        self._is_resting = True
        self._owes_search = False  # the shape went on from one with another outline, and may not be the lowest
        self._equilibrium_at, self._equilibrium_sizes = -np.inf, np.empty((0, len(SIZE_KEYS)))

    def serve(self) -> None:
        """Answer messages until there are no more."""
        while not self._inbox.is_closed:
            # after so many seconds without a message the fine frame and the exact model follow
            message = self._inbox.take(None if self._is_resting else 0.3)
            if message is not None:
                self.answer(message)
            elif not self._inbox.is_closed:
                self.rest()

    def answer(self, message: Any) -> None:
        """Show an edit, another side or another form; with other parts; or lay the target on the shape."""
        # parts that were asked for before an edit may come after it: what follows is still about the edit
        self.bounds.begin(max(message.seq, self.bounds.seq))
        self._is_resting &= isinstance(message, Parts | FitTarget)  # these show no other shape
        match message:
            case Parts():
                self._try(lambda: self._show_again(message))
            case FitTarget():
                self.bounds.wait()  # one long step
                self._try(self._lay_target)
            case Edit():
                self._try(lambda: self._edit(message))
            case Flip():
                self._try(lambda: self._search(self._flip))
            case ShowForm():
                self._try(lambda: self._search(lambda: self._show_form(message.index)))

    def rest(self) -> None:
        """After a while without edits: a fine frame, and all that is known about the shape."""
        self._is_resting = True
        self.bounds.begin(self.bounds.seq, yields=True)
        self._try(self._show_at_rest)

    def _try(self, work: Callable[[], None]) -> None:
        """Do the work; an error becomes a message, and the preview keeps its shape."""
        seq = self.bounds.seq
        try:
            work()
            self.bounds.end(is_superseded=False)
        except Superseded:
            self._is_resting = False  # also after a message that shows nothing new, such as one about a target
            self.bounds.end(is_superseded=True)
        except Cancelled:
            self._is_resting = True
            self._refuse("cancelled", "the computation was cancelled")
        except Exception as error:
            self._is_resting = True
            problem = engine_problem(seq, error, self._design)
            if problem.kind == UNEXPECTED and not isinstance(error, Error):
                traceback.print_exc(file=sys.stderr)
            self._send(problem)
        finally:
            self.bounds.go_on(math.inf)

    def _send(self, message: Any) -> None:
        self.bounds.last_sign = time.monotonic()
        self.bounds.go_on()
        self._send_on(message)

    def say(self, text: str) -> None:
        """Pass on what begins, which may take long."""
        self._send(Busy(self.bounds.seq, text))
        self.bounds.wait()

    # edits

    def _edit(self, edit: Edit) -> None:
        if self._known is not None and not edit.is_opened:
            # the form to go back to, if an opening was overtaken by this edit
            edit = replace(edit, snapshot=self._known.snapshot)
        is_known = self._known is not None and (edit.design, edit.folder) == (self._known.design, self._known.folder)
        parsed = self._design if is_known else None
        self._known = edit
        if edit.is_dragging and self._preview is not None:
            self.bounds.longest_s = 2.5
        design = self._parsed(edit, parsed)
        try:
            self._tell_limits(design)
            self._show_design(design, edit)
        except BlankSheetError:
            self._show_blank(design)
        except (DesignError, LawError):
            if without_law(design) is None:
                raise
            self._show_printed(design)

    def _tell_limits(self, design: Design) -> None:
        """Send what the law of a design covers, if its material and lattice are others than before."""
        key = (design.fabric, design.lattice, design.plastic, design.material)
        if key == self._limits_of:
            return
        self._limits_of = None
        ranges: dict[str, tuple[float, float]] = {}
        stretches: tuple[float, ...] = ()
        if design.stars is not None:  # cells of motifs are solved where the sizes are
            law = law_of(design)
            stretches = tuple(each for each in law.stretches if isinstance(each, float))
            with suppress(ForeignLaw):  # so are cells of other fabrics
                ranges = law.check(design).size_ranges
        self._limits_of = key
        self._send(Limits(self.bounds.seq, ranges, stretches))

    def _show_design(self, design: Design, edit: Edit) -> None:
        preview = self._preview
        if edit.is_opened or preview is None or pattern_kinds(preview.state.design) != pattern_kinds(design):
            self._open(design, edit.snapshot)
            self._show(EQUILIBRIUM, None)
        else:
            self._show_stages(preview, design, edit)

    def _open(self, design: Design, snapshot: bytes | None) -> None:
        """Go to the form of a snapshot, or to the one that a search finds; the form shown before has no influence."""
        preview, self._preview = self._preview, None  # if this fails, later edits must not go on from the old form
        self._printed = None
        self._owes_search = False
        if preview is None:
            preview = Preview(design, check=self.bounds.check, say=self.say)
            if snapshot is not None:
                self._restores(preview, snapshot, design)
        elif snapshot is None or not self._restores(preview, snapshot, design):
            preview = Preview(design, check=self.bounds.check, say=self.say)
        self._preview = preview

    def _parsed(self, edit: Edit, parsed: Design | None) -> Design:
        """The design of an edit, with its painted stars; `parsed` is its table, if that is parsed already."""
        if parsed is None:
            self._design = None  # of errors in the table
            parsed = Design.from_dict(edit.design, edit.folder)
        self._design = parsed
        if parsed.stars is None or not len(edit.sites) + len(edit.removed):
            return parsed
        return with_painted_stars(parsed, edit.sites, edit.sizes_mm, edit.removed)

    def _show_stages(self, preview: Preview, design: Design, edit: Edit) -> None:
        for stage in preview.edit(design, keep_form=True):
            if (guess := preview.state.resting.guess) != EDIT_START:
                self._owes_search = guess == FORM_START
            self._show(stage.name, stage.x)
            if stage.name == "linear" and edit.is_dragging and self._may_skip(preview):
                return

    def _may_skip(self, preview: Preview) -> bool:
        """Whether the equilibrium can wait for a newer edit."""
        sizes, known = preview.sheet.layout.site_sizes_mm, self._equilibrium_sizes
        change = np.abs(sizes - known)[:, 0].max(initial=0.0) if sizes.shape == known.shape else np.inf
        is_recent = time.monotonic() - self._equilibrium_at < 0.25
        # since the last equilibrium: the linear response is off after larger changes
        return self._inbox.has_waiting and is_recent and bool(change < 1.0)

    @staticmethod
    def _restores(preview: Preview, snapshot: bytes, design: Design) -> bool:
        """Whether the preview could go to the form of a snapshot."""
        try:
            preview.restore(replace(pickle.loads(snapshot), design=design))
        except SnapshotError:
            return False
        return True

    def _search(self, work: Callable[[], None]) -> None:
        """Search for another form. Without one the shown form stays, and is as good as before."""
        try:
            work()
        except Cancelled:
            self._refuse("search ended", "the search was cancelled; the form stays")
        except SearchLimitError:
            self._refuse("search ended", f"no other form within {self.bounds.longest_s:g} s; the form stays")

    def _refuse(self, kind: str, text: str) -> None:
        self._send(StudioProblem(self.bounds.seq, kind, text))

    def _flip(self) -> None:
        if self._preview is None:
            return self._refuse("no other side", "there is no shape to flip")
        before = self._preview.state
        side = self._preview.flip()
        if self._preview.state is before:
            return self._refuse("no other side", f"the sheet has no form but the one with its edges {side}")
        self._show_found()

    def _show_form(self, index: int) -> None:
        if self._preview is None or not 0 <= index < len(self._preview.forms):
            return self._refuse("no such form", "the list of forms has changed")
        self._preview.show_form(index)
        self._show_found()

    def _show_found(self) -> None:
        """Send the form that a search has found: it is the lowest, or it was chosen."""
        self._owes_search = False
        self._show(EQUILIBRIUM, None)

    # what is shown

    def _show(self, stage: str, x: Floats | None) -> None:
        """Send a stage on the coarse mesh."""
        preview = self._preview
        assert preview is not None and self._known is not None
        frame = self._frames.coarse(preview, self.bounds.seq, stage, x, self._known.is_dragging)
        snapshot = None
        if stage == EQUILIBRIUM:
            self._equilibrium_at = time.monotonic()
            self._equilibrium_sizes = preview.sheet.layout.site_sizes_mm
            snapshot = None if self._known.is_dragging else pickle.dumps(preview.snapshot())
        self._send(replace(frame, snapshot=snapshot))

    def _show_blank(self, design: Design) -> None:
        """Send the flat sheet of a design without stars, and all that there is to know of it."""
        self._is_resting = True
        self._send(blank_frame(design, self.bounds.seq))
        self._send(blank_summary(self.bounds.seq))

    def _show_printed(self, design: Design) -> None:
        """Send the flat sheet of a design that has no preview: the exact model has to compute it."""
        self._preview = None
        self._printed = design
        self._send(printed_frame(design, self.bounds.seq))

    def _show_again(self, parts: Parts) -> None:
        """Send the last equilibrium with other parts; frames from now on have them too."""
        self._frames.set_parts(parts)
        is_dragging = self._known is not None and self._known.is_dragging
        if (frame := self._frames.again(self._preview, is_dragging)) is not None:
            self._send(frame)

    def _lay_target(self) -> None:
        """Send the motion that lays the target on the last shape."""
        if self._preview is not None and (pose := self._frames.pose(self.bounds.seq)) is not None:
            return self._send(pose)
        self._refuse("no target", "there is no target or no shape to lay it on")

    def _show_at_rest(self) -> None:
        preview, known, seq = self._preview, self._known, self.bounds.seq
        if known is None or known.is_dragging:
            return
        if preview is None:
            if self._printed is not None:
                self._send(Rested(seq, None, exact_cost(self._printed).seconds))
            return
        if preview.state.response is not None:
            return  # a linear response
        if self._owes_search:
            preview.search_again()
            self._show_found()
        shape = preview.shape()
        if self._inbox.has_waiting:
            raise Superseded
        self._send(Rested(seq, pickle.dumps(shape), exact_cost(preview.design).seconds))
        self._frames.prepare_fine(preview)
        if self._inbox.has_waiting:
            raise Superseded
        frame = self._frames.fine(preview, seq)
        self._send(replace(frame, snapshot=pickle.dumps(preview.snapshot())))
        others = other_forms(preview.state)
        self._send(rest_summary(seq, preview, shape, [form for form, _ in others]))
        for index, (_, trial) in enumerate(others):
            if self._inbox.has_waiting:
                raise Superseded
            self._send(self._frames.form(preview, seq, index, trial.x))


def pattern_kinds(design: Design) -> tuple[bool, bool, bool]:
    """Whether the sheet has stars, lines that repeat on a lattice, and other lines. A preview is of one kind.

    Examples
    --------
    >>> pattern_kinds(Design.from_dict({"stars": {"length_mm": 10}, "border": {"rings": 2}}))
    (True, False, False)
    """
    rods = design.rods
    return design.stars is not None, rods is not None and bool(rods.motif), rods is not None and bool(rods.on_sheet)


def run_engine(connection: Connection) -> None:
    """The body of an engine's process: load everything, and serve until this end of its pipe is closed."""
    lock = threading.Lock()

    def send(message: Any) -> None:
        with lock:
            connection.send(message)

    inbox, law = Inbox(connection.recv), paper_law()
    with clock_without_compiling() as clock:
        engine = Engine(inbox, send, clock)
        with signs_while_compiling(engine.say, SIGN_EVERY_S):
            if not inbox.has_waiting:
                list(Preview(gallery.load("star"), law).edit(gallery.load("star")))
            send(Ready())

            def give_signs() -> None:
                """A process that is stopped or stuck in a library gives no sign; one in a loop without end says so."""
                with suppress(OSError):
                    while not inbox.is_closed:
                        time.sleep(1.0)
                        send(Sign(engine.bounds.is_stuck))

            threading.Thread(target=give_signs, daemon=True).start()
            engine.serve()
