"""The engine: a process with one preview, which shows edits as they come. The newest edit wins.

An edit gives the linear response at once and then the equilibrium. While the pointer is down, equilibria are left out
if newer edits wait, but not for long. When nothing has been asked for a while, a fine mesh follows, with the estimated
error, the warnings and the other forms.
"""

from __future__ import annotations

import pickle
import sys
import time
import traceback
from collections.abc import Callable
from dataclasses import replace
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from asterism.previews.session import Preview, paper_law
from asterism.previews.solve import EDIT_START
from asterism.previews.watch import SearchLimitError
from asterism.results.placed_warning import PlacedWarning
from asterism.studio.engine_problem import UNEXPECTED, engine_problem
from asterism.studio.inbox import Inbox, merged
from asterism.studio.messages import (
    Busy,
    Edit,
    Flip,
    Form,
    Limits,
    Notice,
    Ready,
    ShapeSummary,
    ShowForm,
    StudioProblem,
    sites_of,
)
from asterism.studio.sheet_view import SheetView, blank_messages
from equilibrium.errors import Error
from homogenize.errors import ForeignLaw
from pattern import gallery
from pattern.design.design import Design
from pattern.design.errors import BlankSheetError
from pattern.geometry.arrays import Floats
from pattern.layout.painted_stars import with_painted_stars

REST_S = 0.3  # without a message, after which the fine frame follows
STALE_S = 0.4  # a search that has taken longer ends when a newer edit waits
MAX_STALE_S = 2.0  # the same if the search before it has ended so
EQUILIBRIUM_EVERY_S = 0.25  # while edits follow each other
MAX_LENGTH_CHANGE_MM = 1.0  # since the last equilibrium: the linear response is off after larger changes
# processor time of the search of an edit while the pointer is down, and of other edits
MAX_DRAGGED_SEARCH_S = 2.5
MAX_SEARCH_S = 20.0
MAX_SLOWDOWN = 3.0  # over these, by the clock, as other programs want the cores too
SIGN_EVERY_S = 2.0  # of life, in long searches
SUMMARY_KEYS = (
    "expected_rms_percent",
    "expected_height_percent",
    "height_mm",
    "extent_mm",
    "contraction",
    "roll_radius_mm",
    "is_minimum",
    "law_in_range",
    "stars_outside_law",
    "side",
    "stars",
    "energy_n_mm",
)
WITHOUT_STARS = "the sheet has no stars: it is flat fabric, shown as it is when it is released, without pins"
WARM_UP_DESIGN = "star"


class Superseded(Exception):
    """A newer message waits, and the work on an older one ends."""


class Cancelled(Exception):
    """The work on a message was broken off."""


