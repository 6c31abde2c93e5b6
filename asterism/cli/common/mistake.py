"""The error of a wrong command line."""

from __future__ import annotations

from asterism.equilibrium.errors import Error


class Mistake(Error):
    """An option or argument is wrong; the message names it and the allowed values."""
