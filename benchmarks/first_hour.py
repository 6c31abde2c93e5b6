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
from urllib.request import urlopen

from benchmarks.report import markdown, write_report

ROOT = Path(__file__).parents[1]
# the line of the studio with the address of its page
ADDRESS = "studio: "
WAIT_S = 30.0
Row = tuple[str, float, list[tuple[float, str]]]
HEADER = ["step", "seconds", "first line after", "longest silence", "lines"]


def steps(design: str) -> list[tuple[str, list[str]]]:
    """What is done, and how; paths are relative to the copy."""
    tools = Path(".venv") / "bin"
    verify = [str(tools / "asterism"), "verify", f"{design}.toml", "-o"]
    return [
        ("virtual environment", [sys.executable, "-m", "venv", ".venv"]),
        ("install", [str(tools / "pip"), "install", "--no-cache-dir", "--progress-bar", "off", "."]),
        (f"`asterism new {design}`", [str(tools / "asterism"), "new", design, "-o", f"{design}.toml"]),
        (f"`asterism verify {design}.toml`, the first time", [*verify, design]),
        ("the second time", [*verify, f"{design}-again"]),
        (f"`asterism preview {design}.toml`", [str(tools / "asterism"), "preview", f"{design}.toml", "-o", "preview"]),
        # the page does not wait for compiled loops, so the steps before do not make it faster
        ("`asterism studio`, until its page answers", [str(tools / "asterism"), "studio", "--no-browser"]),
    ]


def copied(folder: Path) -> None:
    """The files that the checkout's last commit holds."""
    archive = folder.with_suffix(".tar")
    subprocess.run(["git", "archive", "-o", str(archive), "HEAD"], cwd=ROOT, check=True)
    folder.mkdir()
    subprocess.run(["tar", "xf", str(archive), "-C", str(folder)], check=True)


def step(name: str, command: list[str], folder: Path) -> Row:
    """Run one, and see when it says what; the studio ends when its page has answered."""
    print(f"{name} ...", flush=True)
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "VIRTUAL_ENV"))}
    # nothing that an earlier installation has kept for later
    environment |= {"XDG_CACHE_HOME": str(folder / "cache"), "MPLCONFIGDIR": str(folder / "cache" / "matplotlib")}
    start, said, is_open = time.perf_counter(), list[tuple[float, str]](), False
    running = subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    assert running.stdout is not None
    for line in running.stdout:
        said.append((time.perf_counter() - start, line.rstrip()))
        if line.startswith(ADDRESS):
            with urlopen(line.removeprefix(ADDRESS).strip(), timeout=WAIT_S) as answer:
                answer.read()
            is_open = True
            running.terminate()
            break
    seconds = time.perf_counter() - start
    if running.wait() != 0 and not is_open:
        raise SystemExit("\n".join([f"{name}: exit status {running.returncode}", *(text for _, text in said[-20:])]))
    return name, time.perf_counter() - start if not is_open else seconds, said


def row(name: str, seconds: float, said: list[tuple[float, str]]) -> list[str]:
    """One line of the table."""
    times = [0.0, *(when for when, _ in said), seconds]
    silence = max(after - before for before, after in itertools.pairwise(times))
    return [name, f"{seconds:.1f}", f"{said[0][0]:.1f}" if said else "-", f"{silence:.1f}", str(len(said))]


def main(design: str = "dome") -> None:
    busy = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / "checkout"
        copied(folder)
        rows = [step(name, command, folder) for name, command in steps(design)]
    seconds = [row[1] for row in rows]
    seen = "\n".join(f"{when:6.1f} s  {text}" for when, text in rows[3][2])
    text = "\n\n".join(
        [
            f"From nothing to the first report: {sum(seconds[:4]):.0f} s, to the studio's page: "
            f"{sum(seconds[:2]) + seconds[-1]:.0f} s. {busy:.1f} programs wanted the cores at the beginning.",
            markdown(HEADER, [row(*each) for each in rows]),
            f"What the first verification says, and when:\n\n```\n{seen}\n```",
        ]
    )
    print(text)
    write_report("first_hour", text)


if __name__ == "__main__":
    main(*sys.argv[1:2])
