"""Commands start in environments that are not as usual, or name the cause in one line."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from asterism.equilibrium.linear.backends import available

SMALL = "[stars]\nlength_mm = 10.0\nwidth_mm = 1.2\n[border]\nrings = 0\n[mesh]\nedge_mm = 4.0\n"
# a user without a home and without an entry in the system's list of users
NOBODY = """
import os, pwd
os.environ.pop("HOME", None)
def getpwuid(number):
    raise KeyError(number)
pwd.getpwuid = getpwuid
"""


def run(folder: Path, *words: str, before: str = "", **environment: str) -> subprocess.CompletedProcess[str]:
    program = f"{before}\nfrom asterism.cli.main import main\nif __name__ == '__main__':\n    main()"
    return subprocess.run(
        [sys.executable, "-c", program, *words],
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=300,
    )


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "d.toml").write_text(SMALL)
    return tmp_path


@pytest.mark.slow
@pytest.mark.skipif("pardiso" not in available(), reason="PARDISO is not installed")
def test_mkl_runs_whatever_layer_the_environment_names(folder: Path) -> None:
    """Conda's activation names one that pip's MKL has no library of."""
    done = run(folder, "simulate", "d.toml", "--backend", "pardiso", MKL_INTERFACE_LAYER="LP64,GNU")
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_settings_of_threads_windows_and_compilation_do_not_matter(folder: Path) -> None:
    threads = {"NUMBA_NUM_THREADS": "0", "OMP_NUM_THREADS": "0"}
    done = run(folder, "report", "d.toml", **threads, MPLBACKEND="nosuch", NUMBA_DISABLE_JIT="1")
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Windows has no list of users")
def test_without_a_home(folder: Path) -> None:
    """The commands that look there, in one process."""
    commands = [["export", "d.toml"], ["materials"], ["printers"]]
    each = f"import sys\nfrom asterism.cli.main import main\nfor words in {commands!r}:\n"
    each += "    sys.argv = ['asterism', *words]\n    try:\n        main()\n"
    each += "    except SystemExit as end:\n        assert not end.code, words\n"
    done = run(folder, "preview", "d.toml", before=f"{NOBODY}\n{each}sys.argv = ['asterism', 'preview', 'd.toml']")
    assert done.returncode == 0 and "writable" not in done.stderr, done.stderr


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="the streams of Windows are others")
@pytest.mark.parametrize(("name", "status"), [("d.toml", 0), ("none.toml", 2)])
def test_a_closed_standard_error(name: str, status: int, folder: Path) -> None:
    words = [sys.executable, "-m", "asterism", "preview", name]
    closed = ["sh", "-c", 'exec "$@" 2>&-', "sh", *words]
    done = subprocess.run(closed, cwd=folder, stdout=subprocess.PIPE, text=True, timeout=300)
    assert done.returncode == status and ("height" in done.stdout) == (status == 0)


@pytest.mark.skipif(os.name == "nt", reason="Windows keeps folders in use")
def test_a_folder_that_is_gone(folder: Path) -> None:
    gone = str(folder / "gone")
    program = f"import os\nos.makedirs({gone!r})\nos.chdir({gone!r})\nos.rmdir('../gone')"
    done = run(folder, "studio", "--no-browser", before=program)
    assert done.returncode == 2
    assert done.stderr == "asterism: the folder in which the command runs does not exist any more\n"


def test_a_library_that_is_missing_is_named(folder: Path) -> None:
    done = run(folder, "preview", "d.toml", before="import sys\nsys.modules['shapely'] = None")
    assert done.returncode == 1 and "shapely" in done.stderr.splitlines()[-1] and "Traceback" not in done.stderr


@pytest.mark.slow
def test_names_are_printed_safely(folder: Path) -> None:
    (folder / "\x1b[31m\u202ed.toml").write_text("x = 1")
    refused = run(folder, "preview", "\x1b[31m\u202ed.toml")
    assert refused.returncode == 2 and r"asterism: \x1b[31m\u202ed.toml: x = 1" in refused.stderr
    made = run(folder, "new", "dome", "-o", "\u202edome.toml")
    assert made.returncode == 0 and made.stdout.startswith(r"\u202edome.toml: run")


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not limit addresses")
def test_a_tight_limit_of_memory_is_named(folder: Path) -> None:
    limit = "import resource\nresource.setrlimit(resource.RLIMIT_AS, (10**9, 10**9))"
    refused = run(folder, "simulate", "d.toml", before=limit)
    assert refused.returncode == 1
    line = "asterism: a process may use 1.0 GB of memory here, it needs 2 GB: see ulimit -v\n"
    assert refused.stderr == line
