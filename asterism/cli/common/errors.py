"""Errors of commands."""

from __future__ import annotations

from asterism.equilibrium.errors import Error


class Mistake(Error):
    """An option or argument is wrong; the message names it and the allowed values."""


class Interrupted(Error):
    """Ctrl-C has ended a command; the message says where it can be continued."""

    exit_status = 130
