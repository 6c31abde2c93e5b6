"""The end of a command with a single line."""

from __future__ import annotations

import sys
from typing import NoReturn


def stop(line: str, status: int) -> NoReturn:
    """Print one line on standard error, and exit."""
    print("asterism: " + " ".join(line.split()), file=sys.stderr)
    sys.exit(status)
