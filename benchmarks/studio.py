"""What an edit costs in the studio: from an edit to the vertices of the sheet, without drawing.

python -m benchmarks.studio [DESIGN ...]    (with names of the gallery: these only, no report)

For each kind of edit the median and the 95 % quantile, in milliseconds by the clock and of the processor, from the
engine's answer to an edit as the page sends it to its first frame (linear response) and to the equilibrium. `brush`
changes the stars within a circle, and gives those of the stroke before their size back; `all stars` changes each star.
A restart has no linear response. The start is that of an engine in a process of its own.
"""

from __future__ import annotations

import os
import queue
import sys
import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from asterism.pattern import gallery
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.studio.child import ENGINE, Child
from asterism.studio.drawing import OUTLINE_KEYS
from asterism.studio.engine import Engine
from asterism.studio.inbox import Inbox
from asterism.studio.messages import Edit, Frame, StudioProblem
from benchmarks.report import markdown, write_report

DESIGNS = ("dome", "u-shape")
BRUSHES = 40
RESTARTS = 12
WARM_UP = 5
COLUMNS = [
    "design", "edit", "count", "linear ms", "95 %", "processor ms", "95 %", "equilibrium ms", "95 %", "processor ms",
    "95 %",
]  # fmt: skip


def brushed(plan: Layout, rng: np.random.Generator, radius_mm: float) -> np.ndarray:
    """(P, 3) sizes after a stroke of the brush somewhere on the sheet, as the page paints; only lengths change."""
    places = plan.lattice.place(plan.sheet_sites)
    centre = places[rng.integers(len(places))]
    touched = np.clip(1.0 - (np.linalg.norm(places - centre, axis=1) / radius_mm) ** 2, 0.0, None) ** 2
    length = np.clip(plan.site_sizes_mm[:, 0] - 0.5 * rng.random() * touched, 2.0, None)
    return np.column_stack([length, np.full((len(length), 2), np.nan)])


def edits(name: str, kind: str) -> Iterator[dict[str, Any]]:
    """Fields of `Edit`, for ever."""
    rng = np.random.default_rng(0)
    data = gallery.load(name).to_dict()
    plan = layout(gallery.load(name))
    corners = plan.outline.tolist()
    border = {key: value for key, value in data["border"].items() if key not in OUTLINE_KEYS}
    while True:
        way = 0.5 + 0.5 * float(rng.random())
        if kind == "brush":
            # radius; the page begins with 20 mm on the dome
            yield {"sites": plan.sheet_sites, "sizes_mm": brushed(plan, rng, 25.0)}
        elif kind == "all stars":
            yield {"sites": plan.sheet_sites, "sizes_mm": brushed(plan, rng, 2.0 * plan.diameter_mm)}
        elif kind == "corner":
            moved = [[x * (1.0 - 0.02 * way), y] if i == 0 else [x, y] for i, (x, y) in enumerate(corners)]
            yield {"design": data | {"border": border | {"polygon_mm": moved}}}
        else:
            yield {"design": data | {"pins": [_moved_pins(pins, way) for pins in data["pins"]]}}


def _moved_pins(pins: dict[str, Any], way: float) -> dict[str, Any]:
    """Pins of which the first is lifted by some millimetres; a held border gets another scale."""
    if pins.get("points_mm"):
        (x, y, _), *others = [[pins["scale"] * x, pins["scale"] * y, 0.0] for x, y in pins["points_mm"]]
        return {"points_mm": pins["points_mm"], "target_mm": [[x, y, 4.0 * way], *others]}
    return pins | {"scale": pins["scale"] * (1.0 - 0.04 * way)}


class Timer:
    """An engine in this process, and the times of its frames."""

    def __init__(self, name: str) -> None:
        self._waiting: queue.Queue[Any] = queue.Queue()
        self._engine = Engine(Inbox(self._waiting.get), self._sent)
        self._marks: dict[str, tuple[float, float]] = {}
        self._seq = 0
        self._design = gallery.load(name).to_dict()
        self.ask()

    def _sent(self, message: Any) -> None:
        if isinstance(message, StudioProblem):
            raise RuntimeError(message.text)
        if isinstance(message, Frame):
            wall, processor = self._begun
            times = 1e3 * (time.perf_counter() - wall), 1e3 * (time.process_time() - processor)
            self._marks[message.stage] = times

    def ask(self, **fields: Any) -> dict[str, tuple[float, float]]:
        """Milliseconds by the clock and of the processor, to each stage of an edit."""
        self._seq, self._marks = self._seq + 1, {}
        self._begun = time.perf_counter(), time.process_time()
        self._engine.answer(Edit(self._seq, **{"design": self._design, **fields}))
        return self._marks


def row(name: str, kind: str, count: int) -> list[str]:
    """One line of the table."""
    timer, source = Timer(name), edits(name, kind)
    for _ in range(WARM_UP):
        timer.ask(**next(source))
    times = [timer.ask(**next(source)) for _ in range(count)]
    cells = [name, kind, str(count)]
    for stage in ("linear", "equilibrium"):
        found = np.array([each[stage] for each in times if stage in each])
        for values in found.T if len(found) else ():
            cells += [f"{np.quantile(values, share):.0f}" for share in (0.5, 0.95)]
        cells += [] if len(found) else 4 * ["-"]
    return cells


def first_picture_s(name: str) -> float:
    """Seconds by the clock from the start of an engine's process to its first picture."""
    begun = time.perf_counter()
    started = Child(ENGINE)
    started.connection.send(Edit(1, gallery.load(name).to_dict()))
    while not isinstance(started.connection.recv(), Frame):
        pass
    seconds = time.perf_counter() - begun
    started.connection.close()
    started.process.join(30.0)
    started.process.kill()
    return seconds


def main(names: list[str]) -> None:
    """Measure and print, and write the report if all designs are measured."""
    load = os.getloadavg()[0]
    kinds = {"brush": BRUSHES, "all stars": BRUSHES, "corner": RESTARTS, "needle": RESTARTS}
    rows = [row(name, kind, count) for name in names or DESIGNS for kind, count in kinds.items()]
    starts = ", ".join(f"{name} {first_picture_s(name):.1f} s" for name in names or DESIGNS)
    text = "\n\n".join(
        [
            f"Load average of the {os.cpu_count()} cores before and after: {load:.1f}, {os.getloadavg()[0]:.1f}. Above "
            "one process a core, times by the clock are longer than on idle cores.",
            markdown(COLUMNS, rows),
            f"First picture after the start of the engine: {starts}.",
        ]
    )
    print(text)
    if not names:
        write_report("studio", text)


if __name__ == "__main__":
    main(sys.argv[1:])
