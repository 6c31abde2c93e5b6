"""The entry point of the command line.

A mistake gives one line on standard error and exit status 2; a missing result gives exit status 1. Other modules are
imported only after the handler of Ctrl-C is installed.
"""

from __future__ import annotations

import atexit
import errno
import gc
import os
import re
import signal
import sys
from types import FrameType
from typing import TYPE_CHECKING, NoReturn

from asterism.process.environment import memory_problem, mend_environment

if TYPE_CHECKING:
    from typer import Typer


def main() -> None:
    """Run the command line; exits with 0 (done), 1 (no result), 2 (wrong input) or 130 (interrupted)."""
    arrived: list[int] = []

    def interrupt(number: int, frame: FrameType | None) -> None:
        arrived.append(number)
        raise KeyboardInterrupt

    mend_environment()
    # The libraries make a million objects that stay. The collector would go through them while they are made, and once
    # more at the end of Python. It begins in `Run.computing`.
    gc.disable()
    atexit.register(gc.freeze)
    try:
        for number in (signal.SIGINT, signal.SIGTERM, getattr(signal, "SIGHUP", signal.SIGTERM)):
            # a shell may start a background program with these signals ignored
            if signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, interrupt)
        # file names that are not valid text: the strict default would raise an exception
        if getattr(sys.stdout, "errors", None) == "strict" and hasattr(sys.stdout, "reconfigure"):
            sys.stdout.reconfigure(errors="backslashreplace")
        status = _run()
    except KeyboardInterrupt:
        status = 130
    except Exception:  # a library that is interrupted while it loads may raise another error
        if not arrived:
            raise
        status = 130
    finally:
        gc.unfreeze()
        gc.enable()
    # while Python ends, Ctrl-C would cause a traceback
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if status == 130:
        _stop("interrupted", 130)
    sys.exit(status)


def application() -> Typer:
    """The typer application with all commands of `asterism`."""
    from asterism.cli import lists, pages, prints, shapes
    from asterism.cli.command import group, root

    app = root()
    for function in (
        *(lists.new, pages.studio, shapes.preview, shapes.simulate, shapes.verify, shapes.sweep, shapes.fit),
        *(prints.export, pages.picture, lists.printers, prints.compare, pages.compare_designs, lists.materials),
        *(pages.report, lists.calibrate, pages.hops),
    ):
        app.command()(function)
    measure = (prints.new, prints.fit, prints.weigh, prints.overhang)
    app.add_typer(group("Measure plastic and fabric with printed strips.", *measure), name="strips")
    app.add_typer(group("Show a law, or forget the kept cells.", lists.show, lists.forget), name="law")
    return app


def plain_words(message: str) -> str:
    """The option parser's message in the words of the other messages.

    >>> plain_words("Invalid value for '--jobs': Input should be greater than or equal to 1")
    "Invalid value for '--jobs': must be at least 1"
    """
    for pattern, words in (
        ("Value error, ", ""),
        ("Input should be a valid integer.*", "must be a whole number"),
        ("Input should be a valid number.*", "must be a number"),
        ("Input should be greater than or equal to", "must be at least"),
        ("Input should be less than or equal to", "must be at most"),
    ):
        message = re.sub(pattern, words, message)
    return message


def _run() -> int:
    """Run the command of the command line, and return its exit status."""
    if (problem := memory_problem()) is not None:
        _stop(problem, 1)
    import typer

    from asterism.equilibrium.errors import Error

    # error of the option parser for a wrong command line; some versions of typer contain their own click
    usage_error: type[Exception] = typer.BadParameter.__mro__[1]
    try:
        status = application()(standalone_mode=False)
        if sys.stdout is not None:
            sys.stdout.flush()
        return status if isinstance(status, int) else 0
    except usage_error as error:
        _stop(plain_words(error.format_message()), 2)  # type: ignore[attr-defined]
    except Error as error:
        _stop(str(error), error.exit_status)
    except typer.Abort:
        return 130
    except MemoryError:
        _stop("not enough memory: a larger mesh.edge_mm needs less", 1)
    except ImportError as error:
        if (error.name or "").startswith("asterism"):
            raise
        _stop(f"a library is missing or broken: {error}", 1)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        if error.filename is not None:
            _stop(f"{error.filename}: {reason}", 2)
        if error.errno == errno.ENOENT:
            _stop("the folder in which the command runs does not exist any more", 2)
        # system errors of printing; errors of files have a class of their own, or a file name
        if error.errno not in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF, errno.EPIPE):
            raise
        # discard unprinted text: Python would try again at its end, and print an error
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        _stop(f"cannot print: {reason}", 1)


def _stop(line: str, status: int) -> NoReturn:
    """Print one line on standard error, and exit."""
    from asterism.equilibrium.errors import one_line

    print("asterism: " + one_line(" ".join(line.split())), file=sys.stderr)
    sys.exit(status)
