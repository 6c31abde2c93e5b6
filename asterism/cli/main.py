"""The command line. Every mistake is one line on standard error and exit status 2; no answer is status 1.

Nothing is imported before Ctrl-C is listened to.
"""

from __future__ import annotations

import errno
import os
import sys

from asterism.process import interruption
from asterism.process.stopping import stop

# what printing fails with; files that cannot be written have their own error, or a name
FULL_OR_GONE = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF, errno.EPIPE}


def main() -> None:
    """Run the command line; exits with 0 done, 1 no answer, 2 wrong input, 130 interrupted."""
    try:
        interruption.listen()
        _print_all_names()
        status = _run()
    except KeyboardInterrupt:
        status = 130
    except Exception:
        if not interruption.arrived():
            raise
        status = 130
    interruption.over()
    if status == 130:
        # Python would end by a signal if the interruption has left code given as text; other such code clears its note
        exec("")
        stop(interruption.in_words(), 130)
    sys.exit(status)


def _print_all_names() -> None:
    """Names of files may be no text: strict output would end in an exception where the rest is written already."""
    if getattr(sys.stdout, "errors", None) == "strict" and hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="backslashreplace")


def _run() -> int:
    """The exit status of the command that was typed."""
    import typer

    from asterism.cli.commands import Mistake, UsageError, app
    from asterism.measure.compare.errors import ScanError
    from asterism.measure.strips.errors import NoMaterial
    from asterism.results.csv_cells import TableError
    from asterism.results.files import OutputError
    from equilibrium.errors import BackendError
    from homogenize.errors import AddressError, CampaignError, LawError
    from pattern.design.errors import DesignError, MeshError

    try:
        status = app(standalone_mode=False)
        if sys.stdout is not None:
            sys.stdout.flush()
        return status if isinstance(status, int) else 0
    except UsageError as error:
        stop(error.format_message().replace("Value error, ", ""), 2)  # type: ignore[attr-defined]
    except (
        DesignError,
        MeshError,
        OutputError,
        BackendError,
        LawError,
        AddressError,
        TableError,
        ScanError,
        Mistake,
    ) as error:
        stop(str(error), 2)
    except (CampaignError, NoMaterial) as error:
        stop(str(error), 1)
    except typer.Abort:
        return 130
    except MemoryError:
        stop("not enough memory: a larger mesh.edge_mm needs less", 1)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        if error.filename is not None:
            stop(f"{error.filename}: {reason}", 2)
        if error.errno not in FULL_OR_GONE:
            raise
        # what has not been printed is dropped: Python would try again at its end, and complain
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        stop(f"cannot print: {reason}", 1)
