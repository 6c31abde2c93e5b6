"""Errors that users can cause."""

from __future__ import annotations


def one_line(text: str) -> str:
    """A text on one line, as a terminal may print it: names of files, keys and layers may hold any characters.

    >>> print(one_line("dome\\x1b[31m\\u202e.toml is\\nmissing"))
    dome\\x1b[31m\\u202e.toml is missing
    """
    return "".join(c if c.isprintable() else " " if c.isspace() else ascii(c)[1:-1] for c in text)


class Error(Exception):
    """Base class of every error that a user can cause.

    The message is one line. It names the place (file, field or option), the value, and what is allowed there.

    Attributes
    ----------
    exit_status : of the command that ends with it: 2 for wrong input, 1 where a correct problem has no answer.
    """

    exit_status = 2


class BackendError(Error, ValueError):
    """The requested factorisation is not installed, or does not suit the problem."""
