"""Build archive and wheel, and run the wheel in a fresh environment of each version of Python that is there.

    python3 .ci/wheels.py                 # all versions that asterism supports and this machine has
    python3 .ci/wheels.py 3.12            # these

Each environment has the packages of the index, and no checkout. The commands run in it as installed; with the first
version also without MKL, where scipy's SuperLU takes over, and where neither the installation nor the home folder can
be written, so that numba keeps no machine code. Needs a package index. Exit status 1: a version has failed.
"""

from __future__ import annotations

import json
import os
import shutil
import stat
import subprocess
import sys
import tempfile
import time
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).parents[1]
VERSIONS = ("3.11", "3.12", "3.13")
# packages of the solver PARDISO
MKL = ("pypardiso", "mkl")
# takes from root the right to write everywhere
WITHOUT_RIGHTS = ("setpriv", "--bounding-set=-all", "--inh-caps=-all")
KEPT_OUT = shutil.ignore_patterns(".git", ".venv", "build", "dist", "*.egg-info", "__pycache__", ".*_cache")


def main() -> int:
    """Run everything, and print one line for each version."""
    wanted = sys.argv[1:] or VERSIONS
    with tempfile.TemporaryDirectory(prefix="asterism-wheels-") as name:
        room = Path(name)
        room.chmod(0o755)
        wheel = build(room)
        there = {version: python for version in wanted if (python := find(version)) is not None}
        for version in wanted:
            if version not in there:
                print(f"{version}: not on this machine", flush=True)

        def tried(version: str) -> bool:
            begin = time.perf_counter()
            try:
                shown = try_out(there[version], wheel, room / version, in_all_ways=version == next(iter(there)))
            except (subprocess.CalledProcessError, AssertionError) as error:
                output = getattr(error, "stderr", None) or getattr(error, "output", None) or error
                print(f"{version}: failed: {output}", flush=True)
                return False
            print(f"{version}: {', '.join(shown)}; {time.perf_counter() - begin:.0f} s", flush=True)
            return True

        # one installs while another computes
        with ThreadPoolExecutor(max_workers=2) as pool:
            return 0 if all(pool.map(tried, there)) else 1


def find(version: str) -> Path | None:
    """A working interpreter of a version: from the path, or from pyenv."""
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    named = shutil.which(f"python{version}")
    candidates = [Path(named)] if named else []
    candidates += sorted(pyenv.glob(f"{version}.*/bin/python"))
    ask = ["-c", "import sys; print('%d.%d' % sys.version_info[:2])"]
    for candidate in candidates:
        said = subprocess.run([candidate, *ask], capture_output=True, text=True)
        if said.returncode == 0 and said.stdout.strip() == version:
            return candidate
    return None


def build(room: Path) -> Path:
    """The wheel, built from the archive: what the archive lacks, the wheel lacks too."""
    copy = room / "checkout"
    shutil.copytree(ROOT, copy, ignore=KEPT_OUT)
    tools = environment(Path(sys.executable), room / "tools")
    run([tools, "-m", "pip", "install", "--quiet", "build"])
    run([tools, "-m", "build", "--outdir", str(room / "dist"), str(copy)])
    shutil.rmtree(copy)
    (wheel,) = (room / "dist").glob("*.whl")
    assert len(list((room / "dist").glob("*.tar.gz"))) == 1
    with zipfile.ZipFile(wheel) as packed:
        names = set(packed.namelist())
    # one name, so that nothing of another project is overwritten
    assert {name.split("/")[0].split("-")[0] for name in names} == {"asterism", "asterism_fabric"}
    assert "asterism/py.typed" in names
    for folder in ("page", "gallery"):
        files = {f.relative_to(ROOT).as_posix() for f in (ROOT / "asterism/studio" / folder).rglob("*") if f.is_file()}
        assert files and files <= names, files - names
    return wheel


def try_out(python: Path, wheel: Path, place: Path, in_all_ways: bool) -> list[str]:
    """Install the wheel, and run it, in three ways if asked; returns what each way showed."""
    installed = environment(python, place / "venv")
    run([installed, "-m", "pip", "install", "--quiet", f"{wheel}[mkl]"])
    shown = [f"{solve(installed, place / 'first', ('preview', 'simulate'))} as installed"]
    if not in_all_ways:
        return shown
    run([installed, "-m", "pip", "uninstall", "--quiet", "--yes", *MKL])
    without_mkl = solve(installed, place / "second")
    assert without_mkl == "superlu", without_mkl
    shown.append(f"{without_mkl} without MKL")
    for kept in list((place / "venv").rglob("__pycache__")):
        shutil.rmtree(kept)
    folders = [
        place / "venv",
        *(path for path in (place / "venv").rglob("*") if path.is_dir() and not path.is_symlink()),
    ]
    for folder in folders:
        folder.chmod(folder.stat().st_mode & ~(stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH))
    try:
        third = solve(installed, place / "third", can_write=False)
    finally:
        for folder in folders:
            folder.chmod(folder.stat().st_mode | stat.S_IWUSR)
    if third:
        shown.append("without a folder for compiled code")
    return shown


def solve(python: Path, folder: Path, commands: tuple[str, ...] = ("simulate",), can_write: bool = True) -> str:
    """Compute one star as a newcomer does; returns the name of the linear solver, "" if left out.

    One start of `simulate`, the last command, is a preview.
    """
    folder.mkdir(parents=True)
    settings = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "NUMBA"))}
    before: tuple[str, ...] = ()
    if not can_write:
        home = folder / "home"
        home.mkdir(mode=0o555)
        settings |= {"HOME": str(home), "XDG_CACHE_HOME": str(home), "XDG_CONFIG_HOME": str(home)}
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            if shutil.which(WITHOUT_RIGHTS[0]) is None:
                print(f"{WITHOUT_RIGHTS[0]} is not installed: root can write everywhere, so this way is left out")
                return ""
            before = WITHOUT_RIGHTS

    def asterism(*words: str) -> subprocess.CompletedProcess[str]:
        return run([*before, python, "-I", "-m", "asterism", *words], cwd=folder, env=settings)

    assert "canopy" in asterism("new").stdout and "ultimaker2" in asterism("printers").stdout
    assert "paper" in asterism("materials").stdout
    asterism("new", "star", "-o", "star.toml")
    done = [asterism(word, "star.toml", "-o", word) for word in commands]
    if not can_write:
        assert all("no folder for compiled code can be written" in each.stderr for each in done), done[0].stderr
    summaries = [json.loads((folder / word / "summary.json").read_text(encoding="utf-8")) for word in commands]
    assert all(summary["is_minimum"] for summary in summaries)
    return str(summaries[-1]["backend"])


def environment(python: Path, place: Path) -> Path:
    """The interpreter of a new virtual environment."""
    run([python, "-m", "venv", str(place)])
    return place / ("Scripts" if os.name == "nt" else "bin") / "python"


def run(words: list[object], **options: object) -> subprocess.CompletedProcess[str]:
    """Run a program; its output is in the error if it fails."""
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True, **options)  # type: ignore[call-overload,no-any-return]


if __name__ == "__main__":
    sys.exit(main())