class Engine:
    """Shows edits.

    Parameters
    ----------
    inbox : what is asked for.
    send : passes a message on.
    """

    def __init__(self, inbox: Inbox, send: Callable[[Any], None]) -> None:
        self._inbox, self._send_on = inbox, send
        self._preview: Preview | None = None
        self._known: Edit | None = None
        self._design: Design | None = None
        self._limits: Any = None
        self._coarse: SheetView | None = None
        self._fine: SheetView | None = None
        self._meshes = 0
        self._seq, self._longest_s, self._begun, self._sign, self._worked = 0, MAX_SEARCH_S, 0.0, 0.0, 0.0
        self._yields, self._was_stale, self._is_resting = False, False, True
        self._equilibrium_at, self._equilibrium_sizes = -np.inf, np.empty((0, 3))

    def serve(self) -> None:
        """Answer messages until there are no more."""
        while not self._inbox.is_closed:
            message = self._inbox.take(None if self._is_resting else REST_S)
            if message is not None:
                self.answer(message)
            elif not self._inbox.is_closed:
                self._is_resting = True
                self._try(self._seq, self._rest)

    def answer(self, message: Any) -> None:
        """Show an edit, another side or another form."""
        self._begin(message.seq, MAX_SEARCH_S)
        self._is_resting = False
        if isinstance(message, Edit):
            self._try(message.seq, lambda: self._edit(message))
        elif isinstance(message, Flip):
            self._try(message.seq, self._flip)
        elif isinstance(message, ShowForm):
            self._try(message.seq, lambda: self._show_form(message.index))

    def _try(self, seq: int, work: Callable[[], None]) -> None:
        """Do the work; an error becomes a message, and the preview keeps its shape."""
        try:
            work()
            self._was_stale = False
        except Superseded:
            self._was_stale = not self._yields
        except Cancelled:
            self._is_resting = True
            self._send(StudioProblem(seq, "cancelled", "the computation was cancelled"))
        except Exception as error:
            self._is_resting = True
            problem = engine_problem(seq, error, self._design)
            if problem.kind == UNEXPECTED and not isinstance(error, Error):
                traceback.print_exc(file=sys.stderr)
            self._send(problem)

    def _begin(self, seq: int, longest_s: float, yields: bool = False) -> None:
        self._seq, self._longest_s, self._yields = seq, longest_s, yields
        self._begun = self._sign = time.monotonic()
        self._worked = time.thread_time()

    def _check(self) -> None:
        """Called in each Newton iteration: end what nobody waits for, and give signs of life."""
        now = time.monotonic()
        if self._inbox.is_closed or self._inbox.is_cancelled(self._seq):
            raise Cancelled
        if self._inbox.has_waiting:
            stale = MAX_STALE_S if self._was_stale else STALE_S
            if self._yields or now - self._begun > stale:
                raise Superseded
        worked = time.thread_time() - self._worked
        if worked > self._longest_s or now - self._begun > MAX_SLOWDOWN * self._longest_s:
            raise SearchLimitError(f"no equilibrium within {self._longest_s:g} s; the shape is that before the edit")
        if now - self._sign > SIGN_EVERY_S:
            self._send(Busy(self._seq, f"searching for the equilibrium, {now - self._begun:.0f} s"))

    def _send(self, message: Any) -> None:
        self._sign = time.monotonic()
        self._send_on(message)

    def _say(self, text: str) -> None:
        self._send(Busy(self._seq, text))

    # edits

    def _edit(self, edit: Edit) -> None:
        edit = merged(self._known, edit) if self._known else edit
        parsed = self._design if self._known and edit.design is self._known.design else None
        self._known = edit
        self._longest_s = MAX_DRAGGED_SEARCH_S if edit.is_dragging else MAX_SEARCH_S
        design = self._parsed(edit, parsed)
        self._send_limits(design)
        try:
            self._show_design(design, edit)
        except BlankSheetError:
            self._show_blank(design)

    def _show_design(self, design: Design, edit: Edit) -> None:
        if self._preview is None:
            self._preview = Preview(design, check=self._check, say=self._say)
            self._show("equilibrium", None)
        elif edit.snapshot is not None and self._restore(edit, design):
            self._show("equilibrium", None)
        else:
            self._show_stages(self._preview, design, edit)

    def _parsed(self, edit: Edit, parsed: Design | None) -> Design:
        """The design of an edit, with its painted stars."""
        if parsed is None or edit.folder != getattr(self, "_folder", None):
            assert edit.design is not None
            parsed = Design.from_dict(edit.design, edit.folder)
            self._folder = edit.folder
        self._design = parsed
        if edit.sites is None and edit.removed is None:
            return parsed
        sites = np.empty((0, 2)) if edit.sites is None else edit.sites
        sizes = np.full((len(sites), 3), np.nan) if edit.sizes_mm is None else edit.sizes_mm
        return with_painted_stars(parsed, sites, sizes, () if edit.removed is None else edit.removed)

    def _show_stages(self, preview: Preview, design: Design, edit: Edit) -> None:
        for stage in preview.edit(design, keep_form=edit.is_dragging):
            self._show(stage.name, stage.x)
            if stage.name == "linear" and edit.is_dragging and self._may_skip(preview):
                return

    def _may_skip(self, preview: Preview) -> bool:
        """Whether the equilibrium can wait for a newer edit."""
        sizes, known = preview.sheet.layout.site_sizes_mm, self._equilibrium_sizes
        change = np.abs(sizes - known)[:, 0].max(initial=0.0) if sizes.shape == known.shape else np.inf
        is_recent = time.monotonic() - self._equilibrium_at < EQUILIBRIUM_EVERY_S
        return self._inbox.has_waiting and is_recent and bool(change < MAX_LENGTH_CHANGE_MM)

    def _restore(self, edit: Edit, design: Design) -> bool:
        """Whether the preview could go to the form of a snapshot."""
        assert self._preview is not None and edit.snapshot is not None
        try:
            self._preview.restore(replace(pickle.loads(edit.snapshot), design=design))
        except ValueError as error:
            if isinstance(error, Error):
                raise
            return False  # the form of another mesh
        return True

    def _flip(self) -> None:
        if self._preview is None:
            return
        before = self._preview.state
        side = self._preview.flip()
        if self._preview.state is before:
            self._send(
                StudioProblem(self._seq, "no other side", f"the sheet has no form but the one with its edges {side}")
            )
            return
        self._show("equilibrium", None)

    def _show_form(self, index: int) -> None:
        if self._preview is None or not 0 <= index < len(self._preview.forms):
            self._send(StudioProblem(self._seq, "no such form", "the list of forms has changed"))
            return
        self._preview.show_form(index)
        self._show("equilibrium", None)

    # what is shown

    def _show(self, stage: str, x: Floats | None) -> None:
        """Send a stage on the coarse mesh."""
        preview = self._preview
        assert preview is not None and self._known is not None
        view = self._coarse = self._view(preview, self._coarse, is_fine=False)
        if preview.equilibrium.guess != EDIT_START and stage == "equilibrium":
            view.stand_up(preview, x)
        frame = view.frame(preview, self._seq, stage, x)
        snapshot = None
        if stage == "equilibrium":
            self._equilibrium_at = time.monotonic()
            self._equilibrium_sizes = preview.sheet.layout.site_sizes_mm
            snapshot = None if self._known.is_dragging else pickle.dumps(preview.snapshot())
        seconds = {"since asked": time.monotonic() - self._begun, **preview.seconds}
        self._send(replace(frame, snapshot=snapshot, seconds=seconds))

    def _view(self, preview: Preview, view: SheetView | None, is_fine: bool) -> SheetView:
        """A view of the preview's sheet. Its mesh is sent before the first frame, and again with other arms."""
        if view is None or not view.shows(preview):
            view = SheetView(preview, is_fine)
        layout = preview.sheet.layout
        if not view.has_arms_of(layout):
            self._meshes += 1
            self._send(view.numbered(self._meshes, layout))
        return view

    def _show_blank(self, design: Design) -> None:
        """Send the flat sheet of a design without stars, and all that there is to know of it."""
        self._is_resting = True
        self._meshes += 1
        mesh, frame = blank_messages(design, self._meshes, self._seq)
        self._send(mesh)
        self._send(frame)
        numbers = {"height_mm": 0.0, "is_minimum": True, "stars": 0}
        self._send(ShapeSummary(self._seq, numbers, (Notice(WITHOUT_STARS),)))

    def _rest(self) -> None:
        """After a while without edits: a fine frame, and all that is known about the shape."""
        preview, known = self._preview, self._known
        if preview is None or known is None or known.is_dragging:
            return
        if preview.equilibrium is not preview.state.resting:
            return  # a linear response
        self._begin(self._seq, MAX_SEARCH_S, yields=True)
        shape = preview.shape()
        view = self._fine = self._view(preview, self._fine, is_fine=True)
        if self._inbox.has_waiting:
            raise Superseded
        if self._coarse is not None:
            view.rotation = self._coarse.rotation
        frame = view.frame(preview, self._seq, "equilibrium")
        self._send(replace(frame, snapshot=pickle.dumps(preview.snapshot()), seconds=preview.seconds))
        sites = preview.sheet.layout.sheet_sites
        warnings = shape.summary["warnings"]
        notices = [
            Notice(str(line), sites_of(sites, line.stars) if isinstance(line, PlacedWarning) else ())
            for line in warnings
        ]
        numbers = {key: shape.summary[key] for key in SUMMARY_KEYS}
        forms = [Form(index, form.start, 100.0 * form.gap, False) for index, form in enumerate(preview.forms)]
        if forms:
            forms.insert(0, Form(-1, preview.equilibrium.guess, 0.0, True))
        self._send(ShapeSummary(self._seq, numbers, tuple(notices), tuple(forms)))

    def _send_limits(self, design: Design) -> None:
        """Tell what the law covers, where that has changed."""
        law, key = paper_law(), (design.fabric, design.lattice, design.plastic)
        if key == self._limits:
            return
        self._limits = key
        try:
            ranges = law.size_ranges(design.fabric.stretch_xy[0])
        except ForeignLaw:
            ranges = {}
        self._send(Limits(self._seq, ranges, law.stretches))


def run_engine(connection: Connection) -> None:
    """The body of an engine's process: load everything, and serve until the pipe ends.

    Parameters
    ----------
    connection : this process's end of a pipe, with the messages of `asterism.studio.messages`.
    """
    begun = time.monotonic()
    inbox = Inbox(connection.recv)
    law = paper_law()
    if not inbox.has_waiting:
        list(Preview(gallery.load(WARM_UP_DESIGN), law).edit(gallery.load(WARM_UP_DESIGN)))
    connection.send(Ready(time.monotonic() - begun))
    Engine(inbox, connection.send).serve()
