"""What a user's environment must not break: it is mended before a library is loaded, also for child processes."""

from __future__ import annotations

import logging
import os
import shlex
import subprocess
import sys


def memory_problem() -> str | None:
    """One line if the shell limits the memory of its processes to less than the libraries need; None otherwise."""
    try:
        import resource
    except ImportError:  # Windows has no such limits
        return None
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    # addresses that the libraries need; with less, OpenBLAS may ask for memory for ever
    if limit == resource.RLIM_INFINITY or limit >= 2_000_000_000:
        return None
    return f"a process may use {limit / 1e9:.1f} GB of memory here, it needs 2 GB: see ulimit -v"


def mend_environment() -> None:
    """Open the standard streams that are closed, and replace settings with which libraries fail, are slow or complain.

    Something else would get the number of a closed stream, such as a file of results, and would be printed into.
    """
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number
    sys.stdout = sys.stdout or os.fdopen(1, "w", closefd=False)
    sys.stderr = sys.stderr or os.fdopen(2, "w", closefd=False)
    if os.path.expanduser("~") == "~":  # users of containers and services have no home, and libraries ask for it
        os.environ["USERPROFILE" if os.name == "nt" else "HOME"] = "/nonexistent"
    # without a folder for its lists of fonts, which many containers lack, it works and complains
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    # no window is drawn; a notebook's value would need its packages
    os.environ["MPLBACKEND"] = "agg"
    # loops would take some hundred times as long
    os.environ.pop("NUMBA_DISABLE_JIT", None)
    for name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS"):
        if name in os.environ and not (os.environ[name].isdecimal() and int(os.environ[name])):
            del os.environ[name]


def quoted(word: object) -> str:
    """A word of a command line as the shell of this system takes it.

    >>> quoted("dome.toml")
    'dome.toml'
    """
    return subprocess.list2cmdline([str(word)]) if os.name == "nt" else shlex.quote(str(word))
