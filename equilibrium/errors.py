"""Errors that users can cause."""

from __future__ import annotations


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
