"""The error of a sweep."""

from __future__ import annotations

from asterism.equilibrium.errors import Error


class SweepError(Error, ValueError):
    """A parameter of a sweep is wrong; the message is one line with the parameter and what is allowed."""
