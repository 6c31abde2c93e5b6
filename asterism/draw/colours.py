"""The colours of text in pictures, charts and drawings."""

from __future__ import annotations

INK, PALE = "#26262b", "#7a7a82"
