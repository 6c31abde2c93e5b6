"""Errors that users can cause."""

from __future__ import annotations


class Error(Exception):
    """Base class of every error that a user can cause.

    The message is one line. It names the place (file, field or option), the value, and what is allowed there.
    """


class BackendError(Error, ValueError):
    """The requested factorisation is not installed, or does not suit the problem."""
