"""What an edit costs in the studio: from an edit to the vertices of the sheet, without drawing.

python -m benchmarks.studio [DESIGN ...]

For each kind of edit the median and the 95 % quantile, in milliseconds by the clock and of the processor, from the
engine's answer to an edit as the page sends it to its first frame (linear response) and to the equilibrium. `brush`
changes the stars within a circle, and gives those of the stroke before their size back; `all stars` changes each star.
A restart has no linear response. `pictures` are frames a second while edits come at 60 a second, as in a drag of the
brush with both stages; these and the start are measured with the engine in a process of its own.
"""

from __future__ import annotations

import os
import queue
import resource
import sys
import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from asterism.pattern import gallery
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.studio.child import ENGINE, StartedProcess
from asterism.studio.engine import Engine
from asterism.studio.engine_orders import Edit, Stop
from asterism.studio.inbox import Inbox
from asterism.studio.messages import Frame, Ready, StudioProblem
from benchmarks.report import markdown, write_report

DESIGNS = ("dome", "u-shape")
BRUSHES = 40
RESTARTS = 12
WARM_UP = 5
BRUSH_MM = 25.0  # radius; the page begins with 20 mm on the dome
DRAG_S = 5.0
EDITS_PER_SECOND = 60.0
SHARED = (
    "Above one process a core, times by the clock are longer than on an idle machine, and fewer pictures are made. "
    "Times of the processor are near those of an idle core."
)
COLUMNS = [
    "design", "edit", "count", "linear ms", "95 %", "processor ms", "95 %", "equilibrium ms", "95 %", "processor ms",
    "95 %",
]  # fmt: skip
TARGETS = {
    "dome": {"brush": (20.0, 50.0), "corner": (None, 200.0), "needle": (None, 200.0)},
    "u-shape": {"brush": (45.0, 130.0), "corner": (None, 400.0), "needle": (None, 400.0)},
}


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
    border = {key: value for key, value in data["border"].items() if key not in ("rings", "rectangle_mm", "polygon_mm")}
    number = 0
    while True:
        number += 1
        way = 0.5 + 0.5 * float(rng.random())
        if kind == "brush":
            yield {"sites": plan.sheet_sites, "sizes_mm": brushed(plan, rng, BRUSH_MM)}
        elif kind == "all stars":
            yield {"sites": plan.sheet_sites, "sizes_mm": brushed(plan, rng, 2.0 * plan.diameter_mm)}
        elif kind == "corner":
            moved = [[x * (1.0 - 0.02 * way), y] if i == 0 else [x, y] for i, (x, y) in enumerate(corners)]
            yield {"design": data | {"border": border | {"polygon_mm": moved}}}
        elif kind == "needle":
            yield {"design": data | {"pins": [_moved_pins(pins, way) for pins in data["pins"]]}}
        else:
            raise ValueError(kind)


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
        self.ask(design=gallery.load(name).to_dict())

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
        self._engine.answer(Edit(self._seq, **fields))
        return self._marks


def row(name: str, kind: str, count: int) -> dict[str, Any]:
    """Times of one kind of edit."""
    timer, source = Timer(name), edits(name, kind)
    for _ in range(WARM_UP):
        timer.ask(**next(source))
    times = [timer.ask(**next(source)) for _ in range(count)]
    out: dict[str, Any] = {"design": name, "edit": kind, "count": count}
    for stage in ("linear", "equilibrium"):
        found = np.array([each[stage] for each in times if stage in each])
        for column, clock in enumerate(("wall", "processor")):
            values = found[:, column] if len(found) else np.array([np.nan])
            out[f"{stage}_{clock}_ms"] = [float(np.quantile(values, share)) for share in (0.5, 0.95)]
    return out


def _started(name: str) -> StartedProcess:
    """An engine's process that has been asked for a design."""
    started = StartedProcess(ENGINE)
    started.connection.send(Edit(1, gallery.load(name).to_dict()))
    return started


def _stop(started: StartedProcess) -> None:
    started.connection.send(Stop())
    started.process.join(30.0)
    started.process.kill()


