"""The process of the studio that computes exact shapes: it stays, and waits for the next one.

A function imports what it needs: the solvers take most of a second.
"""

from __future__ import annotations

import pickle
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any

from asterism.equilibrium.errors import Error
from asterism.pattern.design.design import Design
from asterism.studio.answers import engine_problem
from asterism.studio.job_processes import ProgressSender, settled
from asterism.studio.messages import Released, Settle, Settled

if TYPE_CHECKING:
    from asterism.shape.shape import Shape

# The release begins when the exact shape has been left alone for so long.
REST_BEFORE_RELEASE_S = 1.0


class _Newer(BaseException):
    """The shape is not wanted any more; no handler of errors on the way may keep it."""


def run_settling(connection: Connection) -> None:
    """Compute one exact shape after the other; a further message ends the one under way.

    Parameters
    ----------
    connection : the process's end of a pipe. It gets `Settle`, or None for no shape, and gives `JobProgress`, then
        `Settled` or `StudioProblem`, and then `Released` if that is asked for.
    """
    from asterism.exact.simulation import exact_shape
    from asterism.pattern import gallery

    exact_shape(gallery.load("star"))  # loads the compiled loops
    known: ExactForms | None = None
    while True:
        order: Settle | None = connection.recv()
        if order is None or connection.poll():
            continue
        design: Design | None = None
        try:
            design = Design.from_dict(order.table, order.folder)
            if known is None or not known.is_of(order):
                known = ExactForms(order, design, connection)
            connection.send(known.settled(order))
            if order.release_mesh is not None and (known.has_release or not connection.poll(REST_BEFORE_RELEASE_S)):
                connection.send(known.released(order))
        except _Newer:
            continue
        except Exception as error:
            connection.send(engine_problem(order.job, error, design))


@dataclass(frozen=True)
class _Release:
    """Where the release ended; the attributes are those of `Released`."""

    is_same: bool | None
    other: Shape | None = None
    energy_percent: float = 0.0
    apart_percent: float = 0.0


class ExactForms:
    """The exact shape that follows the preview of a design, and the one that its release from the flat print leads to.

    Parameters
    ----------
    order : with the preview.
    design : the same design.
    connection : gets the progress; a message in it ends the computation.

    Raises
    ------
    Error
        The design has no exact shape.
    """

    def __init__(self, order: Settle, design: Design, connection: Connection) -> None:
        from asterism.exact.simulation import shared_search
        from asterism.pattern.layout.build import layout

        self._order, self._design, self._connection = order, design, connection
        self._plan = layout(design)
        self._near: Shape | None = None if order.near is None else pickle.loads(order.near)
        self._search = shared_search(design, self._plan)
        self._exact = self._solved("exact shape", order.job, self._near)
        self._released: _Release | None = None

    def is_of(self, order: Settle) -> bool:
        """Whether an order is about the same design and preview."""
        return self._order.near == order.near and self._order.table == order.table

    @property
    def has_release(self) -> bool:
        """Whether the release is known already."""
        return self._released is not None

    def settled(self, order: Settle) -> Settled:
        """The exact shape that follows the preview."""
        return self._message(order, self._exact, order.job)

    def released(self, order: Settle) -> Released:
        """The shape that the release from the flat print leads to."""
        assert order.release_mesh is not None
        self._released = release = self._released or self._release(order.job)
        if release.other is None:
            return Released(order.job, release.is_same)
        other = self._message(order, release.other, order.release_mesh)
        return Released(order.job, False, other, release.energy_percent, release.apart_percent)

    def _release(self, job: int) -> _Release:
        from asterism.discrete.release.forms import SAME_FORM_PERCENT
        from asterism.pattern.layout.symmetries import symmetries
        from asterism.verification.minima import gap, same_minimum

        exact = self._exact
        try:
            shape = self._solved("release", job, None)
        except (Error, FloatingPointError):
            return _Release(None)
        if not shape.summary["is_minimum"]:
            return _Release(None)
        same = symmetries(self._design, self._plan)
        is_same, between = same_minimum(exact, shape, self._plan, same, self._design.gravity.pull)
        if is_same or (not exact.summary["is_minimum"] and between.rms_percent < SAME_FORM_PERCENT):
            return _Release(True)
        sign = 1.0 if shape.summary["energy_n_mm"] >= exact.summary["energy_n_mm"] else -1.0
        return _Release(False, shape, sign * 100.0 * gap(exact.summary, shape.summary), between.rms_percent)

    def _solved(self, stage: str, job: int, near: Shape | None) -> Shape:
        from asterism.exact.simulation import exact_shape
        from asterism.verification.progress import ExactProgress

        counted = ExactProgress(stage, ProgressSender(self._connection, job))

        def watched(name: str, iteration: Any) -> None:
            if self._connection.poll():
                raise _Newer
            counted.report(name, iteration)

        return exact_shape(self._design, report=watched, near=near, plan=self._plan, shared=self._search)

    def _message(self, order: Settle, shape: Shape, number: int) -> Settled:
        from asterism.studio.engine_frames import TargetComparison

        message = settled(number, shape, self._near, order.pose, order.parts.smooth)
        if order.parts.target is None:
            return message
        compared = TargetComparison(order.parts.target, order.parts.version)
        distance = compared.distance(message.frame.positions, shape.weights)
        return replace(message, frame=replace(message.frame, target=distance))
