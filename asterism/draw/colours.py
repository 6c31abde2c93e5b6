"""Colours of text and lines in pictures, charts and drawings."""

from __future__ import annotations

# titles, numbers and lines
INK = "#26262b"
# labels and notes
PALE = "#7a7a82"