def start_row(name: str) -> dict[str, Any]:
    """Seconds by the clock from the start of an engine's process to its first picture, and of its processor in all."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begun = time.perf_counter()
    started = _started(name)
    ready = first = None
    while first is None:
        message = started.connection.recv()
        if isinstance(message, Ready):
            ready = time.perf_counter() - begun
        if isinstance(message, Frame):
            first = time.perf_counter() - begun
    _stop(started)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"design": name, "ready_s": ready, "first_picture_s": first, "processor_s": processor}


def drag_row(name: str) -> dict[str, Any]:
    """Frames a second in a drag of the brush."""
    started = _started(name)
    ours = started.connection
    while not isinstance(ours.recv(), Frame):
        pass
    source, frames, seq = edits(name, "brush"), {"linear": 0, "equilibrium": 0}, 1
    delays: list[float] = []
    asked: dict[int, float] = {}
    begun = time.perf_counter()
    while (now := time.perf_counter() - begun) < DRAG_S:
        if now > (seq - 1) / EDITS_PER_SECOND:
            seq += 1
            asked[seq] = time.perf_counter()
            ours.send(Edit(seq, is_dragging=True, **next(source)))
        while ours.poll(max(seq / EDITS_PER_SECOND - (time.perf_counter() - begun), 0.0)):
            message = ours.recv()
            if isinstance(message, Frame) and message.seq > 1:
                frames[message.stage] += 1
                delays.append(1e3 * (time.perf_counter() - asked[message.seq]))
    _stop(started)
    return {
        "pictures_per_s": sum(frames.values()) / DRAG_S,
        "equilibria_per_s": frames["equilibrium"] / DRAG_S,
        "edit_to_picture_ms": [float(np.quantile(delays, share)) for share in (0.5, 0.95)],
    }


def table(rows: list[dict[str, Any]]) -> str:
    """Times of edits."""
    lines = []
    for each in rows:
        cells = [each["design"], each["edit"], str(each["count"])]
        for stage in ("linear", "equilibrium"):
            for clock in ("wall", "processor"):
                cells += ["-" if np.isnan(value) else f"{value:.0f}" for value in each[f"{stage}_{clock}_ms"]]
        lines.append(cells)
    return markdown(COLUMNS, lines)


def process_table(rows: list[dict[str, Any]]) -> str:
    """Starts and drags."""
    columns = [
        "design",
        "ready s",
        "first picture s",
        "processor s",
        "pictures/s",
        "equilibria/s",
        "edit to picture ms",
        "95 %",
    ]
    return markdown(
        columns,
        [
            [
                each["design"],
                f"{each['ready_s']:.1f}",
                f"{each['first_picture_s']:.1f}",
                f"{each['processor_s']:.1f}",
                f"{each['pictures_per_s']:.0f}",
                f"{each['equilibria_per_s']:.0f}",
                *(f"{value:.0f}" for value in each["edit_to_picture_ms"]),
            ]
            for each in rows
        ],
    )


def missed(rows: list[dict[str, Any]]) -> list[str]:
    """Medians above what the studio is to reach."""
    out = []
    for each in rows:
        targets = TARGETS.get(each["design"], {}).get(each["edit"], (None, None))
        for stage, most in zip(("linear", "equilibrium"), targets, strict=True):
            value, processor = (each[f"{stage}_{clock}_ms"][0] for clock in ("wall", "processor"))
            if most is not None and value > most:
                times = f"{stage} after {value:.0f} ms, of the processor {processor:.0f} ms"
                out.append(f"{each['design']}, {each['edit']}: {times}; aim {most:.0f} ms")
    return out


def main(names: list[str]) -> None:
    """Measure and print the tables, and write them if all designs are measured."""
    load = os.getloadavg()[0]
    kinds = {"brush": BRUSHES, "all stars": BRUSHES, "corner": RESTARTS, "needle": RESTARTS}
    rows = [row(name, kind, count) for name in names or DESIGNS for kind, count in kinds.items()]
    between = os.getloadavg()[0]
    processes = [start_row(name) | drag_row(name) for name in names or DESIGNS]
    shared = f"Load average of the {os.cpu_count()} cores before the first run, between the tables and at the end: "
    parts = [
        f"{shared}{load:.1f}, {between:.1f}, {os.getloadavg()[0]:.1f}. {SHARED}",
        table(rows),
        process_table(processes),
    ]
    if misses := missed(rows):
        parts.append("Missed aims:\n\n" + "\n".join(f"- {line}" for line in misses))
    text = "\n\n".join(parts)
    print(text)
    if not names:
        write_report("studio", [*rows, *processes], text)


if __name__ == "__main__":
    main(sys.argv[1:])
