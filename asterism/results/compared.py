"""The numbers by which designs are compared, on the studio's cards and on a page."""

from __future__ import annotations

COMPARED_KEYS = ("height_mm", "extent_mm", "expected_rms_percent", "expected_height_percent", "contraction")
