"""What somebody new waits for: from a checkout to the first verified design, step by step as the README says.

python -m benchmarks.first_hour [DESIGN]

Copies the files of the last commit to a temporary folder, makes a virtual environment there, and has pip fetch all
packages anew. The first verification compiles the model's inner loops, the second finds them. At the end the studio
opens. Seconds are by the clock; those of the installation are mostly the network's. What is seen meanwhile is kept with
the second at which it appeared.
"""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any
from urllib.request import urlopen

from benchmarks.report import markdown, write_report

ROOT = Path(__file__).parents[1]
SCRIPTS = "Scripts" if sys.platform == "win32" else "bin"
# the line of the studio with the address of its page
ADDRESS = "studio: "
WAIT_S = 30.0
HEADER = ["step", "seconds", "first line after", "longest silence", "lines"]


def steps(design: str) -> list[tuple[str, list[str]]]:
    """What is done, and how; paths are relative to the copy."""
    tools = Path(".venv") / SCRIPTS
    verify = [str(tools / "asterism"), "verify", f"{design}.toml", "-o"]
    return [
        ("virtual environment", [sys.executable, "-m", "venv", ".venv"]),
        ("install", [str(tools / "pip"), "install", "--no-cache-dir", "--progress-bar", "off", "."]),
        (f"`asterism new {design}`", [str(tools / "asterism"), "new", design, "-o", f"{design}.toml"]),
        (f"`asterism verify {design}.toml`, the first time", [*verify, design]),
        ("the second time", [*verify, f"{design}-again"]),
        (f"`asterism preview {design}.toml`", [str(tools / "asterism"), "preview", f"{design}.toml", "-o", "preview"]),
    ]


def copied(folder: Path) -> None:
    """The files that the checkout's last commit holds."""
    archive = folder.with_suffix(".tar")
    subprocess.run(["git", "archive", "-o", str(archive), "HEAD"], cwd=ROOT, check=True)
    folder.mkdir()
    subprocess.run(["tar", "xf", str(archive), "-C", str(folder)], check=True)


def step(name: str, command: list[str], folder: Path) -> dict[str, Any]:
    """Run one, and see when it says what."""
    start = time.perf_counter()
    said: list[tuple[float, str]] = []
    running = begun(name, command, folder)
    assert running.stdout is not None
    for line in running.stdout:
        said.append((time.perf_counter() - start, line.rstrip()))
    status = running.wait()
    seconds = time.perf_counter() - start
    if status != 0:
        raise SystemExit("\n".join([f"{name}: exit status {status}", *(text for _, text in said[-20:])]))
    return record(name, seconds, said)


def page(folder: Path) -> dict[str, Any]:
    """Start the studio without a browser, and end it when its page has answered."""
    name = "`asterism studio`, until its page answers"
    start = time.perf_counter()
    said: list[tuple[float, str]] = []
    running = begun(name, [str(Path(".venv") / SCRIPTS / "asterism"), "studio", "--no-browser"], folder)
    assert running.stdout is not None
    try:
        for line in running.stdout:
            said.append((time.perf_counter() - start, line.rstrip()))
            if line.startswith(ADDRESS):
                with urlopen(line.removeprefix(ADDRESS).strip(), timeout=WAIT_S) as answer:
                    answer.read()
                return record(name, time.perf_counter() - start, said)
    finally:
        running.terminate()
        running.wait()
    raise SystemExit("\n".join([f"{name}: no address", *(text for _, text in said[-20:])]))


def begun(name: str, command: list[str], folder: Path) -> subprocess.Popen[str]:
    """The process of a step, which has nothing that an earlier installation has kept for later."""
    print(f"{name} ...", flush=True)
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "VIRTUAL_ENV"))}
    environment |= {"XDG_CACHE_HOME": str(folder / "cache"), "MPLCONFIGDIR": str(folder / "cache" / "matplotlib")}
    return subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )


def record(name: str, seconds: float, said: list[tuple[float, str]]) -> dict[str, Any]:
    """What is kept of a step."""
    times = [0.0, *(when for when, _ in said), seconds]
    silence = max(after - before for before, after in itertools.pairwise(times))
    return {"step": name, "seconds": seconds, "silence_s": silence, "lines": len(said), "said": said}


def row(r: dict[str, Any]) -> list[str]:
    """One line of the table."""
    first = f"{r['said'][0][0]:.1f}" if r["said"] else "-"
    return [r["step"], f"{r['seconds']:.1f}", first, f"{r['silence_s']:.1f}", str(r["lines"])]


def main(design: str = "dome") -> None:
    rows: list[dict[str, Any]] = []
    busy = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / "checkout"
        copied(folder)
        for name, command in steps(design):
            rows.append(step(name, command, folder))
        # the page does not wait for compiled loops, so the steps before do not make it faster
        rows.append(page(folder))
    whole = sum(r["seconds"] for r in rows[:4])
    opened = sum(r["seconds"] for r in [*rows[:2], rows[-1]])
    seen = "\n".join(f"{when:6.1f} s  {text}" for when, text in rows[3]["said"])
    text = "\n\n".join(
        [
            f"From nothing to the first report: {whole:.0f} s, to the studio's page: {opened:.0f} s. "
            f"{busy:.1f} programs wanted the cores at the beginning.",
            markdown(HEADER, [row(r) for r in rows]),
            f"What the first verification says, and when:\n\n```\n{seen}\n```",
        ]
    )
    print(text)
    # what pip says is about its packages and this machine's folders
    rows[1]["said"] = []
    write_report("first_hour", rows, text)


if __name__ == "__main__":
    main(*sys.argv[1:2])
