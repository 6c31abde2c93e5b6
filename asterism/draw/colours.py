"""The colours of text in pictures, charts and drawings."""

from __future__ import annotations

# titles, numbers and lines
INK = "#26262b"
# labels and notes of less weight
PALE = "#7a7a82"
