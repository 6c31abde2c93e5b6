"""Sweeps of 60 previews of two designs of the gallery; one of them also stopped and continued; and single designs.

python -m benchmarks.sweep [JOBS]

The sweep is the command as a user types it, so that the times hold imports, pictures and the page.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from asterism.pattern import gallery
from asterism.pattern.design.design import save_design
from asterism.pattern.layout.print_layout import print_layout
from asterism.sweeps.solve_point import solve_point, sweep_code_version
from benchmarks.report import peak_memory_mb, write_report

# a free sheet, and one whose pins let it buckle for some of the values, which takes longer
TUBE = ("--vary", "stars.thickness_mm=0.2:0.6:10", "--vary", "stars.length_mm=6:10:6")
DOME = ("--vary", "stars.thickness_mm=0.2:0.6:10", "--vary", "pins.0.scale=0.7:0.8:6")
# the stop comes when so many designs are finished
STOP_AFTER = 20
SINGLE = ("star", "dome", "tube", "roof", "tunnel", "doubly-curved")


def main() -> None:
    jobs = sys.argv[1] if len(sys.argv) > 1 else "2"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for design in ("tube", "dome"):
            save_design(gallery.load(design), folder / f"{design}.toml")
        # a first run compiles loops
        timed(folder, "warm", jobs, "dome", "--vary", "stars.thickness_mm=0.3,0.4")
        tube = timed(folder, "tube", jobs, "tube", *TUBE)
        whole = timed(folder, "whole", jobs, "dome", *DOME)
        stopped = stopped_after(folder, "stopped", jobs)
        rest = timed(folder, "stopped", jobs, "dome", *DOME)
        again = timed(folder, "stopped", jobs, "dome", *DOME)
        same = (folder / "whole" / "sweep.csv").read_bytes() == (folder / "stopped" / "sweep.csv").read_bytes()
        size = (folder / "whole" / "sweep.html").stat().st_size
    load = f"load of the machine {os.getloadavg()[0]:.1f}"
    lines = [
        f"60 previews, {jobs} processes on {os.cpu_count()} cores; {load}.",
        "",
        "| sweep | wall time, s | processor time, s |",
        "|---|---|---|",
        f"| tube | {tube[0]:.1f} | {tube[1]:.1f} |",
        f"| dome | {whole[0]:.1f} | {whole[1]:.1f} |",
        f"| dome, continued after a kill with {stopped} designs finished | {rest[0]:.1f} | {rest[1]:.1f} |",
        f"| dome once more, all finished | {again[0]:.1f} | {again[1]:.1f} |",
        "",
        f"The tables of the whole and of the continued sweep are {'equal' if same else 'DIFFERENT'}.",
        f"The page has {size / 1e6:.1f} MB.",
    ]
    lines += [
        "",
        "| preview with its picture | stars | processor time, s | memory of the process, MB |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| {name} | {stars} | {seconds:.2f} | {memory:.0f} |" for name, stars, seconds, memory in single_designs()
    ]
    text = "\n".join(lines)
    print(text)
    write_report("sweep", [], text)


def single_designs() -> list[tuple[str, int, float, float]]:
    """Name, stars, processor time (s) and memory of this process (MB) of single designs.

    Each is computed twice, and the second time is given: the first one also loads modules and compiled loops.
    """
    rows = []
    for name in SINGLE:
        design = gallery.load(name)
        for _ in range(2):
            begin = time.process_time()
            outcome = solve_point(design.to_dict(), False, None, sweep_code_version())
            assert outcome.failed is None
        rows.append((name, len(print_layout(design).centres), time.process_time() - begin, peak_memory_mb()))
    return rows


def command(output: str, jobs: str, design: str, *parameters: str) -> list[str]:
    """The words of the command."""
    return [
        sys.executable,
        "-m",
        "asterism",
        "sweep",
        f"{design}.toml",
        "-q",
        "-o",
        output,
        "--jobs",
        jobs,
        *parameters,
    ]


def timed(folder: Path, output: str, jobs: str, design: str, *parameters: str) -> tuple[float, float]:
    """Wall time and processor time of a run in seconds."""
    before, begin = os.times(), time.perf_counter()
    subprocess.run(command(output, jobs, design, *parameters), cwd=folder, check=True, stdout=subprocess.DEVNULL)
    after = os.times()
    used = after.children_user + after.children_system - before.children_user - before.children_system
    return time.perf_counter() - begin, used


def stopped_after(folder: Path, output: str, jobs: str) -> int:
    """Kill a run after `STOP_AFTER` designs; the number of finished designs."""
    kept = folder / output / "designs"
    run = subprocess.Popen(command(output, jobs, "dome", *DOME), cwd=folder, stdout=subprocess.DEVNULL)
    while run.poll() is None and len(list(kept.glob("*.json")) if kept.exists() else []) < STOP_AFTER:
        time.sleep(0.02)
    run.kill()
    run.wait()
    return len(list(kept.glob("*.json")))


if __name__ == "__main__":
    main()
