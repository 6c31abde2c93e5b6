"""What strips cannot tell."""

from __future__ import annotations


class NoMaterial(Exception):
    """The strips do not determine a material; the message is one line."""
