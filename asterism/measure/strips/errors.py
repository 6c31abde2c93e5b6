"""Errors of fits of strips."""

from __future__ import annotations

from asterism.equilibrium.errors import Error


class UndeterminedMaterialError(Error):
    """The strips do not determine a material; the message is one line."""

    exit_status = 1
